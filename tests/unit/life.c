/* Order selection, noise, run-in, grey series, damage models and fleet comparison. */
#include "life/grey/grey.h"
#include "life/grey/noise.h"
#include "life/particle/adaptive.h"
#include "life/prior/fleet.h"
#include "life/trend/bank_state.h"
#include "life/trend/passage.h"
#include "num/select.h"
#include "tap.h"
#include <stdlib.h>

static void test_noise(void)
{
	struct draw *d = draw_new(1, 0, RNG_NOISE);
	struct noise n = { 0 };
	double t = 0;

	/* A quadratic with noise 0.1 at gaps of 0.5 to 1.5; the median of 256 absolute
	 * residuals has a standard error of 7 %, one in fifty is an outlier,
	 * which spoils three residuals and raises the median by 7 %. */
	for (int k = 0; k < 1000; k++) {
		double gap = 0.5 + draw_uniform(d);
		double y = 1e-4 * t * t + 0.1 * draw_normal(d) + (k % 50 == 9 ? 5 : 0);

		noise_add(&n, y, gap);
		t += gap;
	}
	near(n.scale, 0.107, 0.02,
		"second differences give the noise in spite of outliers");
	n = (struct noise){ 0 };
	for (int k = 0; k < 10; k++)
		noise_add(&n, 3 + 2.0 * k, 1);
	near(n.scale, 0, 1e-12, "a straight line has no noise");
	draw_free(d);
}

/* The forward sums of a series are those of all its points taken backward. */
static void test_grey_series(void)
{
	struct grey_series s = { 0 };
	struct grey back = { 0 }, g;
	double t[1000], x[1000];

	for (int k = 0; k < 1000; k++) {
		t[k] = 1e6 + k + 0.3 * sin(k * k);
		x[k] = exp(1e-3 * k) + 0.1 * sin(3.0 * k * k);
		grey_append(&s, x[k], k > 0 ? t[k] - t[k - 1] : 0);
	}
	for (int k = 999; k >= 0; k--)
		grey_add(&back, x[k], k < 999 ? t[k + 1] - t[k] : 0);
	g = grey_of(&s);
	near(grey_rate(&g) / s.unit, grey_rate(&back), 1e-14,
		"a series grown forward has the rate");
	near(s.scale * grey_forecast(&g, 1 / s.unit, 1 / s.unit),
		grey_forecast(&back, 1, 1), 1e-11, "and forecast");
	near(s.scale * s.scale * grey_residual(&g), grey_residual(&back), 1e-13,
		"and residual");
	ok(g.n == 1000 && fabs(s.unit * g.span - (t[999] - t[0])) < 1e-8, "and length");
}

/* An alternating series is best forecast by many points; fixed orders stay; window
 * errors are those of the grey model itself. */
static void test_orders(void)
{
	struct order_par par = { ORDER_WINDOW, 30 };
	struct order *o = order_new(&par);
	struct draw *d = draw_new(4, 0, RNG_NOISE);
	struct grey g = { 0 };
	double y[200];

	for (int k = 0; k < 200; k++) {
		y[k] = 2 + 0.001 * k + 0.1 * draw_normal(d);
		order_add(o, y[k], 1);
	}
	for (int k = 200; k-- > 200 - order_chosen(o);)
		grey_add(&g, y[k], 1);
	near(order_forecast(o, 1), grey_forecast(&g, 1, 1), 1e-13,
		"the forecast is that of the chosen order");
	ok(order_chosen(o) > 10, "white noise leads to a high order: %d",
		order_chosen(o));
	order_free(o);
	draw_free(d);
}

enum { DRAWS = 2000 };

static double median(double *v, int n)
{
	for (int i = 1; i < n; i++)
		for (int k = i; k > 0 && v[k] < v[k - 1]; k--) {
			double x = v[k];

			v[k] = v[k - 1];
			v[k - 1] = x;
		}
	return v[n / 2];
}

/* Straight wear with white noise: the interval of the line is that of least squares,
 * here the standard error of the passage by the delta method. */
