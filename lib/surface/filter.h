/* filter.h - areal Gaussian filters (ISO 16610-61), form removal, power spectrum
 *
 * The Gaussian filter of nesting index c transmits half of the amplitude of waves of
 * length c, and 2^-(c / l)^2 for length l. An S-filter is its output, an L-filter the
 * residual.  Near the edges a polynomial of order p in either direction is fitted with
 * the Gaussian weights to the samples inside: order 0 is the mean, order 1 reproduces
 * planes and order 2 paraboloids up to the edge.  The transmission of order 2 is (1 + pi
 * a^2 f^2) exp(-pi a^2 f^2), with a chosen so that it is half at c.
 *
 *	surface_gauss(nx, ny, dx, dy, z, 8e-6, FILTER_MEAN, smooth);
 */
#ifndef SURFACE_FILTER_H
#define SURFACE_FILTER_H

#include "num/status.h"

enum filter_ends {
	FILTER_MEAN,     /* order 0 */
	FILTER_LINE,     /* order 1 */
	FILTER_PARABOLA, /* order 2 */
	FILTER_PERIODIC  /* the surface repeats */
};

/* Fills out with the output of the filter; z and out may be the same. */
enum num_status surface_gauss(int nx, int ny, double dx, double dy, const double *z,
	double nesting, enum filter_ends ends, double *out);

/* The share of the amplitude of waves of two samples that passes a filter, less the share
 * that its index states.  The weights are those of a Gaussian at the samples: few of them
 * do not follow a narrow one, and of all waves, these pass most in excess. */
enum num_status surface_gauss_excess(
	double step, double nesting, enum filter_ends ends, double *excess);

/* Number of products in the sums of a filter: its work. */
double surface_gauss_products(
	int nx, int ny, double dx, double dy, double nesting, enum filter_ends ends);

enum form {
	FORM_PLANE,
	FORM_PARABOLOID, /* of revolution, axis along z, and a plane */
	FORM_POLY2,      /* all terms x^i y^j with i + j <= 2 */
	FORM_POLY3,
	FORM_POLY4,
	FORM_POLY5,
	FORM_POLY6
};

/* Subtracts the least-squares form; NUM_DOMAIN with too few points for it. */
enum num_status surface_form(
	int nx, int ny, double dx, double dy, enum form form, double *z);

/* One ring of the power spectrum: all waves whose frequency is k - 1/2 to k + 1/2 times
 * that of the longest wave along the shorter side. */
struct ring {
	double frequency; /* mean over its waves, 1/m */
	double power;     /* mean power spectral density over its waves, m4 */
	double waves; /* of both signs; power times waves over the area is the variance */
};

/* Writes the rings from k = 1 on, at most (int)hypot(nx, ny) + 2, to ring; *rings is
 * their number. The mean is subtracted; with a window the heights are multiplied by a
 * Hann window along both sides, whose mean square is divided out. */
enum num_status surface_spectrum(int nx, int ny, double dx, double dy, const double *z,
	int window, struct ring *ring, int *rings);

#endif
