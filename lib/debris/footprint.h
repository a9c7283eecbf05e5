/* footprint.h - regions of a surface that fail, and their features at the surface
 *
 * Under the column rule material falls from the surface down, so that the bodies torn off
 * are the regions of cells, joined along their sides, whose equivalent stress at the
 * surface exceeds the yield stress: their number and outlines need no stress below it.
 * The depth of a loss is found below one cell of each, by direct sums (point_sum.h).
 */
#ifndef DEBRIS_FOOTPRINT_H
#define DEBRIS_FOOTPRINT_H

#include "num/status.h"
#include "stress/stress.h"
#include <stddef.h>

/* Numbers without units that a loss below a region depends on. */
enum footprint_feature {
	FOOTPRINT_CELLS,     /* ln of their number */
	FOOTPRINT_MEAN,      /* ln of mean stress over yield stress */
	FOOTPRINT_MOST,      /* ln of largest stress over yield stress */
	FOOTPRINT_LOAD,      /* ln of 1 + load over area and yield stress */
	FOOTPRINT_PRESSURE,  /* ln of 1 + largest pressure over yield stress */
	FOOTPRINT_CONTACT,   /* loaded share of the cells */
	FOOTPRINT_UNEVEN,    /* ln of mean square over squared mean pressure */
	FOOTPRINT_SPREAD,    /* ln of mean square distance from the centroid over area */
	FOOTPRINT_NEIGHBOUR, /* ln of 1 + sum of load over squared distance and yield
			      * stress of the other regions and the load between them */
	FOOTPRINT_FRICTION,
	FOOTPRINT_POISSON,
	FOOTPRINT_DEPTH, /* ln of depth over root of area */
	FOOTPRINT_FEATURES
};

extern const char *const footprint_names[FOOTPRINT_FEATURES];

struct footprint {
	size_t cells;
	double area;            /* m2 */
	double x, y;            /* centroid, m */
	double low[2], high[2]; /* bounding box, m */
	size_t first;           /* its first cell in order of y and x */
	size_t most_at;         /* the cell of largest stress */
	double depth;           /* at which the stress below it is the yield stress, m */
	double feature[FOOTPRINT_FEATURES];
	/* what the features are made of */
	double load, squares, peak, stress_sum, stress_most, contact, spread;
};

struct footprints;

/* Free grids alone: on a periodic one a region may go round the grid. */
struct footprints *footprints_new(const struct stress_par *par); /* NULL: no memory */
void footprints_free(struct footprints *f);

/* Regions under the pressure, largest first, then in order of their first cells; *list is
 * valid until the next call. */
enum num_status footprints_find(struct footprints *f, struct stress *stress,
	const double *pressure, double yield, const struct footprint **list,
	size_t *count);

#endif
