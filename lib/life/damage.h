/* damage.h - remaining life by a bank of damage-rate models
 *
 * The damage D runs from 0 at the first observation to 1 at the threshold,
 * D = (y - y_0) / (threshold - y_0), and grows at the rate
 *
 *	dD/dt = v g(D)
 *
 * with one of these shapes g, by family:
 *	linear        1
 *	exponential   (1 + D / d), d = 0.3: D itself grows exponentially
 *	power         (1 + D / d)^k, k = -1, -1/2, 1/2, 3/2, 2
 *	rate          e^{m D}, m = -3 .. 5: the log of the rate follows the damage
 *
 * In the coordinate h(D) = int_0^D dD' / g(D') each is a straight line, h = h_0 + v t, so
 * that (h, v) is followed by a Kalman filter that takes gaps of any length.  Each shape
 * runs with two kinds of noise, constant in D: on the observation alone, or as much again
 * per mean gap on the damage (a Wiener process); and with three memories, observation j
 * of k weighing (j / k)^0, (j / k)^1 or (j / k)^3 through a discount, since early life is
 * often unlike late life.  The variance is unknown, so that predictions are Student-t,
 * and innovations beyond three standard deviations are cut to that.
 *
 * The models are averaged by the logarithm of their one-step predictive densities, which
 * fades with age as j / k and counts for at most twenty rows: rows are not independent
 * given a wrong model (Raftery, Karny, Ettler, Technometrics 52 (2010) 52;
 * Grunwald, van Ommen, Bayesian Analysis 12 (2017) 1069).
 */
#ifndef LIFE_DAMAGE_H
#define LIFE_DAMAGE_H

enum {
	DAMAGE_LINEAR = 1,
	DAMAGE_EXPONENTIAL = 2,
	DAMAGE_POWER = 4,
	DAMAGE_RATE = 8,
	DAMAGE_ALL = 15
};

struct damage;

/* direction: +1 when the threshold is reached from below, -1 from above.  families: of
 * the above.  NULL when out of memory. */
struct damage *damage_new(unsigned families, double threshold, int direction);
void damage_free(struct damage *d);
void damage_clear(struct damage *d); /* forgets all rows */

/* Takes an observation; t rises.  Those before the first on the good side of the
 * threshold are passed over. */
void damage_add(struct damage *d, double t, double y);
long damage_rows(const struct damage *d);

/* Draws n remaining lives from time now on (>= the last t): each a model by its weight,
 * its (h, v) with v > 0 (damage does not heal), and an inverse Gaussian passage where
 * there is Wiener noise; INFINITY where no positive v was met.  z: m standard normal
 * deviates, m >= 4 n, the same at every row for smooth successions.  At least four rows
 * must have been taken. */
void damage_draw(
	struct damage *d, double now, const double *z, int m, double *life, int n);

#endif
