/* abrasion - particles in a gap against bisection, reference values and drawn numbers */
#include "abrasion/groove.h"
#include "abrasion/population.h"
#include "tap.h"
#include <stdlib.h>

static double capped(double x, double d)
{
	return x < d / 2 ? d * x - x * x : d * d / 4;
}

/* Depth in body 1 by bisection of the balance. */
static double bisected(double d, double gap, double h1, double h2)
{
	double low = 0, high = d - gap;

	for (int k = 0; k < 200; k++) {
		double x = 0.5 * (low + high);

		if (h1 * capped(x, d) < h2 * capped(d - gap - x, d))
			low = x;
		else
			high = x;
	}
	return low;
}

static double uniform(unsigned *state)
{
	*state = *state * 1664525u + 1013904223u;
	return (*state >> 8) / 16777216.0 + 1e-9;
}

static void check_squeeze(void)
{
	double load, worst = 0, shallow;
	unsigned state = 1;

	near(abrasion_squeeze(10e-6, 9e-6, 2e9, 6e9, &load), .76013e-6, 5e-12,
		"the depth of 10 um in a gap of 9 um between 2 and 6 GPa is exact");
	near(load, .0441299, 5e-8, "the load it carries is exact");
	near(abrasion_squeeze(10e-6, 5e-6, 2e9, 6e9, &load), 4.11438e-6, 5e-12,
		"the depth in a gap of 5 um is exact");
	near(load, .152152, 5e-7, "the load in a gap of 5 um is exact");
	for (int i = 0; i < 20000; i++) {
		double h1 = pow(10, 6 + 4 * uniform(&state));
		double h2 = pow(10, 6 + 4 * uniform(&state));
		double gap = i % 2 ? uniform(&state) : pow(uniform(&state), 4);
		double x = abrasion_squeeze(1, gap, h1, h2, &load);
		double want = bisected(1, gap, h1, h2);

		worst = tap_max(
			worst, fabs(x - want) / fmin(want, 1 - gap - want + want));
		worst = tap_max(worst, fabs(load / (M_PI * h1 * capped(want, 1)) - 1));
	}
	/* near the middle of the sphere c is flat, and bisection finds x to 1e-8 only
	 */
	ok(worst < 1e-7,
		"depths and loads of 20000 particles agree with bisection to %.1e",
		worst);
	/* D / d of 1e-9: no digit is lost in the difference */
	abrasion_squeeze(1, 1 - 1e-9, 2, 6, &load);
	shallow = M_PI * (1 - (1 - 1e-9)) * 2 * 6 / (2 + 6);
	near(load / shallow, 1, 1e-8,
		"a shallow particle carries pi d D H1 H2 / (H1 + H2)");
}

static void check_grooves(void)
{
	static const double depth[] = { .01, .1, .5, 1 },
			    want[] = { .06023, .19677, .52134, 1 };

	for (int i = 0; i < 4; i++) {
		double load = M_PI / 2 * (2 * depth[i] - depth[i] * depth[i]);

		near(abrasion_section(2, depth[i]) / load, want[i], 5e-6,
			"section times hardness is the load of the front half");
	}
	near(abrasion_section(2, 1e-3 * (1 - 1e-9)) /
			abrasion_section(2, 1e-3 * (1 + 1e-9)),
		1, 1e-8, "series and closed form agree");
	near(abrasion_largest(0.1, 20e-3, 1e-6), 401.01e-6, 1e-12,
		"a ball of 20 mm admits 401 um with a friction of 0.1");
	/* exact: the faces of ball and flat make the angle 2 atan(mu) at the particle */
	{
		double d = abrasion_largest(0.3, 20e-3, 5e-6);
		double cosine = (20e-3 + 5e-6 - d / 2) / (20e-3 + d / 2);

		near(tan(acos(cosine) / 2), 0.3, 1e-9,
			"the angle at the largest particle is that of friction");
	}
}

