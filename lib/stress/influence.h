/* influence.h - influence of a loaded point, element or wave on the stress below
 *
 * Pressure 1 and shear mu together, as the numbers of criterion.h.  Conventions and units
 * are those of stress_kernel.h.
 *
 * The pressure between the cell centres is interpolated bilinearly: the element of a cell
 * is a pyramid of height 1 over the four cells' widths around its centre, whose load is
 * that of the cell.  Cells of constant pressure would drop their own gradient, which
 * under friction is an error of first order near the surface.
 */
#ifndef STRESS_INFLUENCE_H
#define STRESS_INFLUENCE_H

#include "stress/criterion.h"

#include <complex.h>

struct influence_par {
	double ax, ay; /* cell size */
	double nu, mu; /* Poisson's ratio, shear over pressure (either sign) */
	int axis;      /* shear along x (0) or y (1) */
};

/* Numbers under pressure 1 and under shear 1, at an offset from the load. */
struct influence {
	double normal[STRESS_NUMBERS], shear[STRESS_NUMBERS];
};

/* A point load of one cell's area. */
struct influence influence_point(
	const struct influence_par *par, double x, double y, double z);
/* An element.  Right to 1e-6 of the load. */
struct influence influence_element(
	const struct influence_par *par, double x, double y, double z);
/* The same two, averaged with 1 - w over the element; w(r) falls smoothly from 1 to 0 at
 * an ellipse of radii rx, ry about the point where the stress is taken. */
struct influence influence_outer_point(const struct influence_par *par, double x,
	double y, double z, double rx, double ry);
struct influence influence_outer_element(const struct influence_par *par, double x,
	double y, double z, double rx, double ry);
struct influence influence_less(struct influence a, const struct influence *b);

/* A number at the offset mirrored in x (mx) and y (my). */
double influence_image(const struct influence_par *par, const struct influence *f,
	enum stress_number number, int mx, int my);
/* 1 where under pressure a number changes sign with x (axis 0) or y (axis 1). */
int influence_odd(enum stress_number number, int axis);

/* Response to the wave exp(i (kx x + ky y)) of pressure on a periodic surface: plane
 * strain along the wave vector, antiplane across it; the mean load meets a laterally
 * confined half-space (Westergaard; Johnson, Contact Mechanics, 13.1). */
void influence_wave(const struct influence_par *par, double kx, double ky, double z,
	double complex number[STRESS_NUMBERS]);
/* A bound of the Frobenius norm of that response at depth x = q z that falls with x. */
double influence_wave_bound(const struct influence_par *par, double x);

#endif
