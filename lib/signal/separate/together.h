/* together.h - rows that may be two particles which arrived nearly together
 *
 * Two pulses that arrive within a few hundredths of a duration are fitted as one: a row
 * of the sum of their amplitudes that no residual betrays.  How likely that is follows
 * from what the residual says (joint_pair_odds() in joint.h), from how often one pulse
 * follows another closely, and from the amplitudes: two that add up to this one, against
 * one of them.  Rows are doubted, the most likely pairs first, until at most one in a
 * hundred of the others is expected to be a pair whose diameter is out by more than a
 * tenth.
 */
#ifndef SIGNAL_TOGETHER_H
#define SIGNAL_TOGETHER_H

#include "signal/fit/joint.h"
#include <stddef.h>

struct arrival {
	int group;   /* pulses of one fit have the same number */
	double time; /* in durations, ascending within a group */
	double amplitude;
	double odds[JOINT_SHARES]; /* for one other arrival per duration */
	double pair;               /* probability of being one; set by together_judge() */
	int doubted; /* already, and then its size does not count; or by together_judge()
		      */
};

struct together;
struct together *together_new(void); /* NULL: no memory */
void together_free(struct together *t);

/* Takes in n arrivals, groups undivided and in order, and judges them. */
void together_judge(struct together *t, struct arrival *a, size_t n);

#endif
