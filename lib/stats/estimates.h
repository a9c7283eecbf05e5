/* estimates.h - what an ensemble of wear particles tells: fits, their intervals, steps
 *
 *	struct estimate out[ESTIMATES];
 *	if (estimate_all(e, NULL, out) == 0)
 *		printf("%g\n", out[ESTIMATE_SHAPE].value);
 *
 * Functions return 0, or -1 when out of memory.  nan: there is no such value.
 */
#ifndef CONTACT_ESTIMATES_H
#define CONTACT_ESTIMATES_H

#include "stats/ensemble.h"
#include "stats/statistics.h"
#include <stdint.h>

enum estimate_quantity {
	ESTIMATE_SHAPE, /* of the Weibull distribution of diameters (2-17) */
	ESTIMATE_SCALE,
	ESTIMATE_WEIBULL_MEAN,
	ESTIMATE_KS, /* Kolmogorov-Smirnov distance of the fit */
	ESTIMATE_MEAN_DIAMETER,
	ESTIMATE_FACTOR, /* of the power law of particles over steps (2-16) */
	ESTIMATE_EXPONENT,
	ESTIMATE_OFFSET,
	ESTIMATE_VOLUME_STEP, /* mean over realisations of the mean over their steps */
	ESTIMATES
};

/* pick: the realisations, as many as there are, as a bootstrap has drawn them; NULL: each
 * one.  The distance, which sorts and has no interval, only of the latter. */
int estimate_all(
	const struct ensemble *e, const size_t *pick, struct estimate out[ESTIMATES]);

/* Puts intervals from draws of whole realisations with replacement (Efron's bootstrap)
 * into out: particles of one surface hang together. */
int estimate_bootstrap(const struct ensemble *e, uint64_t seed, long draws,
	struct estimate out[ESTIMATES]);

/* The Weibull distribution of n diameters, cut off as the ensemble has it; -1 where there
 * is none (weibull_fit()). */
int estimate_weibull(
	const struct ensemble *e, const double *x, size_t n, struct weibull *w);

/* One step over the realisations it took place in; sd: standard deviation over them. */
struct step_estimate {
	double realisations;
	double count, count_sd, all_count; /* all_count: sum over realisations so far */
	double volume, volume_sd, all_volume, all_volume_sd; /* mean of all so far */
	double diameter, shape, scale;
};

int estimate_step(const struct ensemble *e, long step, struct step_estimate *out);

#endif
