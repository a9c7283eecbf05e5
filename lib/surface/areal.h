/* areal.h - areal parameters of heights on a grid as in surface.h
 *
 *	if (surface_measure(nx, ny, dx, dy, z, &par) == NUM_OK)
 *		printf("%g %g\n", par.sq, par.sdq);
 */
#ifndef SURFACE_AREAL_H
#define SURFACE_AREAL_H

#include "num/status.h"

/* Parameters of ISO 25178-2 of heights minus their mean; nan if a surface has too few
 * points for a parameter. */
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

enum num_status surface_measure(int nx, int ny, double dx, double dy, const double *z,
	struct surface_parameters *par);

#endif
