/* surface_filter - Gaussian filters, form, material ratio and spectrum against closed
 * forms */
#include "num/deviates.h"
#include "num/philox.h"
#include "surface/filter.h"
#include "surface/heights.h"
#include "surface/ratio.h"
#include "surface/surface.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

enum { N = 640, CUT = 64 };
static double z[N * 4], out[N * 4];

/* Amplitude that is left of a wave in the middle of a long line. */
static double passed(double wavelength, enum filter_ends ends)
{
	for (int i = 0; i < N; i++)
		z[i] = cos(2 * M_PI * (i - N / 2) / wavelength);
	surface_gauss(N, 1, 1, 1, z, CUT, ends, out);
	return out[N / 2];
}

static void check_transmission(void)
{
	static const double ratio[] = { 0.5, 1, 2, 3 };
	double x = 1.6783469900166605;

	for (int i = 0; i < 4; i++) {
		double w = ratio[i] * CUT, f = 1 / ratio[i];

		near(passed(w, FILTER_MEAN), exp2(-f * f), 1e-9,
			"a filter of order 0 passes 2^-(c/l)^2");
		near(passed(w, FILTER_PARABOLA), (1 + x * f * f) * exp(-x * f * f), 1e-9,
			"a filter of order 2 passes (1 + pi a^2 f^2) exp(-pi a^2 f^2)");
	}
	near(passed(CUT, FILTER_LINE), 0.5, 1e-9,
		"a filter of order 1 equals order 0 away from the rim");
}

/* Four nesting indices, 64 points each: distortion of planes and parabolas at the rim.
 */
static void check_ends(void)
{
	enum { L = 257 };

	for (int i = 0; i < L; i++)
		z[i] = (i - 128) / 64.0;
	surface_gauss(L, 1, 1, 1, z, CUT, FILTER_MEAN, out);
	near(out[L - 1] - z[L - 1], -.14462, 5e-6,
		"the mean distorts a plane at the edge");
	surface_gauss(L, 1, 1, 1, z, CUT, FILTER_LINE, out);
	near(out[L - 1] - z[L - 1], 0, 1e-13, "the line reproduces a plane at the edge");
	for (int i = 0; i < L; i++)
		z[i] = pow((i - 128) / 64.0, 2);
	surface_gauss(L, 1, 1, 1, z, CUT, FILTER_MEAN, out);
	near(z[128] - out[128], -.03512, 5e-6, "mean and line distort a parabola");
	surface_gauss(L, 1, 1, 1, z, CUT, FILTER_PARABOLA, out);
	near(z[128] - out[128], 0, 1e-13, "the parabola is reproduced in the middle");
	near(z[L - 1] - out[L - 1], 0, 1e-12, "the parabola is reproduced at the edge");
}

/* In two directions: a plane stays under order 1, x^2 y^2 under order 2. */
static void check_areal(void)
{
	enum { NX = 40, NY = 30 };
	double worst = 0, sum = 0;

	for (int i = 0; i < NX * NY; i++)
		z[i] = 3 + 0.2 * (i % NX) - 0.1 * (i / NX) + 0.01 * (i % NX) * (i / NX);
	surface_gauss(NX, NY, 1, 2, z, 12, FILTER_LINE, out);
	for (int i = 0; i < NX * NY; i++)
		worst = tap_max(worst, fabs(out[i] - z[i]));
	ok(worst < 1e-11, "order 1 keeps a twisted plane to %.1e", worst);
	for (int i = 0; i < NX * NY; i++)
		z[i] = 1e-4 * pow(i % NX, 2) * pow(i / NX, 2);
	surface_gauss(NX, NY, 1, 2, z, 12, FILTER_PARABOLA, out);
	worst = 0;
	for (int i = 0; i < NX * NY; i++)
		worst = tap_max(worst, fabs(out[i] - z[i]));
	ok(worst < 1e-9, "order 2 keeps x^2 y^2 to %.1e", worst);
	for (int i = 0; i < NX * NY; i++)
		z[i] = i == 17 * NX + 2;
	surface_gauss(NX, NY, 1, 2, z, 1000, FILTER_PERIODIC, out);
	for (int i = 0; i < NX * NY; i++)
		sum += out[i] / (NX * NY);
	near(out[0] * NX * NY, 1, 1e-9,
		"a periodic filter much longer than the surface gives the mean");
	near(sum * NX * NY, 1, 1e-12, "a periodic filter keeps the mean");
	surface_gauss(NX, NY, 1, 2, z, 0.1, FILTER_MEAN, out);
	ok(memcmp(z, out, NX * NY * sizeof *z) == 0,
		"a filter shorter than a pixel changes nothing");
}

