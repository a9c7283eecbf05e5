/* Surrogate of the debris model, on made-up particles whose errors are known: those of
 * cells left out, and one that all particles of a surface share. */
#include "debris/surrogate.h"
#include "debris/debris.h"
#include "num/philox.h"
#include "tap.h"

#include <math.h>
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

/* count particles of a surface, whose stresses have a deviation of 1 to 10 times sums. */
static void make_surface(
	struct surrogate_sample *s, size_t count, long number, double sums)
{
	uint64_t at = (uint64_t)number << 20;
	double deviation = sums * (1 + 9 * uniform(at++)),
	       error = deviation * normal(at++);

	for (size_t i = 0; i < count; i++) {
		struct footprint *f = &s[i].footprint;

		memset(&s[i], 0, sizeof s[i]);
		s[i].surface = number;
		f->cells = 1 + (size_t)(100 * uniform(at++));
		f->area = (double)f->cells;
		f->volume = f->area * (0.5 + uniform(at++));
		f->error = f->cells > 20 ? ERROR * uniform(at++) * f->volume : 0;
		f->change = f->volume * (1 + uniform(at++));
		f->sums = f->change * deviation;
		f->freedom = 1000;
		s[i].volume = f->volume + f->error * normal(at++) + f->change * error;
	}
}

/* Share of surfaces of many particles whose volume lies within its 90 % interval. */
static double coverage(const struct surrogate *s, double sums)
{
	struct surrogate_sample *sample = malloc(MANY * sizeof *sample);
	struct footprint *list = malloc(MANY * sizeof *list);
	struct surrogate_guess *guess = malloc(MANY * sizeof *guess), total;
	double held = 0, tried = 0;

	for (long k = 0; k < 200; k++) {
		double volume = 0;

		make_surface(sample, MANY, 10000 + k, sums);
		for (size_t i = 0; i < MANY; i++) {
			list[i] = sample[i].footprint;
			volume += sample[i].volume;
		}
		if (!surrogate_guess(s, list, MANY, &sample->contact, 0.9, guess, &total))
			continue;
		tried++;
		held += total.low <= volume && volume <= total.high;
	}
	free(sample);
	free(list);
	free(guess);
	return held / tried;
}

static void test_errors(double sums)
{
	enum { SURFACES = 500 };
	struct surrogate_sample *sample = malloc((size_t)SURFACES * FEW * sizeof *sample);
	struct surrogate_report report;
	struct surrogate s;
	double held;

	for (long k = 0; k < SURFACES; k++)
		make_surface(sample + k * FEW, FEW, k, sums);
	ok(surrogate_fit(sample, (size_t)SURFACES * FEW, &s, &report) == SURROGATE_OK,
		"a surrogate is fitted to %d surfaces of %d particles", SURFACES, FEW);
	held = coverage(&s, sums);
	ok(held > 0.84 && held < 0.96,
		"errors of %g in common: intervals of 90 %% hold %.0f %% of the totals of surfaces of %d particles",
		sums, 100 * held, MANY);
	free(sample);
}

/* A surface of one particle of which every cell was measured. */
static void make_measured(struct surrogate_sample *s, long number)
{
	uint64_t at = (uint64_t)number << 20;
	double deviation = 0.01 * (1 + 9 * uniform(at));

	memset(s, 0, sizeof *s);
	s->surface = number;
	s->footprint = (struct footprint){
		.cells = 1, .area = 1, .volume = 1, .change = 1, .sums = deviation
	};
	s->volume = 1 + deviation * normal(at + 1);
}

/* The intervals of one fit to few surfaces are too narrow or too wide by chance; those of
 * many fits hold 1 - k / (n + 1) of further surfaces on average, where n scores are given
 * and the k-th largest, k = floor(0.1 (n + 1)), is taken. */
