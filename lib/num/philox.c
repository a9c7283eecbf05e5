#include "num/philox.h"
#include <math.h>
#include <string.h>

enum { ROUNDS = 10 };
static const uint32_t STEP_0 = 0x9E3779B9, STEP_1 = 0xBB67AE85;

/* One of the ten rounds. */
static inline void turn(
	uint32_t *c0, uint32_t *c1, uint32_t *c2, uint32_t *c3, uint32_t k0, uint32_t k1)
{
	uint64_t p = (uint64_t)0xD2511F53 * *c0, q = (uint64_t)0xCD9E8D57 * *c2;

	*c0 = (uint32_t)(q >> 32) ^ *c1 ^ k0;
	*c1 = (uint32_t)q;
	*c2 = (uint32_t)(p >> 32) ^ *c3 ^ k1;
	*c3 = (uint32_t)p;
}

void philox4x32(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4])
{
	uint32_t c0 = counter[0], c1 = counter[1], c2 = counter[2], c3 = counter[3];

	for (uint32_t i = 0; i < ROUNDS; i++)
		turn(&c0, &c1, &c2, &c3, key[0] + i * STEP_0, key[1] + i * STEP_1);
	out[0] = c0;
	out[1] = c1;
	out[2] = c2;
	out[3] = c3;
}

/* Local arrays, so that compilers see that nothing overlaps and work on many at once. */
void philox4x32_row(
	const uint32_t counter[4], const uint32_t key[2], uint32_t out[4][PHILOX_ROW])
{
	uint32_t c0[PHILOX_ROW], c1[PHILOX_ROW], c2[PHILOX_ROW], c3[PHILOX_ROW];

	for (uint32_t k = 0; k < PHILOX_ROW; k++) {
		c0[k] = counter[0] + k;
		c1[k] = counter[1] + (c0[k] < k);
		c2[k] = counter[2];
		c3[k] = counter[3];
	}
	for (uint32_t i = 0; i < ROUNDS; i++)
		for (int k = 0; k < PHILOX_ROW; k++)
			turn(&c0[k], &c1[k], &c2[k], &c3[k], key[0] + i * STEP_0,
				key[1] + i * STEP_1);
	memcpy(out[0], c0, sizeof c0);
	memcpy(out[1], c1, sizeof c1);
	memcpy(out[2], c2, sizeof c2);
	memcpy(out[3], c3, sizeof c3);
}

static void block(uint64_t seed, uint32_t realisation, enum rng_purpose purpose,
	uint64_t index, uint32_t out[4])
{
	uint32_t counter[4] = { (uint32_t)index, (uint32_t)(index >> 32), realisation,
		(uint32_t)purpose };
	uint32_t key[2] = { (uint32_t)seed, (uint32_t)(seed >> 32) };

	philox4x32(counter, key, out);
}

/* 53 bits, moved off 0 by half a step; the last step would round to 1. */
static double uniform(uint32_t high, uint32_t low)
{
	uint64_t bits = ((uint64_t)high << 32 | low) >> 11;
	double u = ((double)bits + 0.5) * 0x1p-53;

	return u < 1 ? u : 1 - 0x1p-53;
}

double philox_uniform(
	uint64_t seed, uint32_t realisation, enum rng_purpose purpose, uint64_t index)
{
	uint32_t out[4];

	block(seed, realisation, purpose, index, out);
	return uniform(out[0], out[1]);
}

void philox_normal2(uint64_t seed, uint32_t realisation, enum rng_purpose purpose,
	uint64_t index, double normal[2])
{
	uint32_t out[4];
	double r, angle;

	block(seed, realisation, purpose, index, out);
	r = sqrt(-2 * log(uniform(out[0], out[1])));
	angle = 2 * M_PI * uniform(out[2], out[3]);
	normal[0] = r * cos(angle);
	normal[1] = r * sin(angle);
}