static void test_straight_wear(void)
{
	struct draw *d = draw_new(2, 0, RNG_NOISE);
	struct bank_chances *chances = bank_chances_new(DRAWS, 1);
	struct bank_par par = {
		.threshold = 1, .direction = 1, .families = BANK_LINEAR, .steady = 1
	};
	double *life = malloc(DRAWS * sizeof *life);
	double noise = 0.01, sum = 0, squares = 0, inside = 0;
	int runs = 60;

	for (int r = 0; r < runs; r++) {
		struct bank *b = bank_new(&par);
		double mid, low, high;

		for (int k = 0; k < 60; k++)
			bank_add(b, k, (k + 0.0) / 100 + noise * draw_normal(d));
		bank_draw(b, chances, 59, 1, life);
		mid = median(life, DRAWS);
		low = life[DRAWS / 20];
		high = life[DRAWS - DRAWS / 20];
		sum += mid - 41;
		squares += (mid - 41) * (mid - 41);
		inside += low <= 41 && 41 <= high;
		bank_free(b);
	}
	near(sum / runs, 0, 0.6, "lives of straight lines are unbiased");
	/* Least squares: sd of the passage at 100 from 60 rows, sigma / slope times
	 * sqrt(1 / n + (100 - 29.5)^2 / Sxx) = 0.54; shorter memories and Wiener noise in
	 * the bank may cost a factor of two. */
	ok(sqrt(squares / runs) < 1.1, "the error is %.2f of the lives",
		sqrt(squares / runs));
	ok(inside / runs > 0.85 && inside / runs < 0.99,
		"the 90 %% interval contains %.0f %% of the lives", 100 * inside / runs);
	free(life);
	bank_chances_free(chances);
	draw_free(d);
}

/* A quantile of the life of a straight series of n rows, y = t / 100 with noise, as
 * changed by f. */
static double life_of(
	int n, double (*f)(int k, double y), double gap, int at, double level)
{
	struct draw *d = draw_new(3, 0, RNG_NOISE);
	struct bank_chances *chances = bank_chances_new(DRAWS, 1);
	struct bank_par par = { .threshold = 1, .direction = 1 };
	struct bank *b = bank_new(&par);
	double life[DRAWS], t = 0;

	for (int k = 0; k < n; k++) {
		t = k + (k >= at ? gap : 0);
		bank_add(b, t, f(k, k / 100.0 + 0.01 * draw_normal(d)));
	}
	bank_draw(b, chances, t, 1, life);
	bank_free(b);
	bank_chances_free(chances);
	draw_free(d);
	sort_numbers(life, DRAWS);
	return sorted_quantile(life, DRAWS, level);
}

static double median_life(int n, double (*f)(int k, double y), double gap, int at)
{
	return life_of(n, f, gap, at, 0.5);
}

static double as_it_is(int k, double y)
{
	(void)k;
	return y;
}

static double burst(int k, double y)
{
	return k >= 50 && k < 56 ? y + 0.2 : y;
}

static double early_outlier(int k, double y)
{
	return k == 3 ? 1e6 : k == 5 ? 10 : y;
}

static double first_outlier(int k, double y)
{
	return k == 1 ? -50 : y;
}

static double rounded(int k, double y)
{
	(void)y;
	return floor(k / 25.0) / 6;
}

static double rounded_down(int k, double y)
{
	return k < 50 ? rounded(k, y) : rounded(k, y) - 1.0 / 6;
}

static double overhaul(int k, double y)
{
	return k >= 40 ? y - 0.3 : y;
}

static double repair(int k, double y)
{
	return k >= 50 ? y - 0.4 : y;
}

static double low_burst(int k, double y)
{
	return k >= 50 && k < 55 ? y - 0.4 : y;
}

/* Set back by 0.2 and, one row later, by as much again. */
static double two_repairs(int k, double y)
{
	return y - (k >= 50 ? 0.2 : 0) - (k >= 51 ? 0.2 : 0);
}

/* The same under a twentieth of the noise: each step of the rate is well beyond it. */
static double cleaned(int k, double y)
{
	return y - 0.3 * floor(k / 30.0);
}

static double quiet_repair(int k, double y)
{
	return repair(k, k / 100.0 + (y - k / 100.0) / 20);
}

/* Wear that becomes thirty times as fast at row 60, under the same noise. */
static double accelerated(int k, double y)
{
	return k * 1e-3 + fmax(0, k - 60) * 0.029 + (y - k / 100.0) / 20;
}

static double constant(int k, double y)
{
	(void)k;
	(void)y;
	return 0;
}