static void check_modes(void)
{
	struct abrasion_par par = { .gap = 9e-6,
		.hardness = { 2e9, 6e9 },
		.abrasive = INFINITY,
		.friction = 0.3,
		.inlet = INFINITY };
	struct abrasion a, b;
	/* (k - 1/k) / 2 = 0.3 */
	double limit = 0.3 + sqrt(1.09);

	abrasion_particle(&par, 9e-6, 1, &a);
	ok(a.mode == ABRASION_FREE && a.load == 0,
		"a particle as large as the gap is free");
	abrasion_particle(&par, 10e-6, limit * 0.999, &a);
	ok(a.mode == ABRASION_ROLLS && a.section[0] == 0 && a.section[1] == 0,
		"below an aspect of 1.344 it rolls at a friction of 0.3");
	abrasion_particle(&par, 10e-6, limit * 1.001, &a);
	ok(a.mode == ABRASION_GROOVES && a.section[0] == 0 && a.section[1] > 0,
		"above an aspect of 1.344 it grooves the harder body and is held by the softer one");
	near(a.depth[1] + a.depth[0], 1e-6, 1e-20, "both depths add up to the overlap");
	near(M_PI * 2e9 * capped(a.depth[0], 10e-6) /
			(M_PI / 2 * 6e9 * capped(a.depth[1], 10e-6)),
		1, 1e-12, "the front half carries as much as the whole impression");
	par.hardness[1] = 2e9;
	abrasion_particle(&par, 10e-6, 2, &a);
	near(a.section[0], a.section[1], 0, "bodies of equal hardness share the groove");
	near(a.section[0], a.share[0] * abrasion_section(10e-6, a.groove[0]), 1e-27,
		"the groove of either has its depth over its share of the distance");
	near(capped(a.groove[0], 10e-6) / capped(1e-6 - a.groove[0], 10e-6), 2, 1e-9,
		"a body is grooved to where the front half carries what the other carries");
	par.hardness[1] = 2e9 * (1 + 1e-9);
	abrasion_particle(&par, 10e-6, 2, &b);
	near(b.load / a.load, 1, 1e-8, "the load is continuous near equal hardness");
	near(b.depth[0] + b.depth[1], a.depth[0] + a.depth[1], 1e-20,
		"the sum of the depths is continuous too");
	par.hardness[1] = 6e9;
	par.abrasive = 1.2 * 6e9 * 0.999;
	abrasion_particle(&par, 10e-6, 2, &a);
	ok(a.mode == ABRASION_EMBEDS && a.depth[0] == 10e-6 - par.gap && a.depth[1] == 0,
		"a particle less than 1.2 times as hard as one body is embedded in the other");
	par.abrasive = 2e9;
	abrasion_particle(&par, 10e-6, 2, &a);
	ok(a.mode == ABRASION_YIELDS && isnan(a.load),
		"a particle softer than both bodies is refused");
	par.abrasive = INFINITY;
	par.hardness[0] = par.hardness[1] = 2e9;
	par.gap = 1e-9;
	abrasion_particle(&par, 10e-6, 2, &a);
	ok(a.mode == ABRASION_BURIED && isnan(a.section[0]) && a.load > 0,
		"a groove deeper than its radius is refused");
	par.gap = 9e-6;
	par.inlet = 1e-6;
	par.friction = 0;
	abrasion_particle(&par, 10e-6, 2, &a);
	ok(a.mode == ABRASION_REJECTED, "without friction no larger particle enters");
}

/* The body that is grooved is the one whose groove resists less. */
static void check_slip(void)
{
	unsigned state = 7;
	int asked = 0;
	double most = 0;

	for (int i = 0; i < 20000; i++) {
		double h1 = 1, h2 = pow(10, 2 * uniform(&state)), gap = uniform(&state);
		double x = bisected(1, gap, h1 / 2, h2), y;

		y = 1 - gap - bisected(1, gap, h1, h2 / 2);
		if (x > 0.5 || y > 0.5)
			continue;
		asked++;
		most = tap_max(most,
			h2 * abrasion_section(1, y) / (h1 * abrasion_section(1, x)));
	}
	ok(asked > 5000 && most < 1.02,
		"the groove in the harder body resists less, or 2 %% more: %.4f times",
		most);
}

/* The gap is recovered from the load it carries, with fixed and with changing motion.
 */
static void check_gap(void)
{
	struct abrasion_par par = { .gap = 6e-6,
		.hardness = { 2e9, 5e9 },
		.abrasive = INFINITY,
		.friction = 0.2,
		.inlet = INFINITY };
	double d[500], aspect[500], load = 0, carried, evaluations = 0, gap;
	unsigned state = 5;

	for (int i = 0; i < 500; i++) {
		struct abrasion a;

		d[i] = 4e-6 + 8e-6 * uniform(&state);
		aspect[i] = 1 + 2 * uniform(&state);
		abrasion_particle(&par, d[i], aspect[i], &a);
		load += a.load;
	}
	gap = abrasion_gap(&par, d, aspect, 500, load, &carried, &evaluations);
	near(gap / par.gap, 1, 1e-12,
		"500 particles carry a load at the gap it came from");
	near(carried / load, 1, 1e-9,
		"at this gap 500 particles carry exactly this load");
	ok(evaluations < 500.0 * 60, "particles smaller than the gap are left out: %.0f",
		evaluations);
	gap = abrasion_gap(&par, d, aspect, 500, 1e9, &carried, &evaluations);
	ok(isnan(gap) && carried > 0 && carried < 1e9,
		"a load above what they can carry has no gap");
}

