/* The grey model against the textbook and against 60-digit arithmetic. */
#include "life/grey/grey.h"
#include "tap.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static struct grey fit(const double *x, int n)
{
	struct grey g = { 0 };

	for (int k = n; k-- > 0;)
		grey_add(&g, x[k], 1);
	return g;
}

/* Coefficient b of the usual formulation, in which x1 starts at the oldest value. */
static double control_of(const struct grey *g)
{
	return grey_level(g) + grey_rate(g) * g->oldest;
}

/* tests/data/gm11.tsv: a and b to 12 digits, forecasts 1 to 3 steps ahead. */
static void test_golden(void)
{
	FILE *f = fopen("tests/data/gm11.tsv", "r");
	char line[2000], *tail, *text;
	int rows = 0;

	if (!ok(f && fgets(line, sizeof line, f),
		    "the reference table of GM(1,1) can be read"))
		return;
	while (fgets(line, sizeof line, f)) {
		double a, b, want[3], x[64];
		int n, k = 0;
		struct grey g;

		if (!ok(sscanf(line, "%*s %d %lf %lf %*f %*f %lf,%lf,%lf", &n, &a, &b,
				want, want + 1, want + 2) == 6 &&
				    n <= 64,
			    "row %d of the reference table can be read", ++rows))
			continue;
		text = strrchr(line, '\t') + 1;
		for (; k < n; k++, text = tail + 1)
			x[k] = strtod(text, &tail);
		g = fit(x, n);
		near(grey_rate(&g), a, 1e-12 * fabs(a) + 1e-13,
			"the coefficient a is that of the reference");
		near(control_of(&g), b, 1e-11 * fabs(b),
			"the coefficient b is that of the reference");
		for (int h = 1; h <= 3; h++)
			near(grey_forecast(&g, h, 1), want[h - 1], 1e-11,
				"the forecast is that of the reference");
	}
	ok(rows == 2, "the reference table has 2 rows");
	fclose(f);
}

/* The series of gm11_long.py, whose values are exact in double precision. */
static double *make_series(int n)
{
	double *x = malloc((size_t)n * sizeof *x);
	uint32_t s = 1;

	for (int k = 0; x && k < n; k++) {
		x[k] = 2 + k * 0x1p-21 + s * 0x1p-36;
		s = 1664525 * s + 1013904223;
	}
	return x;
}

/* Every order, up to a million points in one window: forecasts within 1e-12. */
static void test_long(void)
{
	FILE *f = fopen("tests/data/gm11_long.tsv", "r");
	double *x = make_series(1000000), worst[2] = { 0, 0 }, worst_b = 0;
	char line[400];
	int rows = 0;

	if (!ok(f && x, "the reference table of 60 digits can be read")) {
		free(x);
		return;
	}
	while (fgets(line, sizeof line, f)) {
		double a, b, want;
		int k, p;
		struct grey g;

		if (sscanf(line, "%d %d %lf %lf %lf", &k, &p, &a, &b, &want) != 5)
			continue;
		rows++;
		g = fit(x + k - p, p);
		worst[p > 60] =
			tap_max(worst[p > 60], fabs(grey_forecast(&g, 1, 1) / want - 1));
		worst_b = tap_max(worst_b, fabs(control_of(&g) / b - 1));
	}
	fclose(f);
	free(x);
	ok(rows == 60, "the reference table has 60 rows");
	ok(worst[0] < 1e-14,
		"orders 4 to 60 after up to 1e6 rows have an error of %.2g < 1e-14",
		worst[0]);
	ok(worst[1] < 1e-12,
		"windows of all rows, up to 1e6, have an error of %.2g < 1e-12",
		worst[1]);
	ok(worst_b < 1e-11, "the error of b is %.2g < 1e-11", worst_b);
}

static void test_plain_series(void)
{
	double x[60], next;
	struct grey g;

	for (int k = 0; k < 60; k++)
		x[k] = 2;
	g = fit(x, 10);
	near(grey_forecast(&g, 1, 1), 2, 1e-15,
		"a constant series is continued as a constant");
	near(grey_forecast(&g, 1000, 1), 2, 1e-15,
		"the constant continues for any horizon");
	for (int k = 0; k < 60; k++)
		x[k] = 2 + 1e-12 * ((k * 7) % 5 - 2);
	g = fit(x, 10);
	near(grey_forecast(&g, 1, 1), 2, 1e-11,
		"a nearly constant series is continued as a constant");
	/* An exponential of ratio q has a = -2 (q - 1) / (q + 1) up to rounding. */
	for (int k = 0; k < 60; k++)
		x[k] = 3 * pow(1.02, k);
	g = fit(x, 60);
	near(grey_rate(&g), -2 * 0.02 / 2.02, 1e-14,
		"the rate of a growing exponential is right");
	for (int k = 0; k < 60; k++)
		x[k] = 3 * pow(0.97, k);
	g = fit(x, 40);
	near(grey_rate(&g), 2 * 0.03 / 1.97, 1e-14,
		"the rate of a falling exponential is right");
	for (int k = 0; k < 60; k++)
		x[k] = k < 3 ? pow(10, 100 * k) : 0;
	g = fit(x, 4);
	ok(isfinite(grey_forecast(&g, 1, 1)),
		"a diverging series gives a finite forecast");
	memset(x, 0, sizeof x);
	g = fit(x, 5);
	near(grey_forecast(&g, 1, 1), 0, 0, "a series of zeros is continued with zeros");
	/* Scale invariance is exact for powers of two. */
	for (int k = 0; k < 20; k++)
		x[k] = 1 + 0.1 * k + 0.05 * (k % 3);
	g = fit(x, 20);
	next = grey_forecast(&g, 2, 1);
	for (int k = 0; k < 20; k++)
		x[k] *= 0x1p-300;
	g = fit(x, 20);
	ok(grey_forecast(&g, 2, 1) == next * 0x1p-300,
		"scaling by a power of two is exact");
}

/* Interval means of an exponential over unequal gaps: the trapezium of the fit errs by
 * (a gap)^2 / 12, 1e-4 of the rate here. */
static void test_gaps(void)
{
	static const double gap[12] = { 0, 1, 2, 0.5, 1, 1.5, 3, 1, 0.25, 1, 2, 1 };
	double rate = 0.01, t = 0, x[12];
	struct grey g = { 0 };

	for (int k = 1; k < 12; k++) {
		x[k] = (exp(rate * (t + gap[k])) - exp(rate * t)) / (rate * gap[k]);
		t += gap[k];
	}
	x[0] = 1;
	for (int k = 12; k-- > 0;)
		grey_add(&g, x[k], k < 11 ? gap[k + 1] : 0);
	near(grey_rate(&g), -rate, 1e-4 * rate, "the rate from unequal gaps is right");
	near(grey_forecast(&g, 3, 3), (exp(rate * (t + 3)) - exp(rate * t)) / (3 * rate),
		1e-4, "the forecast over a longer interval is right");
}

int main(void)
{
	test_golden();
	test_long();
	test_plain_series();
	test_gaps();
	return tap_done();
}