static void test_mean_coverage(void)
{
	enum { FITS = 1000, SURFACES = 100, TRIED = 20 };
	struct surrogate_sample sample[SURFACES], other;
	struct surrogate_report report;
	struct surrogate s;
	double held = 0, tried = 0, n = SURFACES * 4 / 5, expected;
	long number = 0;

	for (int fit = 0; fit < FITS; fit++) {
		struct surrogate_guess guess, total;

		for (int i = 0; i < SURFACES; i++)
			make_measured(&sample[i], number++);
		surrogate_fit(sample, SURFACES, &s, &report);
		for (int i = 0; i < TRIED; i++, tried++) {
			make_measured(&other, number++);
			surrogate_guess(&s, &other.footprint, 1, &other.contact, 0.9,
				&guess, &total);
			held += total.low <= other.volume && other.volume <= total.high;
		}
	}
	held /= tried;
	expected = 1 - floor(0.1 * (n + 1)) / (n + 1);
	/* 20000 draws of 0.9 and 1000 fits that vary by 0.033: three standard errors, of
	 * 0.0024; the next score holds 0.012 more or less. */
	ok(fabs(held - expected) < 0.0071,
		"intervals by %.0f scores hold %.4f of further surfaces on average, %.4f expected",
		n, held, expected);
}

/* Scores 1 to 9: the k-th largest bounds 1 - k / 10 of further errors. */
static void test_levels(void)
{
	const struct footprint one = { .volume = 1, .sums = 1 },
			       sampled = { .volume = 1, .error = 1, .freedom = 1e9 };
	const struct surrogate_contact contact = { { 0 } };
	struct surrogate_guess guess, total;
	struct surrogate s = { .particle[SURROGATE_MEASURED] = { .count = 9 },
		.total[SURROGATE_MEASURED] = { .count = 9 } };

	for (int i = 0; i < 9; i++)
		s.particle[SURROGATE_MEASURED].score[i] =
			s.total[SURROGATE_MEASURED].score[i] = i + 1;
	ok(fabs(surrogate_highest_level(&s) - 0.9) < 1e-12,
		"nine scores give intervals of 90 %% at most");
	for (int k = 1; k <= 9; k++) {
		int known = surrogate_guess(
			&s, &one, 1, &contact, 1 - 0.1 * k, &guess, &total);

		ok(known && fabs(log(total.high) - (10 - k)) < 1e-12 &&
				fabs(log(total.low) + (10 - k)) < 1e-12 &&
				guess.high == total.high,
			"the interval of level %.1f reaches to score %d on either side",
			1 - 0.1 * k, 10 - k);
	}
	ok(!surrogate_guess(&s, &one, 1, &contact, 0.91, &guess, &total),
		"there is none of level 0.91");
	s.particle[SURROGATE_MEASURED].score[8] = 1;
	ok(surrogate_guess(&s, &sampled, 1, &contact, 0.9, &guess, &total) &&
			fabs(log(guess.high) - 1.6449) < 1e-4 &&
			fabs(log(total.high) - 9) < 1e-4,
		"errors by cells left out, unknown to the fit, are no less than normal ones or others");
}

/* Half the width of the interval, of ln, of the total of regions like one. */
static double half_width(const struct footprint *one, size_t count)
{
	enum { MOST = 1000 };
	const struct surrogate_contact contact = { { 0 } };
	const struct surrogate_scores one_at_most = { 9, { [8] = 1 } };
	const struct surrogate s = { .particle = { one_at_most, one_at_most },
		.total = { one_at_most, one_at_most } };
	struct footprint list[MOST];
	struct surrogate_guess guess[MOST], total;

	for (size_t i = 0; i < count; i++)
		list[i] = *one;
	surrogate_guess(&s, list, count, &contact, 0.9, guess, &total);
	return log(total.high / total.volume);
}

/* Student's over normal quantiles of 90 %, from tables; the series is 2 % off at most. */
static void test_freedom(void)
{
	static const double freedom[] = { 3, 5, 20 },
			    quantile[] = { 2.353, 2.015, 1.725 };
	struct footprint one = { .volume = 1, .error = 0.01 };

	for (int i = 0; i < 3; i++) {
		double want = quantile[i] / 1.645;

		one.freedom = freedom[i];
		ok(fabs(half_width(&one, 1) / (0.01 * want) - 1) < 0.02,
			"an error of %g degrees of freedom has an interval %.2f times as wide: %.2f",
			freedom[i], want, half_width(&one, 1) / 0.01);
	}
	one.freedom = 3;
	ok(fabs(half_width(&one, 1000) / (0.01 / sqrt(1000)) - 1) < 1e-3,
		"that of a thousand regions is as wide as for a normal distribution");
}