static double rounded_noise(int k, double y)
{
	return round(36 * (y - k / 100.0)) / 30;
}

/* Wear in few rows that becomes twenty times as fast: two readings beyond any noise must
 * count for something, also where few rows have determined the noise. */
static void test_few_rows(void)
{
	static const double y[] = { 0, 0.011, 0.032, 0.052, 0.066, 0.074, 0.098, 0.106,
		0.12, 0.142, 0.187, 0.53, 0.87 };
	enum { ROWS = sizeof y / sizeof *y };
	struct bank_chances *chances = bank_chances_new(DRAWS, 1);
	struct bank_par par = { .threshold = 1, .direction = 1 };
	struct bank *b = bank_new(&par);
	double life[DRAWS];

	for (int k = 0; k < ROWS; k++)
		bank_add(b, k, y[k]);
	bank_draw(b, chances, ROWS - 1, 1, life);
	sort_numbers(life, DRAWS);
	ok(sorted_quantile(life, DRAWS, 0.05) < 1,
		"two rows of steep wear after eleven others may go on to the end");
	/* creep in three stages whose end, at 14, is one row away */
	bank_free(b);
	b = bank_new(&par);
	for (int k = 0; k < 14; k++)
		bank_add(b, k,
			0.25 * cbrt(k / 14.0) + 0.25 * k / 14 +
				0.5 * expm1(k * 10 / 14.0) / expm1(10));
	bank_draw(b, chances, 13, 1, life);
	sort_numbers(life, DRAWS);
	ok(sorted_quantile(life, DRAWS, 0.05) < 1,
		"a third stage of creep is seen in fourteen rows");
	bank_free(b);
	bank_chances_free(chances);
}

/* By the law of future changes a twentieth of such units fails within a quarter of their
 * age or so; what readings do not say must not make it more. */
static void test_no_wear(void)
{
	for (int n = 70; n <= 280; n *= 2) {
		ok(life_of(n, constant, 0, 0, 0.05) > 0.25 * n,
			"%d equal readings are no wear", n);
		ok(life_of(n, rounded_noise, 0, 0, 0.05) > 0.15 * n,
			"nor is noise rounded to a few levels");
	}
}

/* Whether a reading is rounded to the nearest level or down, it stays wrong by the same
 * share of a level: no number of rows makes the time of the passage more certain. */
static void test_readings_rounded_down(void)
{
	enum { LEVELS = 16 };
	struct draw *d = draw_new(3, 0, RNG_NOISE);
	struct bank_chances *chances = bank_chances_new(DRAWS, 1);
	struct bank_par par = { .threshold = 1, .direction = 1 };
	double life[DRAWS];
	int late = 0, early = 0, rows = 0;

	for (int n = 100; n <= 200; n += 50) {
		struct bank *b = bank_new(&par);

		for (int k = 0; k < n; k++) {
			double y = LEVELS * (double)k / n + 0.1 * draw_normal(d);

			bank_add(b, k, floor(y) / LEVELS);
			if (k < 0.88 * n)
				continue;
			bank_draw(b, chances, k, 1, life);
			sort_numbers(life, DRAWS);
			late += sorted_quantile(life, DRAWS, 0.05) > n - k;
			early += sorted_quantile(life, DRAWS, 0.95) < n - k;
			rows++;
		}
		bank_free(b);
	}
	ok(late <= 0.1 * rows && early <= 0.1 * rows,
		"readings that are rounded down end within the interval");
	bank_chances_free(chances);
	draw_free(d);
}

/* Largest difference between the lives on two clocks, relative, over n rows. */
static double difference_of_clocks(int n, double origin, double unit)
{
	struct draw *d = draw_new(3, 0, RNG_NOISE);
	struct bank_chances *chances = bank_chances_new(DRAWS, 1);
	struct bank_par par = { .threshold = 1, .direction = 1 };
	struct bank *here = bank_new(&par), *there = bank_new(&par);
	double a[DRAWS], b[DRAWS], most = 0;

	for (int k = 0; k < n; k++) {
		double y = (double)k / n + 0.01 * draw_normal(d);

		bank_add(here, k, y);
		bank_add(there, origin + unit * k, y);
		if (!bank_ready(here))
			continue;
		bank_draw(here, chances, k, 1, a);
		bank_draw(there, chances, origin + unit * k, 1, b);
		for (int i = 0; i < DRAWS; i++)
			if (a[i] * unit != b[i])
				most = fmax(most, fabs(a[i] * unit / b[i] - 1));
	}
	bank_free(here);
	bank_free(there);
	bank_chances_free(chances);
	draw_free(d);
	return most;
}

