/* draw.c - see draw.h */
#include "life/draw.h"
#include <math.h>
#include <stdlib.h>

enum { LAYERS = 128, HALF = LAYERS / 2 };

/* Right end of the base layer and the common area of the layers. */
static const double TAIL = 3.442619855899;
static const double AREA = 9.91256303526217e-3;

struct draw {
	uint32_t counter[4], key[2];
	uint32_t word[4];
	int left;                /* words not yet used */
	double edge[LAYERS + 1]; /* abscissa where each layer ends */
	double share[LAYERS];    /* of a layer that lies under the curve all along */
};

struct draw *draw_new(uint64_t seed, uint32_t realisation, enum rng_purpose purpose)
{
	struct draw *d = calloc(1, sizeof *d);
	double f = exp(-0.5 * TAIL * TAIL);

	if (!d)
		return NULL;
	d->key[0] = (uint32_t)seed;
	d->key[1] = (uint32_t)(seed >> 32);
	d->counter[2] = realisation;
	d->counter[3] = purpose;
	d->edge[0] = AREA / f;
	d->edge[1] = TAIL;
	for (int i = 2; i < LAYERS; i++) {
		d->edge[i] = sqrt(-2 * log(AREA / d->edge[i - 1] + f));
		f = exp(-0.5 * d->edge[i] * d->edge[i]);
	}
	for (int i = 0; i < LAYERS; i++)
		d->share[i] = d->edge[i + 1] / d->edge[i];
	return d;
}

void draw_free(struct draw *draw)
{
	free(draw);
}

static inline uint32_t next_word(struct draw *d)
{
	if (d->left == 0) {
		philox4x32(d->counter, d->key, d->word);
		d->left = 4;
		if (++d->counter[0] == 0)
			d->counter[1]++;
	}
	return d->word[4 - d->left--];
}

double draw_uniform(struct draw *d)
{
	uint64_t high = next_word(d);

	return ((double)((high << 32 | next_word(d)) >> 12) + 0.5) * 0x1p-52;
}

/* Beyond the base layer: Marsaglia's exponential wedge. */
static double draw_tail(struct draw *d)
{
	double x, y;

	do {
		x = -log(draw_uniform(d)) / TAIL;
		y = -log(draw_uniform(d));
	} while (2 * y < x * x);
	return TAIL + x;
}

/* Where the first word does not settle it. */
static double draw_rest(struct draw *d, unsigned i, double x)
{
	double f0 = exp(-0.5 * (d->edge[i] * d->edge[i] - x * x));
	double f1 = exp(-0.5 * (d->edge[i + 1] * d->edge[i + 1] - x * x));

	if (i == 0)
		return copysign(draw_tail(d), x);
	return f1 + draw_uniform(d) * (f0 - f1) < 1 ? x : draw_normal(d);
}

/* Seven bits choose the layer, the others are the signed place in it. */
static inline double normal(struct draw *d)
{
	uint32_t w = next_word(d);
	unsigned i = w & (LAYERS - 1);
	double u = ((double)(int32_t)(w & ~(uint32_t)(LAYERS - 1)) + HALF) * 0x1p-31;
	double x = u * d->edge[i];

	return fabs(u) < d->share[i] ? x : draw_rest(d, i, x);
}

double draw_normal(struct draw *d)
{
	return normal(d);
}

void draw_normals(struct draw *d, double *z, size_t n)
{
	for (size_t i = 0; i < n; i++)
		z[i] = normal(d);
}

double chi2_from_normal(double freedom, double z)
{
	double spread = 2 / (9 * freedom), root = 1 - spread + sqrt(spread) * z;

	root = fmax(root, 0.1);
	return freedom * root * root * root;
}
