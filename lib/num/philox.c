#include "num/philox.h"
#include <math.h>

static void multiply(uint32_t a, uint32_t b, uint32_t *high, uint32_t *low)
{
	uint64_t p = (uint64_t)a * b;

	*high = (uint32_t)(p >> 32);
	*low = (uint32_t)p;
}

void philox4x32(const uint32_t counter[4], const uint32_t key[2], uint32_t out[4])
{
	enum { ROUNDS = 10 };
	uint32_t c0 = counter[0], c1 = counter[1], c2 = counter[2], c3 = counter[3];
	uint32_t k0 = key[0], k1 = key[1];

	for (int i = 0; i < ROUNDS; i++) {
		uint32_t high0, low0, high1, low1;

		multiply(0xD2511F53, c0, &high0, &low0);
		multiply(0xCD9E8D57, c2, &high1, &low1);
		c0 = high1 ^ c1 ^ k0;
		c1 = low1;
		c2 = high0 ^ c3 ^ k1;
		c3 = low0;
		k0 += 0x9E3779B9;
		k1 += 0xBB67AE85;
	}
	out[0] = c0;
	out[1] = c1;
	out[2] = c2;
	out[3] = c3;
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
	static const double two_pi = 6.28318530717958647693;
	uint32_t out[4];
	double r, angle;

	block(seed, realisation, purpose, index, out);
	r = sqrt(-2 * log(uniform(out[0], out[1])));
	angle = two_pi * uniform(out[2], out[3]);
	normal[0] = r * cos(angle);
	normal[1] = r * sin(angle);
}
