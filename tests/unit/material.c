/* The moment of a sphere against golden values, its limits and a solution of the field
 * equation by power series. */
#include "signal/pulse/material.h"
#include "tap.h"
#include <complex.h>
#include <string.h>

static const double mu0 = 4e-7 * M_PI;

/* Inside the sphere the potential f(r) sin(theta) obeys f'' + 2 f' / r - 2 f / r^2 = k^2
 * f with k^2 = i w mu0 mu sigma: f = r + sum of c_n r^(2n+1), c_n = c_(n-1) k^2 / (2n
 * (2n+3)). Outside it is that of the field and of a dipole; f and (r f)' / mu are
 * continuous. */
static double complex by_series(double a, double frequency, double mu, double sigma)
{
	long double complex z =
		I * (long double)(2 * M_PI * frequency * mu0 * mu * sigma) * a * a;
	/* f / r, and what (r f)' / r has beyond 2 f / r */
	long double complex term = 1, f = 1, more = 0;

	for (int n = 1; n < 200; n++) {
		term *= z / (2.0L * n * (2 * n + 3));
		f += term;
		more += 2 * n * term;
	}
	more /= f;
	return (double complex)((2 * (mu - 1) - more) / (mu + 2 + more));
}

static void test_golden(void)
{
	static const struct {
		double a, f, mu, sigma, re, im;
	} row[] = { { 50e-6, 1e5, 1, 5.8e7, -8.32103627821e-5, -7.6315414178458e-3 },
		{ 50e-6, 1e5, 200, 5e6, 1.9699611400026, -5.7753351573762e-3 } };

	for (int i = 0; i < 2; i++) {
		struct polarisability b = sphere_polarisability(
			row[i].a, row[i].f, row[i].mu, row[i].sigma);

		near(b.re / row[i].re, 1, 1e-12,
			"the real part is that of the reference");
		near(b.im / row[i].im, 1, 1e-12,
			"the imaginary part is that of the reference");
	}
}

static const double radius = 50e-6, conductivity = 1e6;

/* At which the radius is so many skin depths. */
static double frequency_of(double ratio, double mu)
{
	return ratio * ratio / (M_PI * mu0 * mu * conductivity * radius * radius);
}

/* Largest relative errors of the moment and of its imaginary part. */
struct errors {
	double moment, imaginary;
};

static void compare(struct errors *e, double f, double mu, double complex want)
{
	struct polarisability b = sphere_polarisability(radius, f, mu, conductivity);

	e->moment = tap_max(e->moment, cabs(b.re + I * b.im - want) / cabs(want));
	e->imaginary = tap_max(e->imaginary, fabs(b.im / cimag(want) - 1));
}

/* Of a / delta up to 4 the series loses e^4 to cancellation, 2e-18 of long doubles. */
static void test_series(void)
{
	struct errors worst = { 0 };

	for (double ratio = 1e-4; ratio < 4; ratio *= 1.7)
		for (double mu = 1; mu < 2e5; mu *= 7) {
			double f = frequency_of(ratio, mu);

			compare(&worst, f, mu, by_series(radius, f, mu, conductivity));
		}
	ok(worst.moment < 1e-13,
		"a series solution of the field equation gives the moment to %.1g",
		worst.moment);
	ok(worst.imaginary < 1e-12,
		"the field equation confirms the imaginary part (%.1g)", worst.imaginary);
}

/* Wait's form in long doubles: 1 - x cot x = x^2 / (3 - x^2 / (5 - x^2 / (7 - ...))),
 * backwards from beyond |x|, and beta = (2 mu - Q) / (mu + Q) with Q = x^2 / (1 - x cot
 * x) - 1. */
static double complex by_fraction(double ratio, double mu)
{
	long double complex square = -2 * I * (long double)ratio * ratio, tail = 0, q;

	for (int k = 2 * (int)(200 + 4 * ratio) + 1; k >= 3; k -= 2)
		tail = square / (k - tail);
	q = square / tail - 1;
	return (double complex)((2 * mu - q) / (mu + q));
}

static void test_thin_skin(void)
{
	struct errors worst = { 0 };

	for (double ratio = 1; ratio < 1.1e4; ratio *= 1.9)
		for (double mu = 1; mu < 1.1e5; mu *= 10) {
			double f = frequency_of(ratio, mu);

			compare(&worst, f, mu, by_fraction(ratio, mu));
		}
	ok(worst.moment < 1e-12,
		"up to 1e4 skin depths and mu 1e5 the moment is that of Wait's form (%.1g)",
		worst.moment);
	ok(worst.imaginary < 1e-11,
		"the imaginary part of the moment is that of Wait's form (%.1g)",
		worst.imaginary);
}

