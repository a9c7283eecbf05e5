/* rate.h - wear rate followed through noisy observations
 *
 * Level and rate of a slowly growing quantity (gap, worn volume), the rate a random
 * walk, by Kalman filters that differ in memory and in a wander (AR(1)) that the
 * observations show beside the level, each weighted by how well it predicted (Magill,
 *IEEE Trans. Autom. Control 10, 1965). The noise of the observations comes from their
 *second differences (noise.h); those more than three standard deviations off are weighed
 *down (Huber), and five such running are taken for a jump of the level.
 *
 *	struct rate *r = rate_new(0, INFINITY);
 *	rate_add(r, t, gap);
 *	if (rate_ready(r))
 *		left = rate_passage(r, threshold, u, z);
 *	rate_free(r);
 */
#ifndef LIFE_RATE_H
#define LIFE_RATE_H

enum { RATE_START = 4 }; /* observations before there is a prediction */

struct rate;

/* prior_mean, prior_sd: what is known of the rate beforehand, at any time; prior_sd
 * INFINITY: nothing.  NULL when out of memory. */
struct rate *rate_new(double prior_mean, double prior_sd);
void rate_free(struct rate *r);

/* Takes the observation at t, which must grow; a NAN value only moves the time on. */
void rate_add(struct rate *r, double t, double value);
int rate_ready(const struct rate *r);

/* Mean level and rate now. */
void rate_state(const struct rate *r, double *level, double *rate);

/* Time from now until the level reaches threshold; INFINITY: never.  u in (0, 1) picks
 * a filter by its weight, z, standard normal, a path among its forecasts: the first
 * x at which mean(x) + z sd(x) of the level meets the threshold. */
double rate_passage(const struct rate *r, double threshold, double u, double z);

#endif
