/* rng.h - Philox as a GSL generator, one independent stream per (seed, realisation,
 * purpose); all gsl_ran_* distributions work on it */
#ifndef NUM_RNG_H
#define NUM_RNG_H

#include "num/philox.h"
#include <gsl/gsl_rng.h>

/* NULL when out of memory.  Free with gsl_rng_free(). */
gsl_rng *rng_new(uint64_t seed, uint32_t realisation, enum rng_purpose purpose);
/* Starts an existing generator at the beginning of another stream. */
void rng_reset(
	gsl_rng *rng, uint64_t seed, uint32_t realisation, enum rng_purpose purpose);

#endif