static void test_clock(void)
{
	double most = difference_of_clocks(140, 1000, 1.1);

	ok(most > 0 && most < 1e-6,
		"the clock's unit and origin change no life by more than rounding");
}

static void test_disturbances(void)
{
	double plain = median_life(60, as_it_is, 0, 0);

	near(plain, 41, 4, "a straight series has the life of its line");
	near(median_life(60, burst, 0, 0), plain, 1,
		"six outliers in a row do not change the life");
	near(median_life(60, early_outlier, 0, 0), plain, 1,
		"outliers in rows 4 and 6 do not change the life");
	near(median_life(60, first_outlier, 0, 0), plain, 1,
		"an outlier in row 2 does not change the life");
	/* a step of 1/6 in 25 rows: 150 rows in all */
	near(median_life(101, rounded, 0, 0), 50, 25,
		"readings in steps of a sixth are wear, not a standstill and shifts");
	ok(median_life(70, rounded_down, 0, 0) > 80,
		"readings in steps that fall back are no wear");
	near(median_life(60, as_it_is, 80, 58), plain, 1,
		"a halt of 0.8 lives does not change the life");
	near(median_life(30, as_it_is, 500, 9), median_life(30, as_it_is, 0, 0), 15,
		"nor does a halt of five lives after nine rows");
	/* at 0.4 of the way back to 0.1 in a halt of three lives: 89 rows are left */
	ok(median_life(41, overhaul, 300, 40) > 40,
		"the first row after an overhaul in a halt is no failure");
	near(median_life(60, overhaul, 300, 40), 71, 10,
		"an overhaul in a halt lengthens the life by what it sets back");
	/* Of the draws an eighth for each row held back takes these for a jump, here by
	 * 0.2 with 24 rows left. */
	near(median_life(51, burst, 0, 0), plain + 9, 2,
		"an outlier at the very end hardly changes the life");
	near(median_life(56, burst, 0, 0), 24, 4, "six in a row may be a jump");
	/* back by 0.4 at row 50: at the rate of 0.01 a row 40 rows more are left; the
	 * regime may change in them, hence less */
	ok(median_life(60, repair, 0, 0) > plain + 15 &&
			median_life(60, repair, 0, 0) < 85,
		"a repair that sets the wear back by 0.4 lengthens the life");
	near(median_life(57, low_burst, 0, 0), plain + 3, 4,
		"five rows that lie low are no repair once they have ended");
	near(median_life(70, two_repairs, 0, 0), median_life(70, repair, 0, 0), 4,
		"two repairs in two rows are as good as one");
	/* 0.33 at row 69, nine rows after the turn: 22 of 0.03 are left */
	near(median_life(70, accelerated, 0, 0), 22, 3,
		"a new rate that is thirty times as high is learnt in nine rows");
	/* After three repairs in 100 rows the rest of .9 takes 90 rows, and 144 if others
	 * follow at two in 100 rows. */
	ok(life_of(100, cleaned, 0, 0, 0.05) < 90 &&
			life_of(100, cleaned, 0, 0, 0.5) > 90 &&
			life_of(100, cleaned, 0, 0, 0.5) < 144 &&
			life_of(100, cleaned, 0, 0, 0.95) > 144,
		"after three repairs others may follow, or none: %g, %g and %g rows",
		life_of(100, cleaned, 0, 0, 0.05), life_of(100, cleaned, 0, 0, 0.5),
		life_of(100, cleaned, 0, 0, 0.95));
	near(median_life(60, quiet_repair, 0, 0), plain + 40, 6,
		"a repair in quiet data lengthens the life by what it sets back");
}

/* Even wear to 80 % of the threshold: an observation must not set the variance of its own
 * noise, or coordinates with a bend there gain weight with every row. */
