/* stress_kernel.h - stress in a half-space under uniformly loaded rectangles
 *
 * Half-space z >= 0 with z into the material, tension positive.  A pressure p > 0
 * pushes along +z (sigma_zz = -p under it); a shear s > 0 acts on the material along
 * +x or +y (sigma_xz = -s under it, the outer normal being -z).  All lengths in one
 * unit, of any size: the stresses depend on their ratios alone.
 *
 * Love's and Cerruti's solutions as printed by Liu and Wang, J. Tribol. 124 (2002)
 * 36-45, with two signs corrected (the logarithm of sigma_xx and all of sigma_yz under
 * shear) and every term rewritten to avoid cancellation in R + x and R + y.
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

/* Stress under a unit point load, normal and along +x (shear, may be NULL), at a point
 * other than the load's. */
void stress_point_load(double nu, double x, double y, double z,
	double normal[STRESS_COMPONENTS], double shear[STRESS_COMPONENTS]);
/* Both together, pressure 1 and shear mu. */
void stress_point(double nu, double mu, double x, double y, double z,
	double stress[STRESS_COMPONENTS]);

/* 1 if under pressure the component changes sign with x (axis 0) or y (axis 1); under
 * shear along an axis the parity in that axis is opposite. */
int stress_odd(enum stress_component component, int axis);

/* von Mises stress, (2-10) with its three differences corrected. */
double stress_von_mises(const double stress[STRESS_COMPONENTS]);

/* Principal stresses, largest (most tensile) first. */
void stress_principal(const double stress[STRESS_COMPONENTS], double principal[3]);

#endif
