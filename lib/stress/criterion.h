/* criterion.h - equivalent stresses by which a material fails
 *
 * An equivalent stress is a seminorm of the stress: it is proportional to the load, and
 * the equivalent stress of a sum is at most the sum of the equivalent stresses, so bounds
 * for parts of the load add up to a bound for the whole.  It depends only on the
 * deviator, which has five independent components.
 *
 * To add a criterion, add a row in criterion.c.
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
	/* Of count stresses, given by rows of each number. */
	void (*row)(
		const double *const number[STRESS_DEVIATOR], int count, double *value);
	double norm; /* value <= norm times the Frobenius norm of the tensor */
};

/* (2-10); the default where a parameter is NULL. */
extern const struct stress_criterion stress_von_mises_criterion;
/* Largest difference of principal stresses. */
extern const struct stress_criterion stress_tresca_criterion;

#endif