/* Of a pressure that the stress is loaded with. */
static struct surrogate_contact contact_of(
	const struct stress_par *par, const double *pressure, double hardness)
{
	struct stress *stress = stress_new(par);
	struct surrogate_contact c;

	ok(stress && stress_load(stress, pressure) == NUM_OK, "the stress is loaded");
	c = surrogate_contact(par, stress, pressure, hardness);
	stress_free(stress);
	return c;
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
	c = contact_of(&par, p, 1e-3);
	ok(c.property[SURROGATE_FLOW] == 1, "all loaded cells are at the hardness");
	p[0] = 1;
	c = contact_of(&par, p, 0);
	ok(c.property[SURROGATE_FLOW] == 0, "without a hardness none is");
	ok(fabs(c.property[SURROGATE_LAY] - lay) < 1e-12 &&
			fabs(c.property[SURROGATE_OBLIQUE] - oblique) < 1e-12,
		"a slope of %g, %g has the lay %g (%g), at 45 degrees %g (%g), where sliding is along %c",
		x, y, lay, c.property[SURROGATE_LAY], oblique,
		c.property[SURROGATE_OBLIQUE], "xy"[axis]);
}

/* Below a ball, whose largest pressure is 1. */
static struct footprint ball(double yield)
{
	enum { N = 21 };
	const struct stress_par par = {
		.nx = N, .ny = N, .dx = 3. / N, .dy = 3. / N, .nu = 0.3, .mu = 0.2
	};
	struct stress *stress = stress_new(&par);
	struct footprints *f = footprints_new(&par);
	const struct footprint *list;
	struct footprint largest = { 0 };
	double p[N * N];
	size_t count;

	for (int i = 0; i < N * N; i++) {
		double x = (i % N + 0.5) * par.dx - 1.5;
		double y = ((double)(i / N) + 0.5) * par.dy - 1.5;
		p[i] = sqrt(fmax(0, 1 - x * x - y * y));
	}
	if (!stress_load(stress, p) &&
		!footprints_find(f, stress, p, yield, &list, &count) && count > 0)
		largest = list[0];
	footprints_free(f);
	stress_free(stress);
	return largest;
}

/* A stress that is larger by a part acts like a yield stress that is smaller by it. */
static void test_change(double yield)
{
	const double part = 1e-3;
	struct footprint less = ball(yield * (1 + part)), more = ball(yield * (1 - part));
	double change = (more.volume - less.volume) / (2 * part);

	ok(less.cells > 50 && less.cells == more.cells && less.error == 0,
		"near a yield stress of %g the same %zu cells fail, all measured", yield,
		less.cells);
	/* To first order, on the parabola through three depths: some per cent. */
	near(ball(yield).change / change, 1, 0.05,
		"the volume changes with the stress as it states");
}

enum { SIDE = 96, CELLS = SIDE * SIDE };

/* So many asperities of different heights. */
static void press_asperities(double *p, uint64_t seed, uint64_t count)
{
	memset(p, 0, CELLS * sizeof *p);
	for (uint64_t k = seed << 20; k < (seed << 20) + 4 * count; k += 4) {
		double u = SIDE * uniform(k), v = SIDE * uniform(k + 1),
		       r = 0.5 + 2 * uniform(k + 2);

		for (int i = 0; i < CELLS; i++) {
			double x = i % SIDE - u, y = (double)(i / SIDE) - v,
			       d = (x * x + y * y) / (r * r);
			p[i] += d < 1 ? (0.5 + uniform(k + 3)) * sqrt(1 - d) : 0;
		}
	}
}

/* Counts the particles of which every cell was measured, or those of eight cells or more
 * of which some were left out, and those of them whose volumes are off by less than 1.645
 * of the stated errors. */
