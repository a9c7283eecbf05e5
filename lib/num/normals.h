/* normals.h - standard normal numbers by address, in half the time of philox_normal2():
 * the ziggurat (ziggurat.h), layer and place from different bits of 64-bit Philox words
 */
#ifndef NUM_NORMALS_H
#define NUM_NORMALS_H

#include "num/philox.h"
#include <stddef.h>

struct normals;

/* The numbers of stream (seed, realisation, purpose); NULL when out of memory. */
struct normals *normals_new(
	uint64_t seed, uint32_t realisation, enum rng_purpose purpose);
void normals_free(struct normals *normals);

/* Two independent numbers for index < 2^48. In one case of fifty more random words are
 * needed; they are taken from indices 2^48 to 2^61 of the same stream. */
void normals_pair(const struct normals *normals, uint64_t index, double pair[2]);
/* The same numbers for index, index + 1, ..., faster: pairs[2 * count]. */
void normals_pairs(
	const struct normals *normals, uint64_t index, size_t count, double *pairs);

#endif
