/* influence.h - influence coefficients of the stress below a point load, element or wave
 *
 * Influence coefficients of the stress differences of criterion.h, for unit pressure and
 * for unit shear.  Conventions and units are those of stress_kernel.h.
 *
 * The pressure is interpolated bilinearly between the cell centres: the element of a cell
 * is a pyramid of height 1 with a base of two by two cells around its centre, whose load
 * is that of the cell.  Cells of constant pressure would neglect the gradient of the
 * pressure, which under friction is a first-order error near the surface.
 */
#ifndef STRESS_INFLUENCE_H
#define STRESS_INFLUENCE_H

#include "stress/criterion.h"

#include <complex.h>

struct influence_par {
	double dx, dy; /* cell size */
	double nu, mu; /* Poisson's ratio, shear over pressure (either sign) */
	int axis;      /* shear along x (0) or y (1) */
};

/* Coefficients for unit pressure and for unit shear, at an offset from the load. */
struct influence {
	double normal[STRESS_NUMBERS], shear[STRESS_NUMBERS];
};

/* A point load equal to unit pressure on one cell. */
struct influence influence_point(
	const struct influence_par *par, double x, double y, double z);
/* An element, to 1e-6 of the load. */
struct influence influence_element(
	const struct influence_par *par, double x, double y, double z);
/* The same in half the time: to 2e-4 on the cell and its neighbours, beyond to 1e-4. */
struct influence influence_rough_element(
	const struct influence_par *par, double x, double y, double z);
/* The same two, weighted with 1 - w over the element; w(r) decreases smoothly from 1 to 0
 * at an ellipse of radii rx, ry about the point where the stress is evaluated. */
struct influence influence_outer_point(const struct influence_par *par, double x,
	double y, double z, double rx, double ry);
struct influence influence_outer_element(const struct influence_par *par, double x,
	double y, double z, double rx, double ry);
struct influence influence_less(struct influence a, const struct influence *b);

/* The sum of pressure and friction for one component, at the offset mirrored in x (mx)
 * and y (my). */
double influence_image(const struct influence_par *par, const struct influence *f,
	enum stress_number number, int mx, int my);
/* 1 if under pressure the component changes sign with x (axis 0) or y (axis 1). */
int influence_odd(enum stress_number number, int axis);

/* Response to the wave exp(i (kx x + ky y)) of pressure on a periodic surface: plane
 * strain along the wave vector, antiplane across it; the mean load acts on a laterally
 * confined half-space (Westergaard; Johnson, Contact Mechanics, 13.1). */
void influence_wave(const struct influence_par *par, double kx, double ky, double z,
	double complex number[STRESS_NUMBERS]);
/* An upper bound of the Frobenius norm of that response at depth x = q z, decreasing with
 * x. */
double influence_wave_bound(const struct influence_par *par, double x);

#endif
