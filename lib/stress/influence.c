#include "stress/influence.h"
#include "stress/stress_kernel.h"

#include <math.h>
#include <string.h>

static const enum stress_component component[STRESS_NUMBERS] = { [DEV_X] = STRESS_XX,
	[DEV_Y] = STRESS_YY,
	[DEV_XY] = STRESS_XY,
	[DEV_XZ] = STRESS_XZ,
	[DEV_YZ] = STRESS_YZ,
	[DEV_ZZ] = STRESS_ZZ };

int influence_odd(enum stress_number number, int axis)
{
	return stress_odd(component[number], axis);
}

/* Adds weight times a stress found for shear along x to the numbers; with swap, x and y
 * have changed places. */
static void add_numbers(double *number, const double *stress, double weight, int swap)
{
	double zz = stress[STRESS_ZZ];

	number[swap ? DEV_Y : DEV_X] += weight * (stress[STRESS_XX] - zz);
	number[swap ? DEV_X : DEV_Y] += weight * (stress[STRESS_YY] - zz);
	number[DEV_XY] += weight * stress[STRESS_XY];
	number[swap ? DEV_YZ : DEV_XZ] += weight * stress[STRESS_XZ];
	number[swap ? DEV_XZ : DEV_YZ] += weight * stress[STRESS_YZ];
	number[DEV_ZZ] += weight * zz;
}

static void add_point(const struct influence_par *p, double x, double y, double z,
	double weight, struct influence *f)
{
	double normal[STRESS_COMPONENTS], shear[STRESS_COMPONENTS];
	double area = weight * p->dx * p->dy;
	int swap = p->axis;

	stress_point_load(
		p->nu, swap ? y : x, swap ? x : y, z, normal, p->mu != 0 ? shear : NULL);
	add_numbers(f->normal, normal, area, swap);
	if (p->mu != 0)
		add_numbers(f->shear, shear, area, swap);
}

static void add_patch(const struct influence_par *p, double x, double y, double z,
	double weight, struct influence *f)
{
	double normal[STRESS_COMPONENTS], shear[STRESS_COMPONENTS];
	int swap = p->axis;

	stress_patch(0.5 * (swap ? p->dy : p->dx), 0.5 * (swap ? p->dx : p->dy), p->nu,
		swap ? y : x, swap ? x : y, z, normal, p->mu != 0 ? shear : NULL);
	add_numbers(f->normal, normal, weight, swap);
	if (p->mu != 0)
		add_numbers(f->shear, shear, weight, swap);
}

struct influence influence_point(
	const struct influence_par *p, double x, double y, double z)
{
	struct influence f = { { 0 }, { 0 } };

	add_point(p, x, y, z, 1, &f);
	return f;
}

/* Three points for the weight 1 - |x| on [-1, 1], exact to degree 5. */
enum { HAT = 3 };
static const double hat_node[HAT] = { -0.63245553203367586640, 0,
	0.63245553203367586640 };
static const double hat_weight[HAT] = { 5. / 24, 14. / 24, 5. / 24 };

/* Five Gauss points on [-1/2, 1/2]. */
enum { GAUSS = 5 };
static const double gauss_node[GAUSS] = { -0.45308992296933199640,
	-0.26923465505284154552, 0, 0.26923465505284154552, 0.45308992296933199640 };
static const double gauss_weight[GAUSS] = { 0.11846344252809454376,
	0.23931433524968323402, 0.28444444444444444444, 0.23931433524968323402,
	0.11846344252809454376 };

/* Points that crowd towards the ends of [-1/2, 1/2], x' = 30 t^2 (1 - t)^2, where the
 * stress on the edges of a loaded cell has logarithms and steps.  At the centres of the
 * cell and its neighbours 8, 12, 16, 24 and 32 of them along a side are off by 3e-3,
 * 9e-4, 4e-4, 1e-4 and 4e-5 of the pressure on the surface, and by 4e-3, 2e-4, 2e-5, 3e-6
 * and 9e-7 below it. */
enum { CROWD = 16, ROUGH_CROWD = 12 };

static double crowd(int k, int n, double *weight)
{
	double t = (k + 0.5) / n, u = 1 - t;

	*weight = 30 * t * t * u * u / n;
	return t * t * t * (10 - 15 * t + 6 * t * t) - 0.5;
}

/* On a line of symmetry what is odd across it vanishes; under shear the parity is the
 * other one along its axis. */
static void drop_odd(const struct influence_par *p, int axis, struct influence *f)
{
	for (int c = 0; c < STRESS_NUMBERS; c++) {
		int odd = influence_odd((enum stress_number)c, axis);

		if (odd)
			f->normal[c] = 0;
		if (odd ^ (p->axis == axis))
			f->shear[c] = 0;
	}
}

/* The pyramid is the mean of cells whose centres are spread over one cell: crowded points
 * to a side of it, or 0 for Gauss points.  On a line of symmetry half of them are enough.
 */
