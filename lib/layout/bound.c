#include "layout/bound.h"
#include "num/status.h"
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* Steps of the integrals: error 1e-12 for the Gaussian, which is smooth. */
enum { STEPS = 4096 };

void bound_energies(enum pulse_shape shape, double energy[3])
{
	double reach = pulse_reach(shape), h = 2.0 / STEPS;

	energy[0] = energy[1] = energy[2] = 0;
	if (shape == PULSE_SINE) {
		energy[0] = 0.5;
		energy[1] = 2 * M_PI * M_PI;
		energy[2] = M_PI * M_PI / 6 + 0.25;
		return;
	}
	/* Trapezoidal rule in u, s = reach sinh(8 u) / sinh(8), which is dense at the
	 * lobes. */
	for (int i = 1; i < STEPS; i++) {
		double u = -1 + i * h, s = reach * sinh(8 * u) / sinh(8.0);
		double weight = h * reach * 8 * cosh(8 * u) / sinh(8.0);
		double p = pulse_value(shape, s), q = pulse_slope(shape, s);

		energy[0] += weight * p * p;
		energy[1] += weight * q * q;
		energy[2] += weight * s * s * q * q;
	}
}

/* Fisher matrix of (arrival at the mean position over T, ln v, ln A), the lower half. */
struct fisher {
	double tt, tv, vv, ta, va, aa;
};

/* Variances from the Fisher matrix; offset: of the first coil from the mean position, in
 * zones. */
static void invert(const struct fisher *f, double offset, double variance[4])
{
	double vv, va, aa, det;

	for (int k = 0; k < 4; k++)
		variance[k] = INFINITY;
	if (!(f->tt > 0))
		return;
	vv = f->vv - f->tv * f->tv / f->tt;
	va = f->va - f->tv * f->ta / f->tt;
	aa = f->aa - f->ta * f->ta / f->tt;
	det = vv * aa - va * va;
	/* Below the rounding of 4096 terms, 1e-13, the determinant is 0. */
	if (!(det > 1e-13 * vv * aa))
		return;
	/* of ln v, ln A, ln d and of the arrival t + offset ln v */
	variance[1] = aa / det;
	variance[2] = vv / det;
	variance[3] = (aa + vv + 2 * va) / det / 9;
	/* t = -(tv ln v + ta ln A) / tt + what is independent of both */
	double gv = offset - f->tv / f->tt, ga = -f->ta / f->tt;

	variance[0] = 1 / f->tt + (gv * gv * aa - 2 * gv * ga * va + ga * ga * vv) / det;
}

static void put(const struct bound_par *par, const double variance[4], struct bound *b)
{
	b->time = sqrt(variance[0]) * par->zone / par->velocity;
	b->velocity = sqrt(variance[1]) * par->velocity;
	b->amplitude = sqrt(variance[2]);
	b->diameter = sqrt(variance[3]);
}

static double mean(const double *x, int n)
{
	double sum = 0;

	for (int i = 0; i < n; i++)
		sum += x[i];
	return sum / n;
}

void bound_closed(
	const struct bound_par *par, const double *coil, int coils, struct bound *b)
{
	double e[3], variance[4], middle = mean(coil, coils), spread = 0;
	double c = par->snr * par->snr * par->rate * par->zone / par->velocity;
	struct fisher f = { 0 };

	bound_energies(par->shape, e);
	for (int m = 0; m < coils; m++) {
		double x = (coil[m] - middle) / par->zone;

		spread += x * x;
	}
	f.tt = c * coils * e[1];
	f.vv = c * (coils * e[2] + spread * e[1]);
	f.va = -c * coils * e[0] / 2;
	f.aa = c * coils * e[0];
	/* A faster particle arrives earlier at the first coil. */
	invert(&f, -(coil[0] - middle) / par->zone, variance);
	put(par, variance, b);
}

/* Adds the samples of one coil; t0 and T in samples, x in zones from the mean. */
static void add_coil(const struct bound_par *par, double t0, double T, double x,
	double *work, size_t room, struct fisher *f)
{
	double *p = work, *by_t0 = work + room, *by_T = work + 2 * room;
	double square = par->snr * par->snr;
	size_t n;
	long first = pulse_support(par->shape, t0, T, &n);

	pulse_sample(par->shape, t0, T, first, n, p, by_t0, by_T);
	for (size_t i = 0; i < n; i++) {
		/* derivatives by the arrival over T, and by ln v (which moves t0 by -x T
		 * and T by -T) */
		double t = by_t0[i] * T, v = -x * t - by_T[i] * T;

		f->tt += square * t * t;
		f->tv += square * t * v;
		f->vv += square * v * v;
		f->ta += square * t * p[i];
		f->va += square * v * p[i];
		f->aa += square * p[i] * p[i];
	}
}

enum num_status bound_sampled(const struct bound_par *par, const double *coil, int coils,
	int phases, struct bound *b)
{
	double T = par->zone / par->velocity * par->rate, middle = mean(coil, coils);
	double sum[4] = { 0 }, variance[4];
	double most = 2 * pulse_reach(par->shape) * T + 3, *work;
	size_t room;

	if (!(most < (double)(PTRDIFF_MAX / 3 / sizeof *work)))
		return NUM_MEMORY;
	room = (size_t)most;
	work = malloc(3 * room * sizeof *work);
	if (!work)
		return NUM_MEMORY;
	for (int k = 0; k < phases; k++) {
		struct fisher f = { 0 };

		for (int m = 0; m < coils; m++) {
			double x = (coil[m] - middle) / par->zone;

			add_coil(par, (k + 0.5) / phases + x * T, T, x, work, room, &f);
		}
		invert(&f, -(coil[0] - middle) / par->zone, variance);
		for (int j = 0; j < 4; j++)
			sum[j] += variance[j] / phases;
	}
	free(work);
	put(par, sum, b);
	return NUM_OK;
}