static void test_noise_favours_no_bend(void)
{
	static const double noise[] = { 0.05, 0.15, 0.4 };
	struct bank_par par = { .threshold = 1, .direction = 1 };
	struct draw *d = draw_new(3, 0, RNG_NOISE);

	for (int i = 0; i < 3; i++) {
		double sum = 0;

		for (int series = 0; series < 8; series++) {
			struct bank *b = bank_new(&par);

			for (int k = 0; k < 800; k++)
				bank_add(b, k, k / 1000.0 + noise[i] * draw_normal(d));
			sum += bank_weight(b, BANK_SATURATING);
			bank_free(b);
		}
		ok(sum / 8 < 0.2,
			"noise of %g on even wear favours no bent coordinate: weight %.3f",
			noise[i], sum / 8);
	}
	draw_free(d);
}

/* The tangents to a coordinate are taken at a damage that is known by its h. */
static void test_damage_of_coordinate(void)
{
	static const struct bank_point path[] = { { 0, 0 }, { 3, 0.2 }, { 4, 0.9 } };
	static const struct bank_shape more[] = {
		{ .family = BANK_OTHER, .path = path, .n = 3 },
		{ .family = BANK_OTHER, .of_value = 1, .par = -2 },
	};
	struct bank_par par = {
		.threshold = 1, .direction = 1, .more = more, .n_more = 2
	};
	struct bank *b = bank_new(&par);
	double worst = 0;

	for (int k = 0; k < 4; k++)
		bank_add(b, k, 0.1 + 0.1 * k);
	for (int i = 0; i < b->shapes; i++)
		for (double damage = -1; damage <= 2; damage += 0.05)
			worst = tap_max(worst,
				fabs(damage_at(b, i, place_of(b, i, damage).h) - damage));
	near(worst, 0, 1e-9, "the damage at its place in every coordinate is itself");
	bank_free(b);
}

/* The noise of y = 1 - (t / T)^2, which falls to 0 at T. */
static double fallen(struct draw *d, double t, double end)
{
	return 1 - t / end * (t / end) + 0.005 * draw_normal(d);
}

/* The median life at 48 of a unit with T = 120, with earlier units that determine the
 * shape or, if there are none, alone. */
static double median_of_unit(const struct fleet *f, struct draw *d, double *weight)
{
	struct bank_chances *chances = bank_chances_new(DRAWS, 1);
	struct bank_par par = { .threshold = 0, .direction = -1 };
	struct bank *b;
	double life[DRAWS];

	if (f)
		par.more = fleet_shapes(f, &par.n_more);
	b = bank_new(&par);
	for (int k = 0; k <= 48; k++)
		bank_add(b, k, fallen(d, k, 120));
	bank_draw(b, chances, 48, 0, life);
	*weight = bank_weight(b, BANK_OTHER);
	bank_free(b);
	bank_chances_free(chances);
	return median(life, DRAWS);
}

/* Each of 20 fleets has a unit that failed, one that has not and one that does not wear.
 */
static void test_fleet(void)
{
	enum { FLEETS = 20 };
	double with = 0, alone = 0, bias = 0, heavy = 0;
	int told = 0;

	for (uint64_t seed = 1; seed <= FLEETS; seed++) {
		struct fleet *f = fleet_new(0, -1);
		struct draw *d = draw_new(seed, 0, RNG_NOISE);
		double life, weight;
		int failed, carried_on, shapes;

		for (int k = 0; k <= 104; k++)
			fleet_add(f, 0, 7 + k, fallen(d, k, 100));
		for (int k = 0; k <= 100; k++)
			fleet_add(f, 1, k, fallen(d, k, 130));
		for (int k = 0; k < 50; k++)
			fleet_add(f, 2, k, 1);
		told += fleet_build(f, &failed, &carried_on) == NUM_OK && failed == 1 &&
			carried_on == 1 && fleet_shapes(f, &shapes) && shapes == 2;
		alone += fabs(median_of_unit(NULL, d, &weight) - 72) / FLEETS;
		life = median_of_unit(f, d, &weight);
		with += fabs(life - 72) / FLEETS;
		bias += (life - 72) / FLEETS;
		heavy += weight / FLEETS;
		fleet_free(f);
		draw_free(d);
	}
	near(told, FLEETS, 0,
		"a fleet distinguishes a unit that failed, one that is continued and one that shows no wear");
	printf("# life 72: %.1f off, %+.1f, alone %.1f, weight %.2f\n", with, bias, alone,
		heavy);
	ok(with <= 0.1 * 120, "fleets of two give the life within a tenth of it: %.1f",
		with);
	ok(with < 0.5 * alone, "the error is less than half of that without: %.1f",
		alone);
	ok(heavy > 0.5, "fleets have most of the weight: %.2f", heavy);
}

