/* together.h - rows that may be two particles, parts of two, or none
 *
 * Two pulses that arrive within a few hundredths of a duration are fitted as one: a row
 * of the sum of their amplitudes that no residual betrays.  How likely that is follows
 * from what the residual says (joint_pair_odds() in joint.h), from how often one pulse
 * follows another closely, and from the amplitudes: two that add up to this one, against
 * one of them.
 *
 * Weak pulses beside larger ones may be errors of the shape of these.  They are if there
 * are more of them than particles as small come to lie beside larger ones at random.
 *
 * Particles arrive independently, so that those in company are as large as those alone.
 * Several smaller ones describe something else, such as a baseline.
 *
 * A pulse fitted to what others leave has any delay in the range searched.  How many such
 * there are follows from the delays of all pulses fitted with others.
 *
 * Two pulses may have exchanged their arrivals at sensor 2, with odds that the fit tells.
 *
 * Rows are doubted, the most likely ones first, until at most six in a thousand of the
 * others are expected to be wrong: none, or a pair whose diameter is out by more than a
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
	/* Of a pulse fitted with others: its delay less that of the flow, over half of
	 * the range searched, and the variance of this; 0: not known.  flow_var: least
	 * variance of such delays in the flow. */
	double off, off_var, flow_var;
	double exchange; /* odds of having the arrival of another pulse at sensor 2 */
	/* Probabilities of being a pair, an error of the shape of a larger pulse, and not
	 * of the flow; set by together_test(). */
	double pair, shape, astray;
	double beside; /* the largest pulse that it overlaps, or 0; set by together_test()
			*/
	int weak, alone; /* beside a larger one, and by itself; set by together_test() */
	int doubted; /* already, and then its size does not count; or by together_test()
		      */
};

struct together;
struct together *together_new(void); /* NULL: no memory */
void together_free(struct together *t);

/* Takes in n arrivals, groups undivided and in order, and tests them.  Pulses nearer than
 * beside, in durations, overlap. */
void together_test(struct together *t, double beside, struct arrival *a, size_t n);

#endif
