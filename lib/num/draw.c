/* draw.c - see draw.h */
#include "num/draw.h"
#include "num/ziggurat.h"
#include <math.h>
#include <stdlib.h>

enum { WORDS = 4 * PHILOX_ROW };

struct draw {
	uint32_t counter[4];
	uint32_t word[4][PHILOX_ROW]; /* of one counter after another */
	unsigned used;                /* words used, of 4 PHILOX_ROW */
	uint32_t key[2];              /* from here on no state */
	struct ziggurat layers;
};

struct draw *draw_new(uint64_t seed, uint32_t realisation, enum rng_purpose purpose)
{
	struct draw *d = calloc(1, sizeof *d);

	if (!d)
		return NULL;
	d->key[0] = (uint32_t)seed;
	d->key[1] = (uint32_t)(seed >> 32);
	d->counter[2] = realisation;
	d->counter[3] = purpose;
	d->used = WORDS;
	ziggurat_make(&d->layers);
	return d;
}

void draw_free(struct draw *draw)
{
	free(draw);
}

void draw_pass(struct draw *d, struct state *s)
{
	state_move(s, d, offsetof(struct draw, key));
}

static inline uint32_t word_at(const struct draw *d, unsigned k)
{
	return d->word[k % 4][k / 4];
}

static void refill(struct draw *d)
{
	philox4x32_row(d->counter, d->key, d->word);
	d->counter[0] += PHILOX_ROW;
	d->counter[1] += d->counter[0] < PHILOX_ROW;
	d->used = 0;
}

static uint32_t next_word(struct draw *d)
{
	if (d->used == WORDS)
		refill(d);
	return word_at(d, d->used++);
}

double draw_uniform(struct draw *d)
{
	uint64_t high = next_word(d);

	return ((double)((high << 32 | next_word(d)) >> 12) + 0.5) * 0x1p-52;
}

static double draw_tail(struct draw *d)
{
	double x;

	do {
		double u = draw_uniform(d);

		x = ziggurat_tail(u, draw_uniform(d));
	} while (x == 0);
	return x;
}

/* For the words that do not decide at once. */
static double draw_rest(struct draw *d, unsigned layer, double x)
{
	if (layer == 0)
		return copysign(draw_tail(d), x);
	return ziggurat_under(&d->layers, layer, x, draw_uniform(d)) ? x : draw_normal(d);
}

/* Fills z from the words that are left; returns how many of n.  Seven bits of a word
 * select the layer, the others are the signed position in it. */
static size_t fill(struct draw *d, double *z, size_t n)
{
	unsigned first = d->used;
	size_t most = WORDS - first < n ? WORDS - first : n;

	for (size_t i = 0; i < most; i++) {
		uint32_t w = word_at(d, first + (unsigned)i), layer = w % ZIGGURAT_LAYERS;
		double u =
			((double)(int32_t)(w - layer) + 0.5 * ZIGGURAT_LAYERS) * 0x1p-31;

		z[i] = u * d->layers.edge[layer];
		if (fabs(u) >= d->layers.inner[layer]) {
			d->used = first + (unsigned)i + 1;
			z[i] = draw_rest(d, layer, z[i]);
			return i + 1;
		}
	}
	d->used = first + (unsigned)most;
	return most;
}

void draw_normals(struct draw *d, double *z, size_t n)
{
	for (size_t i = 0; i < n;) {
		if (d->used == WORDS)
			refill(d);
		i += fill(d, z + i, n - i);
	}
}

double draw_normal(struct draw *d)
{
	double z;

	draw_normals(d, &z, 1);
	return z;
}