/* Linear wear read in bursts: the gaps between them, six mean gaps long, are no halts.
 * Nor are the first two of a thousand usual ones, after bursts that do not tell the rate:
 * the noise of .01 would make the way to the threshold in one of them. */
static void test_bursts(void)
{
	enum { UNITS = 20 };
	static const struct {
		double between, within;
		int bursts, rows;
	} read[] = { { 0.03, 0.0005, 22, 6 }, { 0.1, 0.0001, 3, 5 } };
	struct bank_chances *chances = bank_chances_new(DRAWS, 1);
	struct bank_par par = { .threshold = 1, .direction = 1 };
	double life[DRAWS];

	for (int i = 0; i < 2; i++) {
		double off = 0;
		int inside = 0;

		for (uint64_t unit = 0; unit < UNITS; unit++) {
			struct draw *d = draw_new(unit, 0, RNG_NOISE);
			struct bank *b = bank_new(&par);
			double t = 0;

			for (int k = 0; k < read[i].bursts * read[i].rows; k++) {
				t = read[i].between * (k / read[i].rows) +
				    read[i].within * (k % read[i].rows);
				bank_add(b, t, t + 0.01 * draw_normal(d));
			}
			bank_draw(b, chances, t, 1, life);
			off += fabs(median(life, DRAWS) - (1 - t)) / UNITS;
			inside += sorted_quantile(life, DRAWS, 0.05) <= 1 - t &&
				  sorted_quantile(life, DRAWS, 0.95) >= 1 - t;
			bank_free(b);
			draw_free(d);
		}
		if (i == 0)
			ok(off < 0.05,
				"readings in bursts: the end is %.3f of the life off",
				off);
		ok(inside >= 18, "%d bursts: the intervals contain it for %d of 20",
			read[i].bursts, inside);
	}
	bank_chances_free(chances);
}

/* Linear wear read at ages that are powers of a ratio, up to 0.4 of the life: that every
 * gap is longer than the ones before tells no halt, with which the rest of the life would
 * be a millionth.  The median is early because the wear may accelerate, by a quarter
 * where nine rows are known. */
static void test_decades(void)
{
	static const double ratio[] = { 1.6, 2, 10 };
	static const int rows[] = { 30, 25, 9 };
	struct bank_chances *chances = bank_chances_new(DRAWS, 1);
	struct bank_par par = { .threshold = 1, .direction = 1 };
	double life[DRAWS], mid;

	for (int i = 0; i < 3; i++) {
		struct draw *d = draw_new((uint64_t)i, 0, RNG_NOISE);
		struct bank *b = bank_new(&par);
		double last = pow(ratio[i], rows[i] - 1);

		for (int k = 0; k < rows[i]; k++) {
			double t = pow(ratio[i], k);

			bank_add(b, t, 0.4 * t / last + 0.002 * draw_normal(d));
		}
		bank_draw(b, chances, last, 1, life);
		mid = median(life, DRAWS) / (1.5 * last);
		ok(mid > 0.5 && mid < 1.2,
			"readings at powers of %g show no halt: the median is %.2f",
			ratio[i], mid);
		bank_free(b);
		draw_free(d);
	}
	bank_chances_free(chances);
}

/* Over missing rows the filter predicts by its model; the same seed gives the same
 * states. */
static const struct adaptive_par default_filter = { .filter = { 300, 0, 0.5 },
	.order = { ORDER_WINDOW, 60 },
	.process = NAN,
	.noise = NAN,
	.seed = 1 };

/* No exponential passes through 0.  A state is within 20 times the noise of its reading,
 * 0.6, or the particles are drawn from the readings; half as much again for the estimate
 * of the noise. */
