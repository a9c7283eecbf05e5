#include "num/ziggurat.h"
#include <math.h>

/* Where the tail begins, and the area of a layer, of exp(-x^2 / 2). */
static const double tail_start = 3.442619855899, layer_area = 9.91256303526217e-3;

void ziggurat_make(struct ziggurat *z)
{
	double f = exp(-0.5 * tail_start * tail_start);

	z->edge[0] = layer_area / f;
	z->edge[1] = tail_start;
	for (int i = 2; i < ZIGGURAT_LAYERS; i++) {
		z->edge[i] = sqrt(-2 * log(layer_area / z->edge[i - 1] + f));
		f = exp(-0.5 * z->edge[i] * z->edge[i]);
	}
	z->edge[ZIGGURAT_LAYERS] = 0;
	for (int i = 0; i < ZIGGURAT_LAYERS; i++)
		z->inner[i] = z->edge[i + 1] / z->edge[i];
}

int ziggurat_under(const struct ziggurat *z, size_t layer, double x, double u)
{
	double e0 = z->edge[layer], e1 = z->edge[layer + 1];
	double outer = exp(-0.5 * (e0 * e0 - x * x)),
	       inner = exp(-0.5 * (e1 * e1 - x * x));

	return inner + u * (outer - inner) < 1;
}

/* Marsaglia's exponential rejection. */
double ziggurat_tail(double u, double v)
{
	double x = -log(u) / tail_start, y = -log(v);

	return 2 * y < x * x ? 0 : tail_start + x;
}
