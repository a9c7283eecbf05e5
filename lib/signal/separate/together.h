/* together.h - rows that may be two particles, parts of two, or none
 *
 * Two pulses that arrive within a few hundredths of a duration are fitted as one: a row
 * of the sum of their amplitudes that no residual betrays.  How likely that is follows
 * from what the residual says (joint_pair_odds() in joint.h), from how often one pulse
 * follows another closely, and from the amplitudes: two that add up to this one, against
 * one of them.
 *
 * Two pulses may have been fitted to one because its shape is slightly wrong.  They are
 * halves if pulses follow others within as short a gap more often than particles do.
 *
 * Weak pulses beside larger ones may be errors of the shape of these.  They are if there
 * are more of them than particles as small come to lie beside larger ones at random.
 *
 * Two pulses may have exchanged their arrivals at sensor 2, with odds that the fit tells.
 *
 * Rows are doubted, the most likely ones first, until at most six in a thousand of the
 * others are expected to be wrong: none, or a pair whose diameter is out by more than a
 * tenth.
 */
#ifndef SIGNAL_TOGETHER_H
#define SIGNAL_TOGETHER_H

#include "signal/separate/validate.h"
#include <stddef.h>

struct together;
struct together *together_new(void); /* NULL: no memory */
void together_free(struct together *t);

/* Takes in n pulses, groups undivided and in order, and tests them; the size of one that
 * is doubted already does not count.  Pulses nearer than beside, in durations, overlap.
 */
void together_test(struct together *t, double beside, struct evidence *a, size_t n);

#endif