static void test_passage_through_zero(void)
{
	struct draw *d = draw_new(6, 0, RNG_NOISE);
	double farthest = 0;

	for (int path = 0; path < 12; path++) {
		struct adaptive *a = adaptive_new(&default_filter);

		for (int k = 0; k < 40; k++) {
			double y = 3 - (path % 2 ? 0.5 * k : 0.02 * k * k) +
				   0.03 * draw_normal(d);
			struct adaptive_row r;

			adaptive_step(a, k, y, &r);
			farthest = fmax(farthest, fabs(r.state - y));
		}
		adaptive_free(a);
	}
	ok(farthest > 0.01 && farthest < 0.9,
		"the filter follows a series through zero: %.3g off at most", farthest);
	draw_free(d);
}

/* No curve through a step has to do with the values before and after it: a forecast is at
 * most grey_reach() times the newest value of the fit, e^4 in one row. */
static void test_forecast_after_step(void)
{
	struct draw *d = draw_new(6, 0, RNG_NOISE);
	double farthest = 0;

	for (int path = 0; path < 6; path++) {
		struct adaptive *a = adaptive_new(&default_filter);

		for (int k = 0; k < 100; k++) {
			double y = (k < 50 ? 0 : 100) + 0.1 * draw_normal(d);
			struct adaptive_row r;

			adaptive_step(a, k, y, &r);
			if (k > 0)
				farthest = fmax(
					farthest, fmax(fabs(r.grey), fabs(r.prediction)));
		}
		adaptive_free(a);
	}
	ok(farthest > 99 && farthest < 100 * exp(4),
		"forecasts after a step are within reach: %.4g at most", farthest);
	draw_free(d);
}

static void test_adaptive(void)
{
	const struct adaptive_par par = default_filter;
	struct adaptive *a = adaptive_new(&par), *b = adaptive_new(&par);
	struct draw *d = draw_new(6, 0, RNG_NOISE);
	struct adaptive_row r, s;
	double filtered = 0, observed = 0;
	int same = 1, n = 0;

	for (int k = 0; k < 600; k++) {
		double truth = 1.5 + 0.001 * k, y = truth + 0.06 * draw_normal(d);

		if (k % 10 == 7)
			y = NAN;
		adaptive_step(a, k, y, &r);
		adaptive_step(b, k, y, &s);
		same &= r.state == s.state && r.ess == s.ess;
		if (k > 60 && !isnan(y)) {
			filtered += (r.state - truth) * (r.state - truth);
			observed += (y - truth) * (y - truth);
			n++;
		}
	}
	ok(same, "the same seed gives the same states");
	ok(filtered < 0.5 * observed,
		"the filter removes more than half of the noise: %.2f",
		filtered / observed);
	ok(adaptive_counts(a).restarts == 0 && n > 400, "the filter does not restart");
	adaptive_free(a);
	adaptive_free(b);
	draw_free(d);
}

static double bend; /* of bent() */

static double bent(double x)
{
	return x + bend * x * x;
}

/* Steady up to 0.8, from then on with a part that grows by the power 1.5. */
static double turned(double x)
{
	return 0.3 * x + 0.7 * pow(fmax(0, x - 0.8) / 0.2, 1.5);
}

/* Kachanov's damage at a constant load, dD/dt = c / (1 - D)^3, up to the threshold at
 * 0.62: it grows ever faster, as cracks do in a body of finite width. */
static double failing(double x)
{
	return 1 - pow(1 - 0.98 * x, 0.25);
}

/* Of 20 quiet series of a curve, its rows even from 0 to 1, where the threshold is, after
 * the first read of them: how many ends are within the 90 % interval of these
 * coordinates, without changes of the rate if they are straight lines, and its mean width
 * in rows. */
static int ends_inside(double (*curve)(double), int rows, int read, double noise,
	unsigned families, double *width)
{
	struct bank_chances *chances = bank_chances_new(DRAWS, 1);
	struct bank_par par = { .threshold = curve(1),
		.direction = 1,
		.families = families,
		.steady = families == BANK_LINEAR };
	double life[DRAWS];
	int inside = 0;

	*width = 0;
	for (uint64_t seed = 1; seed <= 20; seed++) {
		struct draw *d = draw_new(seed, 0, RNG_NOISE);
		struct bank *b = bank_new(&par);
		double early, late;

		for (int k = 0; k <= read; k++)
			bank_add(b, k, curve((double)k / rows) + noise * draw_normal(d));
		bank_draw(b, chances, read, par.threshold, life);
		median(life, DRAWS); /* sorts */
		early = sorted_quantile(life, DRAWS, 0.05);
		late = sorted_quantile(life, DRAWS, 0.95);
		inside += early <= rows - read && rows - read <= late;
		*width += (late - early) / 20;
		bank_free(b);
		draw_free(d);
	}
	bank_chances_free(chances);
	return inside;
}

