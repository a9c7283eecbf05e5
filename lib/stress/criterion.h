/* criterion.h - equivalent stresses by which a material fails
 *
 * An equivalent stress is a seminorm of the stress: it grows in proportion to the load,
 * and that of a sum is at most the sum of those of its parts, so that bounds of parts add
 * up to a bound of the whole.  It depends on the deviator alone, which the five numbers
 * of influence.h describe.
 *
 * A further criterion is one more row in criterion.c.
 */
#ifndef STRESS_CRITERION_H
#define STRESS_CRITERION_H

/* Stress as the differences xx - zz, yy - zz, the shears xy, xz, yz, and zz; the first
 * STRESS_DEVIATOR of them fix the deviator. */
enum stress_number {
	DEV_X,
	DEV_Y,
	DEV_XY,
	DEV_XZ,
	DEV_YZ,
	STRESS_DEVIATOR,
	DEV_ZZ = STRESS_DEVIATOR,
	STRESS_NUMBERS
};

struct stress_criterion {
	const char *name;
	double (*value)(const double number[STRESS_DEVIATOR]);
	double norm; /* value <= norm times the Frobenius norm of the tensor */
};

/* (2-10); NULL in a parameter stands for it. */
extern const struct stress_criterion stress_von_mises_criterion;
/* Largest difference of principal stresses. */
extern const struct stress_criterion stress_tresca_criterion;

#endif
