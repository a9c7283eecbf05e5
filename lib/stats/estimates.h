/* estimates.h - fits to an ensemble of wear particles, with intervals
 *
 *	struct estimate out[ESTIMATES];
 *	if (estimate_all(e, out) == 0)
 *		printf("%g\n", out[ESTIMATE_SHAPE].value);
 *
 * nan: the value does not exist.
 */
#ifndef CONTACT_ESTIMATES_H
#define CONTACT_ESTIMATES_H

#include "num/status.h"
#include "stats/ensemble.h"
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

enum num_status estimate_all(const struct ensemble *e, struct estimate out[ESTIMATES]);

/* Computes intervals by bootstrap samples of whole realisations (Efron), except for the
 * distance: particles of one surface are correlated.  Needs groups (struct ensemble_par);
 * where there are more realisations than groups, the groups are drawn, whose means vary
 * as those of their realisations do. */
enum num_status estimate_bootstrap(const struct ensemble *e, uint64_t seed, long draws,
	struct estimate out[ESTIMATES]);

/* Standard errors of the estimates and of their logarithms by the same draws, enlarged by
 * sqrt(K / (K - 1)) for K realisations, since resampling has their variance over K; that
 * of the volume from its standard deviation.  NAN if there is none. */
enum num_status estimate_errors(const struct ensemble *e, uint64_t seed, long draws,
	const struct estimate value[ESTIMATES], double error[ESTIMATES],
	double log_error[ESTIMATES]);

/* One study against another. */
struct estimate_contrast {
	struct estimate difference, ratio; /* other - value, other / value */
	double realisations; /* of each study, of which the interval of the ratio leaves
			      * out 1 in nine of ten studies; INFINITY: none would */
};

/* Of two independent values, their standard errors and those of their logarithms, found
 * from na and nb realisations: by Student's t with Welch's degrees of freedom. */
struct estimate_contrast estimate_compare(const double value[2], const double error[2],
	const double log_error[2], const double realisations[2], double confidence);

/* The Weibull distribution of diameters, truncated as the ensemble states, without
 * intervals. */
enum weibull_status estimate_weibull(
	const struct ensemble *e, const struct sketch *diameters, struct weibull *w);

#endif