static void test_bent_wear(void)
{
	double width;
	int inside;

	bend = 0;
	inside = ends_inside(bent, 100, 60, 0.001, BANK_LINEAR, &width);

	ok(inside >= 16 && width < 1,
		"straight lines hold %d of 20 ends of straight wear, in %.2f", inside,
		width);
	bend = 0.3;
	inside = ends_inside(bent, 100, 60, 0.001, BANK_ALL, &width);
	ok(inside >= 16, "all coordinates %d of wear that accelerates, in %.1f", inside,
		width);
	bend = -0.3;
	inside = ends_inside(bent, 100, 60, 0.001, BANK_ALL, &width);
	ok(inside >= 16, "and %d of wear that slows down, in %.1f", inside, width);
	/* one particle has nearly all the weight here */
	inside = ends_inside(turned, 400, 336, 0.0005, BANK_ALL, &width);
	ok(inside >= 16, "and %d of wear that has turned, in %.1f", inside, width);
	/* no coordinate follows this curve to its end, 7 rows later */
	inside = ends_inside(failing, 100, 93, 0.002, BANK_ALL, &width);
	ok(inside >= 16 && width < 10, "and %d of damage that ends in a failure, in %.1f",
		inside, width);
}

/* The mean width of the 90 % intervals of Wiener processes of rate 1 / 120 a row, with
 * this wander in a root of a row and read with noise 0.005, at half of their mean life,
 * over 3.29 standard deviations of the life if wander and noise were known: after n rows,
 * n before the end, wander / rate * sqrt(n + n). */
static double width_of_wander(double wander)
{
	enum { PATHS = 40, HALF = 60 };
	struct bank_chances *chances = bank_chances_new(DRAWS, 1);
	struct bank_par par = {
		.threshold = 1, .direction = 1, .families = BANK_LINEAR, .steady = 1
	};
	double life[DRAWS], sum = 0;

	for (uint64_t seed = 1; seed <= PATHS; seed++) {
		struct draw *d = draw_new(seed, 0, RNG_NOISE);
		struct bank *b = bank_new(&par);
		double end = HALF / 120.0, away[HALF + 1] = { 0 };

		/* all paths end where the mean does, so that their widths compare */
		for (int k = 1; k <= HALF; k++)
			away[k] = away[k - 1] + wander * draw_normal(d);
		for (int k = 0; k <= HALF; k++)
			bank_add(b, k,
				away[k] + (end - away[HALF]) * k / HALF +
					0.005 * draw_normal(d));
		bank_draw(b, chances, HALF, 1, life);
		median(life, DRAWS); /* sorts */
		sum += sorted_quantile(life, DRAWS, 0.95) -
		       sorted_quantile(life, DRAWS, 0.05);
		bank_free(b);
		draw_free(d);
	}
	bank_chances_free(chances);
	return sum / PATHS / (3.29 * wander * 120 * sqrt(2 * HALF));
}

/* Intervals are wider than right, because the wander is not known, and a fading memory
 * explains it too; with one wander of 3 times the noise, those of the least are 1.97
 * times as wide. */
static void test_wander(void)
{
	static const double most[] = { 1.5, 1.5, 1.6, 1.8 };

	for (int k = 0; k < 4; k++) {
		double wander = ldexp(0.0025, k), ratio = width_of_wander(wander);

		ok(ratio > 1 && ratio < most[k],
			"a wander of %g is learnt: widths are %.2f of the right ones",
			wander, ratio);
	}
}

int main(void)
{
	test_noise();
	test_grey_series();
	test_orders();
	test_straight_wear();
	test_readings_rounded_down();
	test_clock();
	test_disturbances();
	test_no_wear();
	test_few_rows();
	test_noise_favours_no_bend();
	test_damage_of_coordinate();
	test_bent_wear();
	test_wander();
	test_fleet();
	test_bursts();
	test_decades();
	test_adaptive();
	test_passage_through_zero();
	test_forecast_after_step();
	return tap_done();
}
