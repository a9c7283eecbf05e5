/* life.h - the distribution of the time until a degradation series reaches its threshold
 *
 * Observations are passed one by one; after at least four of them the remaining life is
 * sampled, and quantiles are computed from the samples.  The wear rate may change in the
 * future: see aopf(1).
 *
 *	struct wp_life *l = wp_life_new(5.0, 1, 500, 1, NULL);
 *	const double level[3] = { 0.05, 0.5, 0.95 };
 *	double quantile[3];
 *	if (!l)
 *		return 1;
 *	for (int i = 0; i < 20; i++)
 *		wp_life_observe(l, i, 0.1 * i);
 *	if (wp_life_quantiles(l, level, quantile, 3, NULL) != WP_OK)
 *		return 1;
 *	printf("%g (%g to %g)\n", quantile[1], quantile[0], quantile[2]);
 *	wp_life_free(l);
 */
#ifndef WEARPIPE_LIFE_H
#define WEARPIPE_LIFE_H

#include <stdint.h>
#include <wearpipe/status.h>

#ifdef __cplusplus
extern "C" {
#endif

struct wp_life;

/* direction: +1 if the threshold is reached from below, -1 from above. draws: number of
 * samples of the remaining life, >= 1.  WP_DOMAIN or WP_NO_MEMORY. */
WP_API struct wp_life *wp_life_new(double threshold, int direction, int draws,
	uint64_t seed, enum wp_status *status);
WP_API void wp_life_free(struct wp_life *l);

/* Passes an observation at time t, which must be ascending. y NAN: missing. WP_NUMBERS if
 * t is not finite or y is infinite, WP_DOMAIN if t is not ascending. */
WP_API enum wp_status wp_life_observe(struct wp_life *l, double t, double y);

/* Quantiles of the remaining life from the last observation, at n levels from 0 to 1;
 * INFINITY if the threshold is not reached at that level. never (may be NULL):
 * probability that it is never reached. WP_IMPOSSIBLE below four observations, or
 * WP_NO_MEMORY. */
WP_API enum wp_status wp_life_quantiles(
	struct wp_life *l, const double *level, double *quantile, int n, double *never);

#ifdef __cplusplus
}
#endif
#endif
