/* influence.h - influence of loaded cells, or of waves, on the stress at one depth
 *
 * Pressure 1 and shear mu together, as the numbers the von Mises stress is made of; one
 * more makes the tensor of them.  See stress.h for conventions.
 */
#ifndef CONTACT_INFLUENCE_H
#define CONTACT_INFLUENCE_H

#include "stress/stress.h"
#include "stress/stress_kernel.h"

#include <complex.h>

/* xx - zz, yy - zz, xy, xz, yz; and zz. */
enum influence_number {
	DEV_X,
	DEV_Y,
	DEV_XY,
	DEV_XZ,
	DEV_YZ,
	MISES_NUMBERS,
	DEV_ZZ = MISES_NUMBERS,
	TENSOR_NUMBERS
};

double influence_mises(const double number[MISES_NUMBERS]);

/* 1 where under pressure a number changes sign with x (axis 0) or y (axis 1). */
int influence_odd(enum influence_number number, int axis);

/* Coefficients of cells for offsets 0 <= i < wx, 0 <= j < wy; the others follow by
 * symmetry. */
struct influence {
	const struct stress_par *par;
	int wx, wy;
	double *normal, *shear; /* as stress_cells() made them; shear NULL if mu = 0 */
};

/* 0, or -1 when out of memory. */
int influence_new(
	struct influence *f, const struct stress_par *par, double z, int wx, int wy);
void influence_free(struct influence *f);

/* All offsets |i| < wx, |j| < wy: table[((wy-1 + j)(2 wx - 1) + wx-1 + i) MISES_NUMBERS +
 * number]. */
void influence_table(const struct influence *f, double *table);
/* One number on a plane of px times py points, negative offsets wrapped around. */
void influence_plane(const struct influence *f, enum influence_number number,
	double *plane, size_t px, size_t py);

/* Response to the wave exp(i (kx x + ky y)) of pressure on a periodic surface: plane
 * strain along the wave vector, antiplane across it; the mean load meets a laterally
 * confined half-space (Westergaard; Johnson, Contact Mechanics, 13.1). */
void influence_wave(const struct stress_par *par, double kx, double ky, double z,
	double complex number[TENSOR_NUMBERS]);

#endif