static void check_cut(void)
{
	enum { NX = 64, NY = 48 };
	static double z[NX * NY];
	const double dx = 1e-6, dy = 0.5e-6;
	struct groove g = { .x = 60.3e-6,
		.y = 0.2e-6,
		.length = 150e-6,
		.diameter = 8e-6,
		.depth = 1.5e-6,
		.cut = 1 };
	double sum = 0, low = 0, section = abrasion_section(g.diameter, g.depth);

	groove_cut(NX, NY, dx, dy, z, &g);
	for (int i = 0; i < NX * NY; i++)
		sum += z[i] * dx * dy;
	near(-sum / (section * g.length), 1, 1e-12,
		"a groove across the edge and twice around removes its section times its length");
	for (int i = 0; i < NX * NY; i++)
		low = fmin(low, z[i]);
	/* two laps and a third over a part */
	ok(low < -2.8 * g.depth && low >= -3 * g.depth,
		"repeated passes add up: %.3g depths", -low / g.depth);
	g.cut = 0;
	groove_cut(NX, NY, dx, dy, z, &g);
	for (int i = 0; i < NX * NY; i++)
		sum -= z[i] * dx * dy;
	ok(fabs(sum) < 1e-12 * section * g.length,
		"ploughing moves material and removes none");
	g = (struct groove){ .y = 12e-6,
		.length = NX * dx,
		.diameter = 8e-6,
		.depth = 0.25e-6,
		.cut = 0.3 };
	sum = 0;
	for (int i = 0; i < NX * NY; i++)
		z[i] = 0;
	groove_cut(NX, NY, dx, 1e-6 * 12, z, &g);
	for (int i = 0; i < NX * NY; i++)
		sum += z[i] * dx * 12e-6;
	near(-sum / (0.3 * abrasion_section(8e-6, 0.25e-6) * g.length), 1, 1e-12,
		"a groove much narrower than a cell keeps its volume");
}

static void check_population(void)
{
	struct population p = { { 4e-6, 6e-6, 14e-6 }, { 2.5e9, 6.4e8, 8e7 }, 70e-6 };
	struct abrasion_par par = { .gap = 5e-6,
		.hardness = { 2e9, 6e9 },
		.abrasive = INFINITY,
		.friction = 0.1,
		.inlet = INFINITY,
		.motion = ABRASION_ALL_GROOVE };
	struct population_mean coarse, fine;
	double *list, gap, most, load = 0, section = 0, volume = 100e-6;
	size_t n, above = 0;

	for (double d = 4e-6; d < 69e-6; d *= 1.1)
		if (fabs(population_diameter(&p, population_larger(&p, d)) / d - 1) >
			1e-12)
			above++;
	ok(above == 0,
		"the number above a diameter and the diameter above which there is a number are inverse functions");
	near(population_larger(&p, 4e-6) - population_larger(&p, 6e-6), 2.5e9 - 6.4e8, 1,
		"the numbers of the code are reproduced");
	ok(population_draw(&p, volume, 5e-6, 3, 0, 10000000, &list, &n) == 0,
		"particles are drawn without an error");
	for (size_t i = 0; i < n; i++) {
		struct abrasion a;

		above += list[i] > 14e-6;
		abrasion_particle(&par, list[i], 1, &a);
		load += a.load * 5e-6 / volume;
		section += a.section[1] * 5e-6 / volume;
	}
	/* Poisson: 8000 of them */
	near((double)above / (volume * population_larger(&p, 14e-6)), 1, 4 / sqrt(8000),
		"the mean number drawn is that of the code");
	population_mean(&p, &par, 1000, &coarse);
	population_mean(&p, &par, 16000, &fine);
	near(coarse.pressure / fine.pressure, 1, 1e-5,
		"1000 classes are sufficient for the pressure");
	near(coarse.section[1] / fine.section[1], 1, 1e-5,
		"1000 classes are sufficient for the wear");
	near(load / fine.pressure, 1, 0.05, "drawn particles carry the mean pressure");
	near(section / fine.section[1], 1, 0.05, "drawn particles wear at the mean rate");
	free(list);
	/* Beyond a diameter particles are rejected at the inlet, or buried: a class of
	 * 1000 on both sides of it would be off by up to 3e-3. */
	par.gap = 13e-6;
	par.inlet = (27e-6 / par.gap - 1.01) * par.gap / 0.02;
	population_mean(&p, &par, 1000, &coarse);
	population_mean(&p, &par, 64000, &fine);
	near(coarse.pressure / fine.pressure, 1, 2e-5,
		"1000 classes are sufficient where an inlet rejects particles");
	par.inlet = INFINITY;
	par.gap = 5e-6;
	par.hardness[1] = 2.4e9;
	population_mean(&p, &par, 1000, &coarse);
	population_mean(&p, &par, 64000, &fine);
	near(coarse.section[1] / fine.section[1], 1, 2e-5,
		"1000 classes are sufficient where particles are buried");
	par.hardness[1] = 6e9;
	/* Narrow gaps hold fewer particles: the pressure is largest in between. */
	par.gap = 40e-6;
	population_mean(&p, &par, 16000, &fine);
	gap = population_gap(&p, &par, fine.pressure, 16000, &most);
	near(gap / par.gap, 1, 1e-9, "the gap follows from the pressure");
	gap = population_gap(&p, &par, 1e12, 1000, &most);
	ok(isnan(gap) && most > 0, "a pressure that is too large has no gap");
}

int main(void)
{
	check_squeeze();
	check_grooves();
	check_modes();
	check_slip();
	check_gap();
	check_cut();
	check_population();
	return tap_done();
}
