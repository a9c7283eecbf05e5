#include "stress/influence.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = STRESS_COMPONENTS };

static const enum stress_component first[TENSOR_NUMBERS] = { [DEV_X] = STRESS_XX,
	[DEV_Y] = STRESS_YY,
	[DEV_XY] = STRESS_XY,
	[DEV_XZ] = STRESS_XZ,
	[DEV_YZ] = STRESS_YZ,
	[DEV_ZZ] = STRESS_ZZ };

double influence_mises(const double v[MISES_NUMBERS])
{
	double t = v[DEV_XY] * v[DEV_XY] + v[DEV_XZ] * v[DEV_XZ] + v[DEV_YZ] * v[DEV_YZ];
	double d = v[DEV_X] * v[DEV_X] + v[DEV_Y] * v[DEV_Y] - v[DEV_X] * v[DEV_Y];

	return sqrt(d + 3 * t);
}

int influence_odd(enum influence_number number, int axis)
{
	return stress_odd(first[number], axis);
}

static void swap_axes(double *t)
{
	double xx = t[STRESS_XX], xz = t[STRESS_XZ];

	t[STRESS_XX] = t[STRESS_YY];
	t[STRESS_YY] = xx;
	t[STRESS_XZ] = t[STRESS_YZ];
	t[STRESS_YZ] = xz;
}

/* Coefficients are found for shear along x; for shear along y the axes change places. */
int influence_new(
	struct influence *f, const struct stress_par *par, double z, int wx, int wy)
{
	size_t n = (size_t)wx * wy * N;
	int status;

	*f = (struct influence){ .par = par, .wx = wx, .wy = wy };
	f->normal = malloc(n * (par->mu > 0 ? 2 : 1) * sizeof(*f->normal));
	if (!f->normal)
		return -1;
	f->shear = par->mu > 0 ? f->normal + n : NULL;
	if (par->axis == 0)
		status = stress_cells(
			par->ax, par->ay, par->nu, z, wx, wy, f->normal, f->shear);
	else
		status = stress_cells(
			par->ay, par->ax, par->nu, z, wy, wx, f->normal, f->shear);
	if (status)
		influence_free(f);
	for (size_t i = 0; !status && par->axis && i < n; i += N) {
		swap_axes(f->normal + i);
		if (f->shear)
			swap_axes(f->shear + i);
	}
	return status;
}

void influence_free(struct influence *f)
{
	free(f->normal);
	f->normal = f->shear = NULL;
}

/* A number at an offset and its mirror images: value[flipy][flipx].  The parity under
 * shear is the other one along its axis. */
static void quadrants(const struct influence *f, enum influence_number number, int i,
	int j, double value[2][2])
{
	size_t at = (f->par->axis ? (size_t)i * f->wy + j : (size_t)j * f->wx + i) * N;
	int c = first[number], axis = f->par->axis;
	double p = f->normal[at + c], s = f->shear ? f->shear[at + c] : 0;

	if (number == DEV_X || number == DEV_Y) {
		p -= f->normal[at + STRESS_ZZ];
		s -= f->shear ? f->shear[at + STRESS_ZZ] : 0;
	}
	s *= f->par->mu;
	for (int fy = 0; fy < 2; fy++)
		for (int fx = 0; fx < 2; fx++) {
			int odd = (fx && stress_odd(c, 0)) ^ (fy && stress_odd(c, 1));
			int shear_odd = odd ^ (axis ? fy : fx);

			value[fy][fx] = (odd ? -p : p) + (shear_odd ? -s : s);
		}
}

void influence_table(const struct influence *f, double *table)
{
	ptrdiff_t row = 2 * (ptrdiff_t)f->wx - 1;
	double *middle = table + ((f->wy - 1) * row + f->wx - 1) * MISES_NUMBERS;

	for (int j = 0; j < f->wy; j++)
		for (int i = 0; i < f->wx; i++)
			for (int c = 0; c < MISES_NUMBERS; c++) {
				double v[2][2];

				quadrants(f, c, i, j, v);
				for (int k = 0; k < 4; k++) {
					int x = k & 1 ? -i : i, y = k & 2 ? -j : j;

					/* On an axis the image must not overwrite. */
					if ((k & 1 && !i) || (k & 2 && !j))
						continue;
					middle[(y * row + x) * MISES_NUMBERS + c] =
						v[k >> 1][k & 1];
				}
			}
}

void influence_plane(const struct influence *f, enum influence_number number,
	double *plane, size_t px, size_t py)
{
	memset(plane, 0, px * py * sizeof(*plane));
	for (int j = 0; j < f->wy; j++)
		for (int i = 0; i < f->wx; i++) {
			double v[2][2];

			quadrants(f, number, i, j, v);
			for (int k = 0; k < 4; k++) {
				size_t x = k & 1 ? px - i : (size_t)i;
				size_t y = k & 2 ? py - j : (size_t)j;

				if ((k & 1 && !i) || (k & 2 && !j))
					continue;
				plane[y * px + x] = v[k >> 1][k & 1];
			}
		}
}

void influence_wave(const struct stress_par *p, double kx, double ky, double z,
	double complex out[TENSOR_NUMBERS])
{
	double q = hypot(kx, ky), e = exp(-q * z), nu = p->nu, a, b, along, across;
	double complex ll, tt, zz, lt, lz, tz, xx, yy;

	if (q == 0) {
		out[DEV_X] = out[DEV_Y] = (1 - 2 * nu) / (1 - nu);
		out[DEV_XY] = 0;
		out[DEV_XZ] = p->axis == 0 ? -p->mu : 0;
		out[DEV_YZ] = p->axis == 1 ? -p->mu : 0;
		out[DEV_ZZ] = -1;
		return;
	}
	/* l along the wave vector (a, b), t across it. */
	a = kx / q, b = ky / q;
	along = p->mu * (p->axis == 0 ? a : b);
	across = p->mu * (p->axis == 0 ? -b : a);
	q *= z;
	ll = e * (q - 1 + I * along * (2 - q));
	tt = 2 * nu * e * (I * along - 1);
	zz = e * (-1 - q + I * along * q);
	lt = e * I * across;
	lz = e * (I * q - along * (1 - q));
	tz = -e * across;
	xx = a * a * ll + b * b * tt - 2 * a * b * lt;
	yy = b * b * ll + a * a * tt + 2 * a * b * lt;
	out[DEV_X] = xx - zz;
	out[DEV_Y] = yy - zz;
	out[DEV_XY] = a * b * (ll - tt) + (a * a - b * b) * lt;
	out[DEV_XZ] = a * lz - b * tz;
	out[DEV_YZ] = b * lz + a * tz;
	out[DEV_ZZ] = zz;
}
