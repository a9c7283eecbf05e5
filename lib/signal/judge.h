/* judge.h - what is to be thought of the pulses that a joint fit has found
 *
 * A fit whose chi-square per degree of freedom is what noise leaves holds for all its
 * pulses.  Where it is more, each pulse is judged by the residual under it: a hidden
 * neighbour of one is no reason to doubt those a duration away.  Where too many are
 * doubted, or more were there than are looked for, the stretch is unresolved.
 */
#ifndef SIGNAL_JUDGE_H
#define SIGNAL_JUDGE_H

#include "signal/joint.h"
#include "signal/verdict.h"

struct judgement {
	double chi2; /* per degree of freedom */
	enum separate_verdict stretch;
	enum separate_verdict pulse[JOINT_PULSES_MAX]; /* of each */
};

/* The first done of the m pulses of the last fit, which are those that arrive before
 * boundary; only the samples before it count.  n: length of what was fitted; model_holds:
 * 0 if even clear pulses of this record do not fit. */
void judge(const struct joint *joint, const struct joint_scene *scene, size_t n,
	const struct joint_pulse *pulses, int m, int done, double boundary,
	int model_holds, const struct joint_result *r, struct judgement *out);

#endif
