/* kernel.h - displacement of an elastic body under pressure on its plane surface
 *
 * The solver accepts any struct contact_kernel in place of the half-space of a contact
 * modulus.
 *
 * Uniform pressure p on a cell dx * dy displaces the point at (x, y) from its centre by
 * u = p I / (pi E*), where I is the integral of 1/r over the cell (Love 1929; Johnson,
 * Contact Mechanics, 3.25).  All lengths have the same unit; I is a length.
 */
#ifndef CONTACT_KERNEL_H
#define CONTACT_KERNEL_H

struct contact_kernel {
	const void *context;
	/* Displacement at (x, y) from the centre of a cell dx * dy under unit pressure,
	 * m/Pa; NULL if it is not known: then only periodic boundaries are possible. */
	double (*patch)(const void *context, double dx, double dy, double x, double y);
	/* Factor in u^ = factor p^, m/Pa, at wavenumber q > 0, rad/m; falls with q. */
	double (*wave)(const void *context, double q);
};

/* The half-space of a contact modulus, which must outlive the kernel: wave factor
 * 2 / (E* q). */
struct contact_kernel kernel_halfspace(const double *estar);

/* A half-space under a bonded layer of another material, against an elastic body: wave
 * factor only (O'Sullivan, King, J. Tribol. 110 (1988) 235-240; Nogi, Kato, J. Tribol.
 * 119 (1997) 493-500). */
struct kernel_coating {
	double thickness;      /* m */
	double young, poisson; /* of the layer, Pa */
	double base_young, base_poisson;
	double other; /* (1 - nu^2) / E of the other body, 1/Pa; 0: rigid */
};
struct contact_kernel kernel_coated(const struct kernel_coating *coating);

/* I to full double precision (a few 1e-16 relative) everywhere outside the lines
 * |x| = dx / 2 and |y| = dy / 2, any aspect. */
double kernel_patch(double dx, double dy, double x, double y);

/* The part of I with the weight cos^2 of the angle to x, the integral of x^2 / r^3, to
 * some 1e-16 times the square of the distance in cells. */
double kernel_patch_along(double dx, double dy, double x, double y);

/* 1 / E* = (1 - nu1^2) / E1 + (1 - nu2^2) / E2, (2-4); E2 = INFINITY is rigid. */
double kernel_modulus(double e1, double nu1, double e2, double nu2);

#endif