static void mean_of_patches(const struct influence_par *p, double x, double y, double z,
	int crowded, struct influence *f)
{
	int n = crowded ? crowded : GAUSS;

	for (int j = y == 0 ? n / 2 : 0; j < n; j++)
		for (int i = x == 0 ? n / 2 : 0; i < n; i++) {
			double wx = gauss_weight[i % GAUSS], wy = gauss_weight[j % GAUSS];
			double u = crowded ? crowd(i, n, &wx) : gauss_node[i];
			double v = crowded ? crowd(j, n, &wy) : gauss_node[j];

			wx *= x == 0 && u != 0 ? 2 : 1;
			wy *= y == 0 && v != 0 ? 2 : 1;
			add_patch(p, x - u * p->dx, y - v * p->dy, z, wx * wy, f);
		}
	if (x == 0)
		drop_odd(p, 0, f);
	if (y == 0)
		drop_odd(p, 1, f);
}

static struct influence element(
	const struct influence_par *p, double x, double y, double z, int crowded)
{
	struct influence f = { { 0 }, { 0 } };
	double side = fmax(p->dx, p->dy), r = sqrt(x * x + y * y + z * z) / side;
	/* At 1.25 cells and more in place of 1.5 five Gauss points are off by 1e-5 of the
	 * pressure, from 1.5 on by 1e-6. */
	int touches = fabs(x) < 1.5 * p->dx && fabs(y) < 1.5 * p->dy;
	/* At half a side down Gauss points are off by 3e-5 of the pressure, no more than
	 * crowded ones of rough elements, at 0.7 by 9e-6. */
	int shallow = z < (crowded == CROWD ? 1 : 0.5) * side;

	/* Three points leave about 0.06 / r^6 of the stress, 1e-4 at three cells. */
	if (r < (crowded == CROWD ? 4 : 3)) {
		mean_of_patches(p, x, y, z, touches && shallow ? crowded : 0, &f);
		return f;
	}
	for (int j = 0; j < HAT; j++)
		for (int i = 0; i < HAT; i++)
			add_point(p, x - hat_node[i] * p->dx, y - hat_node[j] * p->dy, z,
				hat_weight[i] * hat_weight[j], &f);
	return f;
}

struct influence influence_element(
	const struct influence_par *p, double x, double y, double z)
{
	return element(p, x, y, z, CROWD);
}

struct influence influence_rough_element(
	const struct influence_par *p, double x, double y, double z)
{
	return element(p, x, y, z, ROUGH_CROWD);
}

/* 1 - w: the incomplete beta function I_u(7/2, 5), u = r^2, 0 with six derivatives at the
 * centre (in r), 1 with four at the edge.  Of I_u(a, b) with a from 2 to 5 and b from 3
 * to 8 it leaves the least error below 30 contacts of 180 x 180 cells. */
static double outside(double x, double y, double rx, double ry)
{
	double u = x * x / (rx * rx) + y * y / (ry * ry), v = 1 - u;

	return u < 1 ? u * u * u * sqrt(u) *
			       (1 + v * (3.5 + v * (7.875 + v * (14.4375 +
									v * 23.4609375))))
		     : 1;
}

static void add_outer(const struct influence_par *p, double x, double y, double z,
	double rx, double ry, double weight, struct influence *f)
{
	weight *= outside(x, y, rx, ry);
	if (weight > 0)
		add_point(p, x, y, z, weight, f);
}

struct influence influence_outer_point(
	const struct influence_par *p, double x, double y, double z, double rx, double ry)
{
	struct influence f = { { 0 }, { 0 } };

	add_outer(p, x, y, z, rx, ry, 1, &f);
	return f;
}

struct influence influence_outer_element(
	const struct influence_par *p, double x, double y, double z, double rx, double ry)
{
	struct influence f = { { 0 }, { 0 } };

	for (int j = 0; j < HAT; j++)
		for (int i = 0; i < HAT; i++)
			add_outer(p, x - hat_node[i] * p->dx, y - hat_node[j] * p->dy, z,
				rx, ry, hat_weight[i] * hat_weight[j], &f);
	return f;
}

struct influence influence_less(struct influence a, const struct influence *b)
{
	for (int c = 0; c < STRESS_NUMBERS; c++) {
		a.normal[c] -= b->normal[c];
		a.shear[c] -= b->shear[c];
	}
	return a;
}

/* Under shear the parity is the other one along its axis. */
double influence_image(const struct influence_par *p, const struct influence *f,
	enum stress_number number, int mx, int my)
{
	int odd = (mx && influence_odd(number, 0)) ^ (my && influence_odd(number, 1));
	int shear_odd = odd ^ (p->axis ? my : mx);
	double n = f->normal[number], s = p->mu * f->shear[number];

	return (odd ? -n : n) + (shear_odd ? -s : s);
}

void influence_wave(const struct influence_par *p, double kx, double ky, double z,
	double complex out[STRESS_NUMBERS])
{
	double q = sqrt(kx * kx + ky * ky), e = exp(-q * z), nu = p->nu, a, b, along,
	       across;
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

double influence_wave_bound(const struct influence_par *p, double x)
{
	double normal = 2 + 4 * p->nu * p->nu + 4 * x * x;
	double shear = 10 - 8 * x + 4 * x * x + 4 * p->nu * p->nu;

	return exp(-x) * (sqrt(normal) + fabs(p->mu) * sqrt(shear));
}