static void test_limits(void)
{
	struct polarisability b = sphere_polarisability(1e-4, 0, 150, 5e6);
	double a = 1e-5, f = 1e3, sigma = 5e7, s = M_PI * f * mu0 * sigma * a * a;
	double least = 0, value[3] = { 0 }, jump = 0;

	near(b.re, 2 * 149 / 152.0, 1e-15,
		"in a static field the polarisability is 2 (mu - 1) / (mu + 2)");
	ok(b.im == 0, "in a static field the moment is in phase");
	b = sphere_polarisability(a, f, 1, sigma);
	near(b.im / (-2 * s / 15), 1, 1e-6,
		"slow currents give an imaginary part of -(2/15) s");
	near(b.re / (-8 * s * s / 315), 1, 1e-6,
		"slow currents give a real part of -(8/315) s^2");
	b = sphere_polarisability(1, 1e12, 1, 6e7);
	near(b.re, -1, 1e-6, "fast currents give -1");
	/* 2.40922 is where the imaginary part of a non-magnetic sphere is least. */
	for (double r = 2.3; r < 2.5; r += 1e-3)
		least = fmin(least, sphere_polarisability(r, 1 / (M_PI * mu0), 1, 1).im);
	near(least, -0.355146, 1e-6, "the largest loss is right");
	/* from the fraction to the closed form at s = 400 */
	for (int i = 0; i < 2000; i++) {
		b = sphere_polarisability(19.9 + 1e-4 * i, 1 / (M_PI * mu0), 1, 1);
		value[0] = value[1];
		value[1] = value[2];
		value[2] = b.re;
		/* the second derivative is 3 / r^3 */
		if (i > 1)
			jump = tap_max(jump, fabs(value[2] - 2 * value[1] + value[0]));
	}
	ok(jump < 1e-11,
		"the polarisability is continuous where the formula changes (%.1g)",
		jump);
}

static void test_materials(void)
{
	struct polarisability b = material_response(material_find("ferrous"), 1e-4, 1e5);

	ok(b.re == 1 && b.im == 0, "ferrous particles follow the cube of the diameter");
	b = material_response(material_find("copper"), 1e-4, 1e5);
	near(b.im, -7.6315414178458e-3 / 2, 1e-14, "copper has half its polarisability");
	ok(!material_find("cheese") && !material_at(-1) && !material_at(1000),
		"an unknown material is not found");
	for (int i = 0; material_at(i); i++)
		ok(material_find(material_at(i)->name) == material_at(i),
			"the material %s is found", material_at(i)->name);
	/* The size of a non-ferrous particle that looks as large as 100 um of ferrous:
	 * d^5 = 60 d_F^3 / (pi f mu0 sigma) while its currents are slow; here they are
	 * not quite, and the law is 0.2 % off. */
	b = material_response(material_find("bronze"), 393e-6, 2e5);
	near(pow(3.93, 3) * hypot(b.re, b.im), 1, 0.1,
		"393 um of bronze look like 100 um");
}

/* A pulse of copper against a ferrous one of the same height, whose phase is 0. */
static void test_classes(void)
{
	const struct material *of[] = { material_find("ferrous"),
		material_find("copper") };
	double share[] = { 1, 3 }, f = 2e5, d = 2e-4, se = 0.7;
	struct polarisability b = material_response(of[1], d, f);
	double size = d * cbrt(hypot(b.re, b.im)), phase = atan2(b.im, b.re);
	double like = exp(-0.5 * phase * phase / (se * se)), worst = 0;

	for (int i = 0; material_at(i); i++) {
		double own = classify_diameter(material_at(i), 37e-6, 3e5);

		worst = fmax(worst,
			fabs(classify_equivalent(material_at(i), own, 3e5) / 37e-6 - 1));
	}
	near(worst, 0, 2e-9, "a sphere of each material has the pulse of its equivalent");
	near(classify_ferrous(of, share, 2, size, phase, se, f), like / (like + 3), 1e-9,
		"the probability of a ferrous particle is that of Bayes");
	near(classify_ferrous(of, share, 2, size, 0, se, f), 1 / (1 + 3 * like), 1e-9,
		"the probability at the phase of ferrous particles is that of Bayes");
	near(classify_ferrous(of, share, 2, size, phase + 4 * M_PI, se, f),
		like / (like + 3), 1e-9, "phases are counted modulo a turn");
	ok(isnan(classify_ferrous(of, share, 2, size, M_PI / 2, 0.1, f)),
		"a phase of no material has no probability");
	ok(isnan(classify_ferrous(of, share, 2, 0, 0, 0.1, f)) &&
			isnan(classify_ferrous(of, share, 2, size, NAN, 0.1, f)) &&
			isnan(classify_ferrous(of, share, 2, size, 0, NAN, f)),
		"what is unknown has no probability");
	share[1] = 0;
	near(classify_ferrous(of, share, 2, size, 0.1, 0.1, f), 1, 0,
		"a material without a share does not count");
	for (double s = 1e-9; s < 2; s *= 10) {
		double p = classify_ferrous(of, share, 2, s, 0, 0.1, 1e6);

		ok(p == 1, "a size of %g m has a class", s);
	}
}

int main(void)
{
	test_golden();
	test_series();
	test_thin_skin();
	test_limits();
	test_materials();
	test_classes();
	return tap_done();
}
