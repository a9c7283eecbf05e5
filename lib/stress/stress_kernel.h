/* stress_kernel.h - stress in a half-space under uniformly loaded rectangles
 *
 * Half-space z >= 0 with z into the material, tension positive.  A pressure p > 0
 * pushes along +z (sigma_zz = -p under it); a shear s > 0 acts on the material along
 * +x or +y (sigma_xz = -s under it, the outer normal being -z).  All lengths in one
 * unit, of any size: the stresses depend on their ratios alone.
 *
 * Love's and Cerruti's solutions as printed by Liu and Wang, J. Tribol. 124 (2002)
 * 36-45, with two signs corrected (the logarithm of sigma_xx and the whole of sigma_yz
 * under shear) and every term rewritten so that R + x, R + y near zero loses no digits.
 */
#ifndef CONTACT_STRESS_KERNEL_H
#define CONTACT_STRESS_KERNEL_H

enum stress_component {
	STRESS_XX,
	STRESS_YY,
	STRESS_ZZ,
	STRESS_XY,
	STRESS_XZ,
	STRESS_YZ,
	STRESS_COMPONENTS
};

/* Stress at (x, y, z) under a unit pressure (normal) and a unit shear along +x (shear,
 * may be NULL) on |x| <= a, |y| <= b.  Exact to 2e-15 of the load.  On the edges of the
 * rectangle at z = 0 some components are infinite; elsewhere all are finite. */
void stress_patch(double a, double b, double nu, double x, double y, double z,
	double normal[STRESS_COMPONENTS], double shear[STRESS_COMPONENTS]);

/* Stress times distance squared at distance one from a unit point load: direction
 * (x, y, z) of unit length, z >= 0.  Pressure 1 and shear mu along +x together. */
void stress_point(double nu, double mu, double x, double y, double z,
	double stress[STRESS_COMPONENTS]);

/* Influence of a grid of cells ax by ay at depth z: for offsets 0 <= i < wx, 0 <= j < wy,
 * normal and shear[(j * wx + i) * 6 + component].  shear may be NULL.  Corners are
 * shared between neighbours; beyond 64 cells, where their differences cancel, the point
 * load is integrated over the cell instead, which keeps the relative error below 1e-11.
 */
int stress_cells(double ax, double ay, double nu, double z, int wx, int wy,
	double *normal, double *shear);

/* 1 where the component changes sign with x (axis 0) or y (axis 1), for pressure; under
 * shear along an axis the parity in that axis is the other one. */
int stress_odd(enum stress_component component, int axis);

/* von Mises stress, with the three differences of (2-10) taken in turn. */
double stress_von_mises(const double stress[STRESS_COMPONENTS]);

/* Principal stresses, largest (most tensile) first. */
void stress_principal(const double stress[STRESS_COMPONENTS], double principal[3]);

#endif
