/* ziggurat.h - the layers under the normal curve that normals.h and draw.h share
 *
 * Marsaglia and Tsang (J. Stat. Softw. 5(8), 2000) as repaired by Doornik (2005): the
 * caller takes layer and place u within it from different bits.
 *
 *	x = u * z.edge[layer];
 *	if (fabs(u) < z.inner[layer])
 *		return x;
 *	if (layer == 0)
 *		try ziggurat_tail() until it is above 0, with the sign of u
 *	else if (!ziggurat_under(&z, layer, x, another))
 *		begin again
 */
#ifndef NUM_ZIGGURAT_H
#define NUM_ZIGGURAT_H

#include <stddef.h>

enum { ZIGGURAT_LAYERS = 128 };

/* Layers of equal area; the lowest, 0, holds the tail. */
struct ziggurat {
	double edge[ZIGGURAT_LAYERS + 1]; /* right ends, falling to 0 */
	double inner[ZIGGURAT_LAYERS];    /* share of a layer that lies entirely under the
					     curve */
};

void ziggurat_make(struct ziggurat *z);

/* 1 if x, of a layer above the lowest, lies under the curve at the height given by u,
 * uniform in (0, 1). */
int ziggurat_under(const struct ziggurat *z, size_t layer, double x, double u);

/* A number of the tail from two uniform ones; 0: rejected, try again. */
double ziggurat_tail(double u, double v);

#endif
