/* goodness.h - goodness of fit of the pulses found by a joint fit
 *
 * A fit whose chi-square per degree of freedom is that of noise is accepted for all its
 * pulses.  If it is larger, each pulse is tested by the residual under it: a missed
 * neighbour of one pulse does not make those a duration away doubtful.  If too many are
 * doubted, or there were more pulses than are searched for, the stretch is unresolved.
 */
#ifndef SIGNAL_GOODNESS_H
#define SIGNAL_GOODNESS_H

#include "signal/fit/joint.h"
#include "signal/fit/verdict.h"

struct goodness {
	double chi2; /* per degree of freedom */
	enum separate_verdict stretch;
	enum separate_verdict pulse[JOINT_PULSES_MAX]; /* of each */
};

/* Judges the first done of the pulses of the last fit, which are those that arrive before
 * boundary; only the samples before it count.  model_holds: 0 if not even clear pulses of
 * this record fit. */
void goodness_of_fit(const struct joint *joint, int done, double boundary,
	int model_holds, struct goodness *out);

#endif
