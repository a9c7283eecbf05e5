#include "num/normals.h"
#include "num/ziggurat.h"
#include <math.h>
#include <stdlib.h>

enum { EXTRA_SHIFT = 48 };

struct normals {
	struct ziggurat layers;
	uint32_t key[2], realisation, purpose;
};

struct normals *normals_new(uint64_t seed, uint32_t realisation, enum rng_purpose purpose)
{
	struct normals *n = malloc(sizeof *n);

	if (!n)
		return NULL;
	n->key[0] = (uint32_t)seed;
	n->key[1] = (uint32_t)(seed >> 32);
	n->realisation = realisation;
	n->purpose = (uint32_t)purpose;
	ziggurat_make(&n->layers);
	return n;
}

void normals_free(struct normals *normals)
{
	free(normals);
}

static inline void draw(const struct normals *n, uint64_t index, uint64_t word[2])
{
	uint32_t counter[4] = { (uint32_t)index, (uint32_t)(index >> 32), n->realisation,
		n->purpose };
	uint32_t out[4];

	philox4x32(counter, n->key, out);
	word[0] = (uint64_t)out[0] << 32 | out[1];
	word[1] = (uint64_t)out[2] << 32 | out[3];
}

/* Uniform in (0, 1). */
static double uniform(uint64_t word)
{
	return ((double)(word >> 12) + 0.5) * 0x1p-52;
}

static double draw_tail(const struct normals *n, uint64_t place)
{
	uint64_t word[2];
	double x;

	do {
		draw(n, place, word);
		x = ziggurat_tail(uniform(word[0]), uniform(word[1]));
		place += (uint64_t)2 << EXTRA_SHIFT;
	} while (x == 0);
	return x;
}

/* Continues where the first word fell outside the inner box of its layer; which = 0, 1.
 */
static double settle(
	const struct normals *n, uint64_t word, uint64_t index, uint64_t which)
{
	uint64_t place = index + ((1 + which) << EXTRA_SHIFT), next[2];

	for (;;) {
		size_t layer = word % ZIGGURAT_LAYERS;
		double u = (double)((int64_t)word >> 11) * 0x1p-52,
		       x = u * n->layers.edge[layer];

		if (fabs(u) < n->layers.inner[layer])
			return x;
		if (layer == 0)
			return copysign(draw_tail(n, place), u);
		draw(n, place, next);
		if (ziggurat_under(&n->layers, layer, x, uniform(next[1])))
			return x;
		word = next[0];
		place += (uint64_t)2 << EXTRA_SHIFT;
	}
}

/* The deviate of a random word; which = 0, 1 of the pair. */
static inline double number(
	const struct normals *n, uint64_t word, uint64_t index, uint64_t which)
{
	size_t layer = word % ZIGGURAT_LAYERS;
	double u = (double)((int64_t)word >> 11) * 0x1p-52;

	return fabs(u) < n->layers.inner[layer] ? u * n->layers.edge[layer]
						: settle(n, word, index, which);
}

void normals_pair(const struct normals *n, uint64_t index, double pair[2])
{
	uint64_t word[2];

	draw(n, index, word);
	pair[0] = number(n, word[0], index, 0);
	pair[1] = number(n, word[1], index, 1);
}

void normals_pairs(const struct normals *n, uint64_t index, size_t count, double *pairs)
{
	for (size_t i = 0; i < count; i += PHILOX_ROW) {
		size_t m = count - i < PHILOX_ROW ? count - i : PHILOX_ROW;
		uint32_t counter[4] = { (uint32_t)(index + i),
			(uint32_t)((index + i) >> 32), n->realisation, n->purpose };
		uint32_t out[4][PHILOX_ROW];

		philox4x32_row(counter, n->key, out);
		for (size_t k = 0; k < m; k++) {
			uint64_t word0 = (uint64_t)out[0][k] << 32 | out[1][k];
			uint64_t word1 = (uint64_t)out[2][k] << 32 | out[3][k];
			double *pair = pairs + 2 * (i + k);

			pair[0] = number(n, word0, index + i + k, 0);
			pair[1] = number(n, word1, index + i + k, 1);
		}
	}
}
