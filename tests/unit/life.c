/* Order selection, noise, run-in, history, damage models and fleet comparison. */
#include "life/adaptive.h"
#include "life/damage.h"
#include "life/fleet.h"
#include "life/grey.h"
#include "life/history.h"
#include "life/noise.h"
#include "life/runin.h"
#include "tap.h"
#include <stdlib.h>

static void test_noise(void)
{
	struct draw *d = draw_new(1, 0, RNG_NOISE);
	struct noise *n = noise_new();
	double t = 0;

	/* A quadratic with noise 0.1 at gaps of 0.5 to 1.5; the median of 256 absolute
	 * residuals has a standard error of 7 %, one in fifty is an outlier,
	 * which spoils three residuals and raises the median by 7 %. */
	for (int k = 0; k < 1000; k++) {
		double gap = 0.5 + draw_uniform(d);
		double y = 1e-4 * t * t + 0.1 * draw_normal(d) + (k % 50 == 9 ? 5 : 0);

		noise_add(n, y, gap);
		t += gap;
	}
	near(noise_scale(n), 0.107, 0.02, "noise from second differences, with outliers");
	noise_free(n);
	n = noise_new();
	for (int k = 0; k < 10; k++)
		noise_add(n, 3 + 2.0 * k, 1);
	near(noise_scale(n), 0, 1e-12, "none on a straight line");
	noise_free(n);
	draw_free(d);
}

static void test_history(void)
{
	struct history *h = history_new();
	const double *t, *x;
	double sum = 0;
	int n;

	for (int k = 0; k < 100; k++)
		history_add(h, k, 2.0 * k);
	n = history_get(h, &t, &x);
	ok(n == 100 && t[42] == 42 && x[42] == 84, "a short history is kept as it is");
	for (int k = 100; k < 100003; k++)
		history_add(h, k, 2.0 * k);
	n = history_get(h, &t, &x);
	ok(n <= HISTORY_MAX && n >= HISTORY_MAX / 4, "a long one in %d groups", n);
	for (int k = 0; k < n; k++)
		sum += fabs(x[k] - 2 * t[k]);
	ok(sum < 1e-6 && t[0] == 0.5 * (t[1] - t[0] - 1), "of equal means");
	history_free(h);
}

/* An alternating series is best forecast by many points; fixed orders stay; window
 * errors are those of the grey model itself. */
static void test_orders(void)
{
	struct order_par par = { ORDER_WINDOW, 30, 20, 0.03, 0, 0 };
	struct order *o = order_new(&par), *all, *ranged;
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
		"forecast of the chosen order");
	ok(order_chosen(o) > 10, "white noise wants a high order: %d", order_chosen(o));
	par.rule = ORDER_ALL;
	all = order_new(&par);
	par.range_low = 4;
	par.range_high = 8;
	ranged = order_new(&par);
	for (int k = 0; k < 200; k++) {
		order_add(all, y[k], 1);
		order_add(ranged, y[k], 1);
	}
	ok(order_skipped(ranged) > 0 &&
			order_tried(ranged) + order_skipped(ranged) == order_tried(all),
		"what the range leaves out is counted");
	order_free(o);
	order_free(all);
	order_free(ranged);
	draw_free(d);
}

