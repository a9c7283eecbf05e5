/* surface.h - heights on a grid: preparing measured ones, shape, areal parameters
 *
 * Heights z[iy * nx + ix], in metres, stand for cells of dx by dy; nothing is assumed
 * to be periodic.  Missing samples are nan.  Functions that need memory return 0
 * when there is none, else 1.
 *
 *	surface_level(nx, ny, z);
 *	surface_measure(nx, ny, dx, dy, z, &par);
 *	printf("%g %g\n", par.sq, par.sdq);
 */
#ifndef CONTACT_SURFACE_H
#define CONTACT_SURFACE_H

#include <stddef.h>

/* ---- preparing ---- */

/* Missing samples. */
size_t surface_missing(int nx, int ny, const double *z);

/* Replaces missing samples by the solution of Laplace's equation on the grid, the
 * known ones fixed, no slope across the rim.  At least one sample must be known.
 * *iterations counts conjugate-gradient steps. */
int surface_fill(int nx, int ny, double *z, int *iterations);

/* Subtracts the least-squares plane. */
void surface_level(int nx, int ny, double *z);

/* Cuts mx by my samples, from (x0, y0) on, out of rows of nx. */
void surface_crop(int nx, const double *z, int x0, int y0, int mx, int my, double *out);

/* Brings heights to mx by my samples of the same area: the mean over the new cell
 * where it is larger than the old one, cubic convolution (Keys, IEEE Trans. ASSP 29,
 * 1981; third order, straight lines exact up to the rim) where it is smaller. */
int surface_resample(int nx, int ny, const double *z, int mx, int my, double *out);

/* Adds the paraboloid of revolution that is 0 in the middle of the area and -drop at
 * its corners. */
void surface_crown(int nx, int ny, double dx, double dy, double drop, double *z);

/* ---- measuring ---- */

double surface_mean(int nx, int ny, const double *z);
double surface_sa(int nx, int ny, const double *z); /* mean |z - mean| */
double surface_sq(int nx, int ny, const double *z); /* rms of z - mean */

/* Parameters of ISO 25178-2, heights taken from their mean; nan where a surface has
 * too few points for one. */
struct surface_parameters {
	double sa, sq, ssk, sku, sp, sv, sz;
	/* Root mean square gradient; what stands for the derivatives differs: */
	double sdq;         /* differences of neighbours, mean square over all of them */
	double sdq_cell;    /* the same over the corners that have both differences */
	double sdq_2x2;     /* differences of two-point means over 2 by 2 samples */
	double sdq_central; /* (z[i+1] - z[i-1]) / 2 dx, inner samples */
	double sdq_iso7;    /* seven-point formula, inner samples */
	double sdr; /* area of the triangulated surface over projected area, less 1 */
	double sal, str; /* autocorrelation down to 0.2: shortest lag, m; over longest */
	double corr_x, corr_y; /* lag along x and y where it falls to 1/e, m */
};

int surface_measure(int nx, int ny, double dx, double dy, const double *z,
	struct surface_parameters *par);

#endif
