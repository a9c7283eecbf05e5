/* coincide.h - may one pulse be several particles that arrive together?
 *
 * Two pulses of amplitudes a and b a distance d apart on both sensors are told apart if
 * one pulse in their place leaves more chi-square than a second one must take away.  Of
 * equal ones, together of amplitude h, it leaves
 *
 *	h^2 / 4 E (2 + 2 r(d) - 4 r(d / 2)^2),
 *
 * E being the energy of a pulse of amplitude 1 and r the autocorrelation of the shape.
 * Up to the distance where that is enough, the reach, no fit can tell; the amplitude can,
 * by what is known of those of single pulses:
 *
 *	- how densely pulses follow each other is counted at distances that are told
 *	  apart for certain, and holds for shorter ones, too: the density;
 *	- among n rows, n * density * reach are then expected to be sums of two particles,
 *	  less where their velocities take them apart on the other sensor, and more or
 *fewer if the amplitudes say so;
 *	- the distribution of single amplitudes is that which, with these sums, makes that
 *	  of the rows (expectation and maximisation, kernels on the logarithm);
 *	- each row has a probability of being a sum.  Those least likely to be are single:
 *	  as many as leave an expected share of sums among them.
 */
#ifndef SIGNAL_COINCIDE_H
#define SIGNAL_COINCIDE_H

#include "num/status.h"
#include "signal/shape.h"

struct coincide;
struct coincide *coincide_new(void); /* NULL: no memory */
void coincide_free(struct coincide *c);

/* The shape of the pulses, for coincide_reach(). */
enum num_status coincide_shape(struct coincide *c, const struct shape *shape);
/* Distance, in durations, up to which one pulse may be two, each of amplitude 1 / 2, if
 * a second one must take away need and the one has this energy, in units of chi-square.
 */
double coincide_reach(const struct coincide *c, double energy, double need);

/* A row: arrival in durations, not before that of the last one by more than durations,
 * and amplitude over the noise. */
void coincide_take(struct coincide *c, double place, double height, double reach);
/* To be called after some of them, learns again with every eighth of those it goes by;
 * spread: deviation of a delay, in durations, among particles. */
void coincide_learn(struct coincide *c, double spread);
/* Is a row that was taken in likely to be several particles? */
int coincide_is_sum(const struct coincide *c, double height, double reach);

#endif
