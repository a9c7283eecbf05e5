/* footprint.h - regions of a surface that fail, and the volumes torn off below them
 *
 * Under the column rule material falls from the surface down, so that the bodies torn off
 * are the regions of cells, joined along their sides, whose equivalent stress at the
 * surface exceeds the yield stress: their number and outlines need no stress below it.
 * The volume of each is its area times the mean depth of the loss below some of its
 * cells, found by direct sums (point_sum.h): all cells of small regions and of surfaces
 * that lose few columns, of others every so many in the order of rows.  How much the
 * depth varies from one to the next gives the standard error.  What the sums are off by
 * is found at some cells of the surface, by careful sums; it changes a volume as much as
 * the depth of the yield stress changes with the stress.
 */
#ifndef DEBRIS_FOOTPRINT_H
#define DEBRIS_FOOTPRINT_H

#include "num/status.h"
#include "stress/stress.h"
#include <stddef.h>

struct footprint {
	size_t cells;
	double area;            /* m2 */
	double border;          /* length of its outline on the border of the grid, m */
	double x, y;            /* centroid, m */
	double low[2], high[2]; /* bounding box, m */
	size_t first;           /* its first cell in order of y and x */
	double stress;          /* the largest at the surface, Pa */
	double volume;          /* m3; nan: deeper than debris.h allows */
	double error;   /* standard error of the volume by cells left out, m3; 0: none was
			 */
	double freedom; /* degrees of freedom of that */
	double change; /* of the volume by a relative one of the stress below it, to first
			* order, m3 */
	double sums;   /* standard error of the volume by the direct sums, m3 */
	double jumps;  /* standard error of the volume by cells that may end at another
			* depth, m3 */
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