static void test_runin(void)
{
	struct runin rise = { .direction = 1 }, bump = { .direction = -1 };
	int risen = 0, bumped = 0, last = 0;

	for (int k = 0; k < 400; k++) {
		double excursion = exp(-pow((k - 40) / 15.0, 2));

		risen += runin_add(&rise, exp(0.01 * k), 0.01);
		if (runin_add(&bump, -(0.002 * k + excursion), 0.02)) {
			bumped++;
			last = k;
		}
	}
	ok(risen == 0, "what only rises has no run-in");
	ok(bumped > 0 && last > 55 && last < 100, "a bump about row 40 ends by row %d",
		last);
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
static void test_damage(void)
{
	struct draw *d = draw_new(2, 0, RNG_NOISE);
	double *z = malloc(5 * DRAWS * sizeof *z), *life = malloc(DRAWS * sizeof *life);
	double noise = 0.01, sum = 0, squares = 0, inside = 0;
	int runs = 60;

	draw_normals(d, z, 5 * DRAWS);
	for (int r = 0; r < runs; r++) {
		struct damage *m = damage_new(DAMAGE_LINEAR, 1, 1);
		double mid, low, high;

		for (int k = 0; k < 60; k++)
			damage_add(m, k, (k + 0.0) / 100 + noise * draw_normal(d));
		damage_draw(m, 59, z, 5 * DRAWS, life, DRAWS);
		mid = median(life, DRAWS);
		low = life[DRAWS / 20];
		high = life[DRAWS - DRAWS / 20];
		sum += mid - 41;
		squares += (mid - 41) * (mid - 41);
		inside += low <= 41 && 41 <= high;
		damage_free(m);
	}
	near(sum / runs, 0, 0.6, "lives of straight lines are unbiased");
	/* Least squares: sd of the passage at 100 from 60 rows, sigma / slope times
	 * sqrt(1 / n + (100 - 29.5)^2 / Sxx) = 0.54; shorter memories and Wiener noise in
	 * the bank may cost a factor of two. */
	ok(sqrt(squares / runs) < 1.1, "error %.2f of lives", sqrt(squares / runs));
	ok(inside / runs > 0.85, "the 90 %% interval holds %.0f %%", 100 * inside / runs);
	free(z);
	free(life);
	draw_free(d);
}

static void test_fleet(void)
{
	struct fleet *f = fleet_new(0, -1);
	struct draw *d = draw_new(2, 0, RNG_NOISE);
	double z[200], life[100];

	draw_normals(d, z, 200);
	/* y = 1 - t / T falls to 0 after T = 10, 20, 30, 40; the fifth never does. */
	for (int u = 0; u < 4; u++)
		for (int k = 0; k <= 12; k++)
			fleet_add(f, u, 5 + k * (u + 1), 1 - k / 10.0);
	fleet_add(f, 4, 0, 1);
	ok(fleet_build(f) == 4 && fleet_units(f) == 5, "units that failed are counted");
	ok(fleet_life(f, 0.5, 60, z, life, 100), "life by comparison");
	near(median(life, 100), 60, 1e-6, "half way at 60: as much again");
	near(life[99] - life[0], 0, 1e-4, "no spread where units are alike");
	ok(fleet_life(f, 1, 0, z, life, 100) && median(life, 100) > 15 && life[50] < 30,
		"whole lives at age 0");
	fleet_free(f);
	f = fleet_new(1, 1);
	fleet_add(f, 0, 0, 0);
	fleet_add(f, 0, 1, 2);
	ok(fleet_build(f) == 1 && !fleet_life(f, 0.5, 1, z, life, 100),
		"one unit is too few");
	fleet_free(f);
	draw_free(d);
}

/* Missing rows move the filter on by its model; the same seed gives the same states. */
static void test_adaptive(void)
{
	struct adaptive_par par = { .filter = { 300, 0, RESAMPLE_SYSTEMATIC, 0.5, 0 },
		.order = { ORDER_WINDOW, 60, 50, 0.03, 0, 0 },
		.process = NAN,
		.noise = NAN,
		.seed = 1 };
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
	ok(same, "the same seed, the same states");
	ok(filtered < 0.5 * observed,
		"the filter takes out half of the noise and more: %.2f",
		filtered / observed);
	ok(adaptive_restarts(a) == 0 && n > 400, "without a restart");
	adaptive_free(a);
	adaptive_free(b);
	draw_free(d);
}

int main(void)
{
	test_noise();
	test_history();
	test_orders();
	test_runin();
	test_damage();
	test_fleet();
	test_adaptive();
	return tap_done();
}
