/* kernel.h - displacement of an elastic half-space under pressure
 *
 * A cell ax * ay under uniform pressure p sinks the point at (x, y) from its centre by
 * u = p I / (pi E*), I the integral of 1/r over the cell (Love 1929; Johnson, Contact
 * Mechanics, 3.25).  All lengths in one unit; I is a length.
 */
#ifndef CONTACT_KERNEL_H
#define CONTACT_KERNEL_H

/* I to full double precision (a few 1e-16 relative) everywhere outside the lines
 * |x| = ax / 2 and |y| = ay / 2, any aspect. */
double kernel_patch(double ax, double ay, double x, double y);

/* Factor of wavenumber (qx, qy), rad/m, in u^ = factor p^ of the periodic half-space:
 * 2 / (E* |q|), m/Pa; 0 at q = 0, where the mean displacement is taken as zero. */
double kernel_periodic(double estar, double qx, double qy);

/* 1 / E* = (1 - nu1^2) / E1 + (1 - nu2^2) / E2, (2-4); E2 = INFINITY is rigid. */
double kernel_modulus(double e1, double nu1, double e2, double nu2);

#endif
