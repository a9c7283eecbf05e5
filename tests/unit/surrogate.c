/* Surrogate of the debris model, on made-up particles whose errors are known: those of
 * single particles, and one that all particles of a surface share. */
#include "debris/surrogate.h"
#include "num/philox.h"
#include "tap.h"

#include <stdlib.h>
#include <string.h>

enum { FEW = 10, MANY = 1000 };
static const double ERROR = 0.3; /* relative standard error of large particles at most */

static double uniform(uint64_t i)
{
	return philox_uniform(11, 0, RNG_NOISE, i);
}

/* About normal: the sum of twelve. */
static double normal(uint64_t i)
{
	double sum = -6;

	for (uint64_t k = 0; k < 12; k++)
		sum += uniform(12 * i + k);
	return sum;
}

/* count particles of a surface, with deviations of their own and of the surface. */
static void make_surface(
	struct surrogate_sample *s, size_t count, long number, double own, double shared)
{
	uint64_t at = (uint64_t)number << 20;
	double error = shared * normal(at++);

	for (size_t i = 0; i < count; i++) {
		struct footprint *f = &s[i].footprint;

		memset(&s[i], 0, sizeof s[i]);
		s[i].surface = number;
		f->cells = 1 + (size_t)(100 * uniform(at++));
		f->area = (double)f->cells;
		f->volume = f->area * (0.5 + uniform(at++));
		f->error = f->cells > 20 ? ERROR * uniform(at++) * f->volume : 0;
		s[i].volume = f->volume *
			      exp(error + hypot(own, f->error / f->volume) * normal(at));
		at++;
	}
}

/* Share of surfaces of many particles whose volume lies within its 90 % interval. */
static double coverage(const struct surrogate *s, double own, double shared)
{
	struct surrogate_sample *sample = malloc(MANY * sizeof *sample);
	struct footprint *list = malloc(MANY * sizeof *list);
	struct surrogate_guess *guess = malloc(MANY * sizeof *guess), total;
	const struct surrogate_contact contact = { { 0 } };
	double held = 0, tried = 0;

	for (long k = 0; k < 200; k++) {
		double volume = 0;

		make_surface(sample, MANY, 10000 + k, own, shared);
		for (size_t i = 0; i < MANY; i++) {
			list[i] = sample[i].footprint;
			volume += sample[i].volume;
		}
		if (!surrogate_guess(s, list, MANY, &contact, 0.9, guess, &total))
			continue;
		tried++;
		held += total.low <= volume && volume <= total.high;
	}
	free(sample);
	free(list);
	free(guess);
	return held / tried;
}

static void test_errors(double own, double shared)
{
	enum { SURFACES = 500 };
	struct surrogate_sample *sample = malloc((size_t)SURFACES * FEW * sizeof *sample);
	struct surrogate_report report;
	struct surrogate s;
	double held;

	for (long k = 0; k < SURFACES; k++)
		make_surface(sample + k * FEW, FEW, k, own, shared);
	ok(surrogate_fit(sample, (size_t)SURFACES * FEW, &s, &report) == SURROGATE_OK,
		"a surrogate is fitted to %d surfaces of %d particles", SURFACES, FEW);
	/* Somewhat less: the deviation of single particles includes a part of it. */
	ok(s.shared > 0.75 * shared && s.shared < 1.1 * shared,
		"a deviation of %.2g that a surface has in common is found: %.2g", shared,
		s.shared);
	held = coverage(&s, own, shared);
	ok(held > 0.84 && held < 0.96,
		"errors of %g and %g in common: intervals of 90 %% hold %.0f %% of the totals of surfaces of %d particles",
		own, shared, 100 * held, MANY);
	free(sample);
}

/* Pressures that rise linearly by (x, y) a cell from 1 on. */
static void test_contact(int axis, double x, double y, double lay, double oblique)
{
	enum { NX = 7, NY = 5 };
	struct stress_par par = { .nx = NX, .ny = NY, .dx = 2, .dy = 3, .axis = axis };
	double p[NX * NY];
	struct surrogate_contact c;

	for (int i = 0; i < NX * NY; i++)
		p[i] = 1 + par.dx * x * (i % NX) + par.dy * y * (i / NX);
	p[0] = 0;
	c = surrogate_contact(&par, p, 1e-3);
	ok(c.property[SURROGATE_FLOW] == 1, "all loaded cells are at the hardness");
	p[0] = 1;
	c = surrogate_contact(&par, p, 0);
	ok(c.property[SURROGATE_FLOW] == 0, "without a hardness none is");
	ok(fabs(c.property[SURROGATE_LAY] - lay) < 1e-12 &&
			fabs(c.property[SURROGATE_OBLIQUE] - oblique) < 1e-12,
		"a slope of %g, %g has the lay %g (%g), at 45 degrees %g (%g), where sliding is along %c",
		x, y, lay, c.property[SURROGATE_LAY], oblique,
		c.property[SURROGATE_OBLIQUE], "xy"[axis]);
}

int main(void)
{
	test_contact(0, 1, 0, 1, 0);
	test_contact(1, 1, 0, -1, 0);
	test_contact(0, 0, 2, -1, 0);
	test_contact(0, 1, -1, 0, 1);
	test_contact(1, 1, 2, 0.6, 0.8);
	test_errors(0.2, 0.1);
	test_errors(0.3, 0.2);
	return tap_done();
}