static void check_form(void)
{
	enum { NX = 33, NY = 20 };
	double worst = 0, sq, left[NX * NY];

	for (int i = 0; i < NX * NY; i++) {
		double x = 1e-5 * (i % NX), y = 2e-5 * (i / NX);

		z[i] = 1e-6 + 0.3 * x - 0.1 * y + 80 * (x * x + y * y) + 10 * x * y;
	}
	memcpy(out, z, sizeof out);
	surface_form(NX, NY, 1e-5, 2e-5, FORM_POLY2, z);
	for (int i = 0; i < NX * NY; i++)
		worst = tap_max(worst, fabs(z[i]));
	ok(worst < 1e-18, "a quadratic form is removed completely: %.1e m is left",
		worst);
	/* without x y, whose part along the others is that of the plane alone */
	for (int i = 0; i < NX * NY; i++)
		z[i] = out[i] - 10 * 1e-5 * (i % NX) * 2e-5 * (i / NX);
	surface_form(NX, NY, 1e-5, 2e-5, FORM_PARABOLOID, z);
	worst = 0;
	for (int i = 0; i < NX * NY; i++)
		worst = tap_max(worst, fabs(z[i]));
	ok(worst < 1e-18, "a paraboloid of revolution is removed completely: %.1e m",
		worst);
	for (int i = 0; i < NX * NY; i++)
		z[i] = philox_uniform(3, 0, RNG_NOISE, (uint64_t)i);
	memcpy(left, z, sizeof left);
	surface_form(NX, NY, 1e-5, 2e-5, FORM_PLANE, z);
	surface_level(NX, NY, left);
	worst = 0;
	for (int i = 0; i < NX * NY; i++)
		worst = tap_max(worst, fabs(z[i] - left[i]));
	ok(worst < 1e-14, "the plane is that of levelling: %.1e", worst);
	sq = surface_sq(NX, NY, z);
	for (enum form f = FORM_PARABOLOID; f <= FORM_POLY6; f++) {
		double now;

		surface_form(NX, NY, 1e-5, 2e-5, f, z);
		now = surface_sq(NX, NY, z);
		ok(now < sq, "more terms leave less: %.5f", now);
		sq = now;
	}
	surface_form(NX, NY, 1e-5, 2e-5, FORM_POLY6, z);
	near(surface_sq(NX, NY, z) / sq, 1, 1e-13, "a second removal finds no form");
	ok(surface_form(2, 20, 1, 1, FORM_POLY2, z) == NUM_DOMAIN,
		"two columns are too few for a parabola");
}

static void check_core(void)
{
	enum { MANY = 100000 };
	double *h = malloc(MANY * sizeof *h);
	struct core c;

	for (int i = 0; i < MANY; i++)
		h[(i * 7919L) % MANY] = normal_quantile((i + 0.5) / MANY);
	surface_core(MANY, h, &c);
	near(c.sk, 2.5739561080, 1e-5, "Sk over Sq of normal heights is right");
	near(c.smr1, .0990510, 1e-6, "Smr1 of normal heights is right");
	near(c.smr2, 1 - .0990510, 1e-6, "Smr2 of normal heights is right");
	near(c.spk, .9450307, 3e-5, "Spk of normal heights is right");
	near(c.svk, .9450307, 3e-5, "Svk of normal heights is right");
	for (int i = 0; i < MANY; i++)
		h[i] = i * 1e-9;
	surface_core(MANY, h, &c);
	near(c.sk / (1e-9 * MANY), 1, 1e-9, "uniform heights have only a core");
	near(c.spk + c.svk, 0, 1e-12, "uniform heights have no peaks and valleys");
	memset(h, 0, MANY * sizeof *h);
	surface_core(MANY, h, &c);
	ok(c.sk == 0 && c.spk == 0 && c.svk == 0,
		"a flat surface has neither core nor peaks");
	/* half of it at 0, half 1 higher, a step between: the flat part is the core */
	for (int i = 0; i < MANY; i++)
		h[i] = i < MANY / 2;
	surface_core(MANY, h, &c);
	near(c.sk, 0, 1e-12, "a step has no core");
	/* the curve is linear between the middles of its points: half a point more */
	near(c.svk, 2, 3e-5,
		"a valley of half the surface counts as a triangle twice as deep");
	surface_core(4, h, &c);
	ok(isnan(c.sk), "four points have no core");
	free(h);
}

static void check_spectrum(void)
{
	enum { NX = 48, NY = 32 };
	struct ring ring[NX + NY + 2];
	double dx = 1e-6, dy = 2e-6, area = NX * dx * NY * dy, sum = 0, sq;
	int n;

	for (int i = 0; i < NX * NY; i++)
		z[i] = philox_uniform(4, 0, RNG_NOISE, (uint64_t)i);
	sq = surface_sq(NX, NY, z);
	surface_spectrum(NX, NY, dx, dy, z, 0, ring, &n);
	for (int k = 0; k < n; k++)
		sum += ring[k].power * ring[k].waves / area;
	/* all but the waves of ring 0: longer than 2 shorter sides */
	ok(sum <= sq * sq * (1 + 1e-12) && sum > 0.99 * sq * sq,
		"the spectrum adds up to Sq^2: %.4f", sum / (sq * sq));
	for (int i = 0; i < NX * NY; i++)
		z[i] = cos(2 * M_PI * 6 * (i % NX) / NX);
	surface_spectrum(NX, NY, dx, dy, z, 0, ring, &n);
	near(ring[5].power * ring[5].waves / area, 0.5, 1e-12,
		"a wave has half its square in its ring");
	/* 6 periods along the 48 um of the shorter side: ring 6 */
	near(ring[5].frequency * dx * NX, 6, 0.3,
		"the ring of the wave is at its frequency");
	surface_spectrum(NX, NY, dx, dy, z, 1, ring, &n);
	sum = 0;
	for (int k = 0; k < n; k++)
		sum += ring[k].power * ring[k].waves / area;
	near(sum, 0.5, 1e-3, "a window keeps the power");
	/* the jump of a slope at the rim spreads over all waves, less so with a window
	 */
	{
		double sharp, smooth;

		for (int i = 0; i < NX * NY; i++)
			z[i] = i % NX;
		surface_spectrum(NX, NY, dx, dy, z, 0, ring, &n);
		sharp = ring[15].power;
		surface_spectrum(NX, NY, dx, dy, z, 1, ring, &n);
		smooth = ring[15].power;
		ok(smooth < 1e-3 * sharp, "a window suppresses the jump at the rim: %.1e",
			smooth / sharp);
	}
}

int main(void)
{
	check_transmission();
	check_ends();
	check_areal();
	check_form();
	check_core();
	check_spectrum();
	return tap_done();
}
