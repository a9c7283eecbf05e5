/* observed - rates of the observations, and the grey model of all of them */
#include "life/pair/observed.h"
#include "life/grey/grey.h"
#include "tap.h"

enum { N = 20000 };

static void check_rates(void)
{
	struct observed by_mean = { 0 }, *mean = &by_mean;
	struct observed by_last = { 0 }, *last = &by_last;
	double t[] = { 10, 11, 13, 13, 17 }, h[] = { 1, 2, 3, 4, 6 };

	ok(isnan(observed_rate(mean, RATE_MEAN, NULL)), "no observation gives no rate");
	for (int i = 0; i < 5; i++) {
		observed_add(mean, (struct moment){ t[i], h[i], 0 }, h[i]);
		observed_add(last, (struct moment){ t[i], h[i], 0 }, h[i]);
		if (i == 0)
			ok(isnan(observed_rate(mean, RATE_MEAN, NULL)),
				"one observation gives no rate");
		if (i == 3)
			near(observed_rate(last, RATE_LAST, NULL), 1, 0,
				"observations at the same time take the rate from the time before");
	}
	near(observed_rate(mean, RATE_MEAN, NULL), 5 / 7., 1e-15,
		"the mean rate is the whole wear over its time");
	near(observed_rate(last, RATE_LAST, NULL), 0.5, 0,
		"the last rate is the last wear over its time");
	ok(observed_gap(last) == 6 && last->last.t == 17,
		"the latest observation is returned");
	observed_begin(mean, (struct moment){ 20, 7, 0.5 });
	observed_add(mean, (struct moment){ 22, 8, 0.25 }, 8);
	near(observed_rate(mean, RATE_MEAN, NULL), 0.5, 0, "the rates can be restarted");
	near(observed_rate(mean, RATE_MEAN, (double[]){ 2, -1 }), 1, 0,
		"the errors of both gaps are those of the rate");
}

/* Of a gap in so many rows. */
static double trend_of(int rows, double (*gap)(double part))
{
	struct observed by_mean = { 0 };

	for (int i = 0; i < rows; i++)
		observed_add(
			&by_mean, (struct moment){ 10 * i, gap((double)i / rows), 0 }, 1);
	return observed_rate_trend(&by_mean);
}

static double linear(double part)
{
	return 3 + part;
}

static double square(double part)
{
	return part * part;
}

/* The same gaps, each after one at its time that it replaces. */
static double trend_of_replaced(void)
{
	struct observed by_mean = { 0 };

	for (int i = 0; i < 9; i++) {
		observed_add(&by_mean, (struct moment){ 10 * i, -square(i / 9.), 0 }, 1);
		observed_add(&by_mean, (struct moment){ 10 * i, square(i / 9.), 0 }, 1);
	}
	return observed_rate_trend(&by_mean);
}

/* S = n (n - 1) / 2 for rates that only grow, of variance n (n - 1) (2 n + 5) / 18. */
static void check_trend(void)
{
	ok(trend_of(2, square) == 0, "one rate has no trend");
	near(trend_of(9, square), 28 / sqrt(8 * 7 * 21 / 18.), 1e-12,
		"eight rates that only grow");
	near(trend_of(17, sqrt), -120 / sqrt(16 * 15 * 37 / 18.), 1e-12,
		"sixteen rates that only fall");
	ok(trend_of(1000, square) > 3.4 && trend_of(1000, square) < 5.2,
		"of a thousand rates between eight and sixteen are compared");
	near(trend_of_replaced(), trend_of(9, square), 0, "gaps replaced do not count");
	ok(fabs(trend_of(1000, linear)) == 0, "a constant rate has no trend");
}

static double repaired(double part)
{
	return part - 0.3 * (part > 0.5) + 0.02 * sin(1e4 * part);
}

static double noisy(double part)
{
	return part + 0.02 * sin(1e4 * part);
}

static int falls(int rows, double (*gap)(double part), double halt)
{
	struct observed o = { 0 };

	for (int i = 0; i < rows; i++)
		observed_add(&o,
			(struct moment){
				i + (2 * i > rows ? halt : 0), gap((double)i / rows), 0 },
			1);
	return observed_falls(&o);
}

static void check_falls(void)
{
	ok(falls(12, repaired, 0) && falls(17, repaired, 0) && falls(200, repaired, 0),
		"a repair is found in 12, 17 and 200 rows");
	ok(!falls(8, repaired, 0), "not in eight");
	ok(!falls(12, noisy, 0) && !falls(17, noisy, 0) && !falls(200, noisy, 0),
		"noise is no repair");
	ok(!falls(17, linear, 0) && !falls(17, linear, 30), "nor is a halt");
	ok(!falls(17, square, 0) && !falls(17, sqrt, 0), "nor a rate that changes");
}

/* Backward sums of all values at each check, as grey.h makes them. */
static void check_grey(const char *what, double level, double unit)
{
	static double t[N], x[N];
	struct observed by_mean = { 0 }, *o = &by_mean;
	double worst = 0;

	for (int i = 0; i < N; i++) {
		t[i] = (1e6 + i + 0.3 * sin(i * i)) * unit;
		x[i] = level * exp(2e-5 * i) * (1 + 0.03 * sin(3. * i * i));
		observed_add(o, (struct moment){ t[i], 1, 0 }, x[i]);
		if (i >= 3 && (i < 60 || i % 1000 == 0 || i == N - 1)) {
			struct grey g = { 0 };
			double spacing = (t[i] - t[0]) / i, now, rate, want;

			for (int k = i; k >= 0; k--)
				grey_add(&g, x[k] / level,
					k < i ? (t[k + 1] - t[k]) / spacing : 1);
			now = grey_forecast(&g, 0, 1);
			rate = -grey_rate(&g);
			want = now >= 3   ? 0
			       : rate > 0 ? log(3 / now) / rate * spacing
					  : INFINITY;
			if (want != grey_life(&o->grey, 3 * level, 1, 0, 0))
				worst = tap_max(worst,
					fabs(grey_life(&o->grey, 3 * level, 1, 0, 0) /
							want -
						1));
		}
	}
	ok(worst < 1e-9, "%s: forward and backward sums agree to %.1e", what, worst);
}

int main(void)
{
	struct observed by_mean = { 0 }, *o = &by_mean;

	check_rates();
	check_trend();
	check_falls();
	check_grey("values of 2, hours", 2, 1);
	check_grey("values of 1e-200, 1e-9", 1e-200, 1e-9);
	check_grey("values of 1e200, 1e9", 1e200, 1e9);
	for (int i = 0; i < 10; i++) {
		ok(i >= 4 || isnan(grey_life(&o->grey, 3, 1, 0, 0)),
			"a model needs four values");
		observed_add(o, (struct moment){ i, 2, 0 }, 2);
	}
	ok(isinf(grey_life(&o->grey, 3, 1, 0, 0)) && grey_life(&o->grey, 2, 1, 0, 0) == 0,
		"a constant is continued as a constant");
	return tap_done();
}
