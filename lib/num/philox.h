/* philox.h - Philox4x32-10 counter-based random bits
 *
 * Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011.
 * A pure function of (counter, key): any element of any stream at any time.
 */
#ifndef NUM_PHILOX_H
#define NUM_PHILOX_H

#include <stdint.h>

void philox4x32(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4]);

/* The same for counter, counter + 1, ... in half the time: out[word][k].  The counter's
 * two low words count as one number. */
enum { PHILOX_ROW = 16 };
void philox4x32_row(
	const uint32_t counter[4], const uint32_t key[2], uint32_t out[4][PHILOX_ROW]);

/* Purpose of a stream; part of the counter, so that adding a purpose does not change
 * other streams. Never renumber. */
enum rng_purpose {
	RNG_SURFACE = 1,   /* phases and amplitudes of a surface */
	RNG_SURFACE_2 = 2, /* second surface of a pair */
	RNG_ROUGHNESS = 3, /* drawn Sq or Sa */
	RNG_PARTICLE = 4,  /* drawn particles of the sensor */
	RNG_NOISE = 5,     /* sensor noise */
	RNG_FILTER = 6,    /* particle filter */
	RNG_LIFE = 7,      /* wear-life ensemble */
	RNG_BOOTSTRAP = 8, /* resampling for intervals */
	RNG_NETWORK = 9,   /* initial weights, shuffling, training scenes */
	RNG_PREDICT = 10,  /* long-term prediction paths */
	RNG_ABRASION =
		11, /* particles drawn from a cleanliness code, places of grooves */
	RNG_MATERIAL = 12,   /* materials of the sensor's particles */
	RNG_DISTURBANCE = 13 /* events at the sensors that are no particles */
};

/* Uniform in (0, 1) and standard normal by address: for index i of stream (seed,
 * realisation, purpose), in any order.  Box-Muller, since single numbers of many streams
 * would each need the tables of normals.h. */
double philox_uniform(
	uint64_t seed, uint32_t realisation, enum rng_purpose purpose, uint64_t index);
void philox_normal2(uint64_t seed, uint32_t realisation, enum rng_purpose purpose,
	uint64_t index, double normal[2]);

#endif
