/* material.c - see material.h */
#include "signal/pulse/material.h"
#include "num/sigmas.h"
#include <complex.h>
#include <math.h>
#include <string.h>

/* The value that defined the ampere until 2019, from which the measured one differs by
 * 5e-10 of it, V s/(A m). */
static const double vacuum_permeability = 4e-7 * M_PI;

/* u(x) for x^2 = -2 i s.  Backwards from where x^2 is small against the squares of the
 * terms: with n terms the rest is below (s / 2 n^2)^n. */
static double complex fraction(double s)
{
	double complex square = -2 * I * s, u = 0;

	for (int k = 2 * (int)(20 + sqrt(2 * s)) + 5; k >= 5; k -= 2)
		u = square / (k - u);
	return u;
}

/* The same by u = 3 - x^2 / (1 - x cot x) for large s, where nothing cancels. */
static double complex closed(double s)
{
	double root = sqrt(s);
	double complex x = root - I * root, e = cexp(-2 * I * x);

	return 3 - x * x / (1 - x * I * (1 + e) / (1 - e));
}

struct polarisability sphere_polarisability(
	double radius, double frequency, double mu, double sigma)
{
	double s = M_PI * frequency * vacuum_permeability * mu * sigma * radius * radius;
	double complex u = s < 400 ? fraction(s) : closed(s);
	double p = creal(u), q = cimag(u), a = 2 * (mu - 1) + p, b = mu + 2 - p;
	double square = b * b + q * q;

	/* (a + i q) / (b - i q), where a + b = 3 mu. */
	return (struct polarisability){ (a * b - q * q) / square, 3 * mu * q / square };
}

/* Permeabilities of small fields and conductivities as handbooks have them for common
 * grades; ferrous is the limit that d^3 stands for. */
static const struct material materials[] = {
	{ "ferrous", INFINITY, 0 },
	{ "steel", 200, 5e6 },
	{ "cast-iron", 100, 1e6 },
	{ "nickel", 100, 1.43e7 },
	{ "stainless", 1.02, 1.4e6 },
	{ "copper", 1, 5.8e7 },
	{ "aluminium", 1, 3.5e7 },
	{ "brass", 1, 1.5e7 },
	{ "bronze", 1, 8e6 },
	{ "lead", 1, 4.8e6 },
	{ "titanium", 1, 1.4e6 },
};

enum { MATERIALS = sizeof materials / sizeof *materials };

const struct material *material_at(int i)
{
	return i >= 0 && i < MATERIALS ? &materials[i] : NULL;
}

const struct material *material_find(const char *name)
{
	for (int i = 0; i < MATERIALS; i++)
		if (strcmp(materials[i].name, name) == 0)
			return &materials[i];
	return NULL;
}

struct polarisability material_response(
	const struct material *material, double diameter, double frequency)
{
	struct polarisability beta = { 2, 0 };

	if (isfinite(material->mu))
		beta = sphere_polarisability(
			diameter / 2, frequency, material->mu, material->sigma);
	return (struct polarisability){ beta.re / 2, beta.im / 2 };
}

int classify_is_ferrous(const struct material *m)
{
	return m->mu >= 4; /* 2 (mu - 1) / (mu + 2) = 1, half of 2 */
}

double classify_equivalent(const struct material *m, double d, double f)
{
	struct polarisability r = material_response(m, d, f);

	return d * cbrt(hypot(r.re, r.im));
}

double classify_diameter(const struct material *m, double size, double f)
{
	double low = size, high = 2 * size;

	while (classify_equivalent(m, high, f) < size && high < 1e6 * size)
		high *= 2;
	if (classify_equivalent(m, low, f) >= size)
		return low;
	while (high - low > 1e-9 * low) {
		double middle = 0.5 * (low + high);

		if (classify_equivalent(m, middle, f) < size)
			low = middle;
		else
			high = middle;
	}
	return low;
}

double classify_ferrous(const struct material *const *material, const double *share,
	int n, double size, double phase, double phase_se, double frequency)
{
	double sum[2] = { 0 }, nearest = INFINITY;

	if (!(size > 0) || !isfinite(size) || !isfinite(phase) || !(phase_se > 0))
		return NAN;
	for (int i = 0; i < n; i++) {
		const struct material *m = material[i];
		struct polarisability r = material_response(
			m, classify_diameter(m, size, frequency), frequency);
		double off = remainder(phase - atan2(r.im, r.re), 2 * M_PI) / phase_se;

		if (share[i] > 0)
			nearest = fmin(nearest, fabs(off));
		sum[classify_is_ferrous(m)] += share[i] * exp(-0.5 * off * off);
	}
	return nearest < SIGMAS_RARELY ? sum[1] / (sum[0] + sum[1]) : NAN;
}
