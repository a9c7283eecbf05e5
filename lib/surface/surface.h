/* surface.h - heights on a grid: processing of measured heights, crowns, mean heights
 *
 * Heights z[iy * nx + ix], in metres, are those of cells of dx by dy; nothing is assumed
 * to be periodic.  Missing samples are nan.
 *
 *	surface_level(nx, ny, z);
 *	printf("%g\n", surface_sq(nx, ny, z));
 */
#ifndef SURFACE_SURFACE_H
#define SURFACE_SURFACE_H

#include "num/status.h"
#include <stddef.h>

/* ---- preparing ---- */

/* Missing samples. */
size_t surface_missing(int nx, int ny, const double *z);

/* Replaces missing samples by the solution of Laplace's equation on the grid with fixed
 * known samples and no slope across the edge.  At least one sample must be known.
 * *iterations counts conjugate-gradient steps, *residual receives the residual over the
 * first one; above SURFACE_FILLED the iteration stopped before it converged. */
#define SURFACE_FILLED 1e-13
enum num_status surface_fill(int nx, int ny, double dx, double dy, double *z,
	int *iterations, double *residual);

/* Subtracts the least-squares plane. */
void surface_level(int nx, int ny, double *z);

/* Extracts mx by my samples, from (x0, y0) on, from rows of nx. */
void surface_crop(int nx, const double *z, int x0, int y0, int mx, int my, double *out);

/* Resamples heights to mx by my samples of the same area: the mean over the new cell
 * where it is larger than the old one, cubic convolution (Keys, IEEE Trans. ASSP 29,
 * 1981; third order, straight lines exact up to the edge) where it is smaller. */
enum num_status surface_resample(
	int nx, int ny, const double *z, int mx, int my, double *out);

/* Adds the paraboloid of revolution that is 0 in the middle of the area and -drop at
 * its corners. */
void surface_crown(int nx, int ny, double dx, double dy, double drop, double *z);

/* ---- measuring ---- */

double surface_mean(int nx, int ny, const double *z);
double surface_sa(int nx, int ny, const double *z); /* mean |z - mean| */
double surface_sq(int nx, int ny, const double *z); /* rms of z - mean */

#endif
