/* validate.h - test whether the pulses of a record are particles, by their velocities
 *
 * Pulses are fitted until they describe the record, so that chi-square does not reveal
 * events that are not particles: several pulses are fitted to them.  The velocities
 * reveal them, because the fit does not restrict these.  Each particle has a velocity of
 * the flow, pulses fitted to what is no particle have any: a group is doubted if the sum
 * of squares of its deviations exceeds chi-square by five deviations, and a pulse if its
 * delay is at the edge of the range searched.  The variance of the flow is that of pulses
 * that stand alone.
 *
 * A weak pulse that recurs at one distance from a strong one of the same velocity, as a
 * like share of it, is an error of the shape of the strong one.
 *
 * Where more than half of the rows are doubted, or more than a tenth have delays at the
 * edge of the range, or pulses do not stand out at both sensors, the record is not like
 * the learned one, and no row is believed.
 *
 * Rows that are tested together, such as those of the stretch used for calibration, are
 * all stored first; later rows are tested with the last ones before them.
 */
#ifndef SIGNAL_VALIDATE_H
#define SIGNAL_VALIDATE_H

#include "signal/fit/joint.h"
#include <stddef.h>

/* One row: a pulse, or samples that were not separated. */
struct evidence {
	int group;         /* rows of one fit have the same number, from 1 */
	int fits;          /* 0: doubted already by chi-square */
	double delay, var; /* in samples; var 0: unknown */
	double amplitude;  /* over the noise */
	double weaker; /* chi-square that it explains at the sensor that shows it less;
			  0: unknown */
	double time;   /* of arrival, durations; ascending within a group */
	int doubted;   /* set by validation_test() */
	/* For together.h, of fitted pulses: */
	int pulse;                 /* 1: it is one */
	double odds[JOINT_SHARES]; /* of being two, for one other arrival per duration */
	double exchange; /* odds of having the arrival of another pulse at sensor 2 */
	/* Set by together_test(): probabilities of being a pair, half of a pulse, an
	 * error of the shape of a larger one, and any of these; */
	double pair, half, shape, wrong;
	/* logarithms of the amplitude and of that of the largest pulse that it overlaps;
	 * 1: it is much smaller than that. */
	double size, beside;
	double gap; /* to the nearer neighbour; INFINITY: far */
	int weak;
};

/* Latest rows, by which others are tested: they know a share of 0.7 % to 0.5 %. */
enum { EVIDENCE_KEPT = 256 };
/* How many are kept of so many. */
static inline size_t evidence_kept(size_t count)
{
	return count < EVIDENCE_KEPT ? count : EVIDENCE_KEPT;
}

struct validation;
struct validation *validation_new(void); /* NULL: no memory */
void validation_free(struct validation *v);

/* Delays of the particles so far: their mean, variance and a bound of it, from count of
 * them; count 0: nothing is known. */
struct flow {
	double mean, var, margin, count;
};

/* Prior knowledge, used until enough delays are known. */
void validation_tell_flow(struct validation *v, const struct flow *flow);
void validation_flow(const struct validation *v, struct flow *flow);

/* Range of the delays that are searched, learned to be wider than that of particles;
 * transit: the time from sensor to sensor of a particle whose delay is 0. */
void validation_range(struct validation *v, double transit, double least, double most);

/* Half of this range; 0: it, or the flow, is not known. */
double validation_half(const struct validation *v);

/* Adds n rows, in order and with undivided groups, and tests them. */
void validation_test(struct validation *v, struct evidence *e, size_t n);

#endif
