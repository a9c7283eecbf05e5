#include "num/normals.h"
#include <math.h>
#include <stdlib.h>

/* Layers of equal area; the lowest holds the tail beyond TAIL. */
enum { LAYERS = 128, EXTRA_SHIFT = 48 };
static const double tail_start = 3.442619855899, layer_area = 9.91256303526217e-3;

struct normals {
	double edge[LAYERS + 1]; /* right edges, falling to 0 */
	double inner[LAYERS];    /* edge above over edge */
	uint32_t key[2], realisation, purpose;
};

struct normals *normals_new(uint64_t seed, uint32_t realisation, enum rng_purpose purpose)
{
	struct normals *n = malloc(sizeof *n);
	double f = exp(-0.5 * tail_start * tail_start);

	if (!n)
		return NULL;
	n->key[0] = (uint32_t)seed;
	n->key[1] = (uint32_t)(seed >> 32);
	n->realisation = realisation;
	n->purpose = (uint32_t)purpose;
	n->edge[0] = layer_area / f;
	n->edge[1] = tail_start;
	for (int i = 2; i < LAYERS; i++) {
		n->edge[i] = sqrt(-2 * log(layer_area / n->edge[i - 1] + f));
		f = exp(-0.5 * n->edge[i] * n->edge[i]);
	}
	n->edge[LAYERS] = 0;
	for (int i = 0; i < LAYERS; i++)
		n->inner[i] = n->edge[i + 1] / n->edge[i];
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

/* Beyond the start of the tail; Marsaglia's exponential rejection. */
static double draw_tail(const struct normals *n, uint64_t place)
{
	uint64_t word[2];
	double x, y;

	do {
		draw(n, place, word);
		x = -log(uniform(word[0])) / tail_start;
		y = -log(uniform(word[1]));
		place += (uint64_t)2 << EXTRA_SHIFT;
	} while (2 * y < x * x);
	return tail_start + x;
}

/* Goes on where the first word fell outside the inner box of its layer; which = 0, 1. */
static double settle(
	const struct normals *n, uint64_t word, uint64_t index, uint64_t which)
{
	uint64_t place = index + ((1 + which) << EXTRA_SHIFT), next[2];

	for (;;) {
		size_t layer = word % LAYERS;
		double u = (double)((int64_t)word >> 11) * 0x1p-52,
		       x = u * n->edge[layer];
		double outer, inner;

		if (fabs(u) < n->inner[layer])
			return x;
		if (layer == 0)
			return copysign(draw_tail(n, place), u);
		draw(n, place, next);
		outer = exp(-0.5 * (n->edge[layer] * n->edge[layer] - x * x));
		inner = exp(-0.5 * (n->edge[layer + 1] * n->edge[layer + 1] - x * x));
		if (inner + uniform(next[1]) * (outer - inner) < 1)
			return x;
		word = next[0];
		place += (uint64_t)2 << EXTRA_SHIFT;
	}
}

/* The number that a random word stands for; which = 0, 1 of the pair. */
static inline double number(
	const struct normals *n, uint64_t word, uint64_t index, uint64_t which)
{
	size_t layer = word % LAYERS;
	double u = (double)((int64_t)word >> 11) * 0x1p-52;

	return fabs(u) < n->inner[layer] ? u * n->edge[layer]
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