static void count_errors(const double *p, int left_out, int *all, int *within)
{
	const struct debris_par par = { .yield = 0.5,
		.stress = { .nx = SIDE,
			.ny = SIDE,
			.dx = 1,
			.dy = 1,
			.nu = 0.3,
			.mu = 0.3 } };
	struct debris *d = debris_new(&par);
	struct footprints *f = footprints_new(&par.stress);
	double *height = calloc(CELLS, sizeof *height);
	const struct footprint *list;
	struct debris_step step;
	size_t count;

	if (!debris_step(d, height, p, &step) &&
		!footprints_find(f, debris_stress(d), p, par.yield, &list, &count))
		for (size_t i = 0; i < count * step.count; i++) {
			const struct footprint *one = &list[i / step.count];
			const struct particle *q = &step.particle[i % step.count];

			if (left_out != (one->error > 0) ||
				(left_out && one->cells < 8) ||
				(size_t)(q->first[1] * SIDE + q->first[0]) != one->first)
				continue;
			++*all;
			*within +=
				fabs(q->volume - one->volume) <
				1.645 * hypot(hypot(one->error, one->jumps), one->sums);
		}
	footprints_free(f);
	debris_free(d);
	free(height);
}

/* Of so many surfaces with so many asperities each: 90 % of the particles lie within
 * their 90 % intervals; errors are about normal, but those of larger particles average
 * out. */
static void test_within(uint64_t surfaces, uint64_t asperities, int left_out, int least,
	const char *which)
{
	double *p = malloc(CELLS * sizeof *p);
	int all = 0, within = 0;

	for (uint64_t k = 1; k <= surfaces; k++) {
		press_asperities(p, k, asperities);
		count_errors(p, left_out, &all, &within);
	}
	ok(all > least && within > 0.86 * all && within < 0.98 * all,
		"of %d particles %s 90 %% are off by less than 1.645 standard errors: %d",
		all, which, within);
	free(p);
}

/* Single loads far from each other and on the edges, among cells without any. */
static void test_scattered(int nx)
{
	enum { NY = 23, MOST = 64 };
	static double p[MOST * NY];
	struct stress_par par = { .nx = nx, .ny = NY, .dx = 1, .dy = 2 };
	double xx = 0, xy = 0, yy = 0, worst;
	struct surrogate_contact c;

	memset(p, 0, sizeof p);
	for (int k = 0; k < 7; k++)
		p[(k * k * 97 + k * 31) % (nx * NY)] = 1 + k;
	p[nx * NY - 1] = 3;
	for (int y = 0; y + 1 < NY; y++)
		for (int x = 0; x + 1 < nx; x++) {
			const double *a = p + y * nx + x, *b = a + nx;
			double gx = (a[1] + b[1]) - (a[0] + b[0]);
			double gy = ((b[0] + b[1]) - (a[0] + a[1])) / 2;

			xx += gx * gx;
			xy += gx * gy;
			yy += gy * gy;
		}
	c = contact_of(&par, p, 0);
	worst = fmax(fabs(c.property[SURROGATE_LAY] - (xx - yy) / (xx + yy)),
		fabs(c.property[SURROGATE_OBLIQUE] - 2 * fabs(xy) / (xx + yy)));
	ok(worst < 1e-14, "gradients of scattered loads, rows of %d cells, to %.0e", nx,
		worst);
}

int main(void)
{
	test_scattered(63);
	test_scattered(64);
	test_change(0.29);
	test_change(0.35);
	test_change(0.38);
	test_mean_coverage();
	test_levels();
	test_contact(0, 1, 0, 1, 0);
	test_contact(1, 1, 0, -1, 0);
	test_contact(0, 0, 2, -1, 0);
	test_contact(0, 1, -1, 0, 1);
	test_contact(1, 1, 2, 0.6, 0.8);
	test_errors(0.01);
	test_errors(0.002);
	test_freedom();
	test_within(10, 300, 0, 100, "of which every cell was measured");
	/* Two cells of three are measured: single ones are left out among others. */
	test_within(40, 110, 1, 300, "with cells left out");
	return tap_done();
}
