/* Lives of simulated units of many kinds, as predicted by the bank.
 *
 * usage: build/long/lives [PATHS [FAMILIES [NOISE]]]
 *
 * FAMILIES (enum bank_family, added) prints what these coordinates reach without changes
 * of regime, and tests nothing: of the kinds that follow one of them, for 1 straight
 * lines and 2 exponentials, about the best that is possible for a predictor that knows
 * the kind.  NOISE multiplies the noise of all paths, and tests nothing either.
 *
 * The first 13 kinds, the sigmoid and squares are those on whose like the constants of
 * the bank were chosen, with other seeds here; the rest only test: other shapes, other
 * sampling, heavy tails, correlated noise, outliers, rounded, missing and repeated
 * values.  Each path has a random length, noise, offset, range, direction and unit of
 * time.
 */
#include "../unit/tap.h"
#include "life/trend/bank.h"
#include "life/trend/passage.h"
#include "num/draw.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 4000, DRAWS = 500, PARTS = 3 };

/* The coverage wanted of every kind at 40, 60 and 80 % of life.  A fall of the rate that
 * has not begun, or the late turn of an S, shows in no row so far: of these even a law of
 * the future that is right on the whole covers less than it says.  A kind fails four
 * standard errors below it, so that no other rounding decides. */
static const double LEAST = 0.8;

static struct draw *dice;
static unsigned families; /* 0: all, with changes of regime */
static double loud = 1;   /* factor of the noise */

static double uniform(double a, double b)
{
	return a + (b - a) * draw_uniform(dice);
}

/* Uniform in the logarithm. */
static double between(double a, double b)
{
	return exp(uniform(log(a), log(b)));
}

/* Gamma deviate (Marsaglia, Tsang, ACM TOMS 26 (2000) 363). */
static double gamma_deviate(double a)
{
	double d = a - 1.0 / 3, c = 1 / sqrt(9 * d);

	if (a < 1)
		return gamma_deviate(a + 1) * pow(uniform(0, 1), 1 / a);
	for (;;) {
		double x = draw_normal(dice), v = pow(fmax(0, 1 + c * x), 3);

		if (v > 0 && log(uniform(0, 1)) < 0.5 * x * x + d - d * v + d * log(v))
			return d * v;
	}
}

/* --- kinds: damage at t, 1 at t = 1, for parameters that are drawn once per path -------
 */

static double p[5];

static void draw_parameters(const double range[5][2])
{
	for (int i = 0; i < 5; i++)
		p[i] = uniform(range[i][0], range[i][1]);
}

static double linear(double t)
{
	return t;
}

static double exponential(double t)
{
	return expm1(p[0] * t) / expm1(p[0]);
}

static double root(double t)
{
	return sqrt(t);
}

/* a' = a^m from a_0 = p[1] to 1 + p[1] */
static double crack(double t)
{
	double k = 1 - p[0], from = pow(p[1], k), to = pow(1 + p[1], k);
	double x = from + (to - from) * t;

	return x > 0 ? pow(x, 1 / k) - p[1] : INFINITY;
}

static double after(double t, double onset, double power)
{
	return t > onset ? pow((t - onset) / (1 - onset), power) : 0;
}

/* Run-in, steady wear, acceleration by a power of the time since its onset. */
static double three_phases(double t)
{
	double steady = -p[0] * expm1(-t / p[1]) + p[2] * t,
	       end = -p[0] * expm1(-1 / p[1]) + p[2];

	return steady + (1 - end) * after(t, p[3], p[4]);
}

static double knee(double t)
{
	return p[1] * fmin(t, p[0]) + (1 - p[1] * p[0]) * after(t, p[0], 1);
}

static double bathtub(double t)
{
	double even = -p[0] * expm1(-t / p[1]) + p[2] * t,
	       end = -p[0] * expm1(-1 / p[1]) + p[2], low = exp(-1 / p[3]);

	return even + (1 - end) * (exp((t - 1) / p[3]) - low) / (1 - low);
}

static double bearing(double t)
{
	return exp((t - 1) / p[0]);
}

static double power(double t)
{
	return pow(t, p[0]);
}

static double square(double t)
{
	return t * t;
}

/* Read in 20 levels from the start to the threshold, see record(). */
static double coarse(double t)
{
	return power(t);
}

static double steep(double t)
{
	return p[0] * t + (1 - p[0]) * after(t, p[1], p[2]);
}

/* Rates 1, p[2] and p[3], changing at p[0] and p[1]. */
static double two_knees(double t)
{
	double end = p[0] + p[2] * (p[1] - p[0]) + p[3] * (1 - p[1]);

	return (fmin(t, p[0]) + p[2] * (fmax(fmin(t, p[1]), p[0]) - p[0]) +
		       p[3] * (fmax(t, p[1]) - p[1])) /
	       end;
}

static double logarithm(double t)
{
	return log1p(p[0] * t) / log1p(p[0]);
}

static double season(double t)
{
	return t + p[0] * (sin(p[1] * t) - t * sin(p[1]));
}

static double sigmoid(double t)
{
	double low = 1 / (1 + exp(p[0] * p[1])), high = 1 / (1 + exp(p[0] * (p[1] - 1)));

	return (1 / (1 + exp(p[0] * (p[1] - t))) - low) / (high - low);
}

static double stairs(double t)
{
	double n = floor(p[0]), step = floor(t * n);

	return (step + fmin(1, (t * n - step) / p[1])) / n;
}

static double hill(double t)
{
	double c = pow(p[1], p[0]), x = pow(t, p[0]);

	return x / (x + c) * (1 + c);
}

static double saturating(double t)
{
	return expm1(-p[0] * t) / expm1(-p[0]);
}

static double fall(double t)
{
	return (fmin(t, p[0]) + p[1] * fmax(0, t - p[0])) / (p[0] + p[1] * (1 - p[0]));
}

static double tangent(double t)
{
	return tanh(p[0] * t) / tanh(p[0]);
}

static double gompertz(double t)
{
	double low = exp(-p[0]), high = exp(-p[0] * exp(-p[1]));

	return (exp(-p[0] * exp(-p[1] * t)) - low) / (high - low);
}

/* Processes: the next damage after dt from damage d at time t. */

static double wiener(double d, double t, double dt)
{
	(void)t;
	return d + dt + p[0] * sqrt(dt) * draw_normal(dice);
}

static double gamma_process(double d, double t, double dt)
{
	(void)t;
	return d + gamma_deviate(p[0] * dt) / p[0];
}

static double faster_wiener(double d, double t, double dt)
{
	return d + (0.3 + 1.4 * t) * dt + p[0] * sqrt(dt) * draw_normal(dice);
}

static double slower_wiener(double d, double t, double dt)
{
	return d - 1.05 * p[1] * exp(-p[1] * t) / expm1(-p[1]) * dt +
	       p[0] * sqrt(dt) * draw_normal(dice);
}

static double gamma_knee(double d, double t, double dt)
{
	return d + gamma_deviate(p[0] * dt) / p[0] * (t < p[1] ? 0.6 : 3);
}

static double weibull(double t)
{
	return expm1(-pow(t / p[1], p[0])) / expm1(-pow(1 / p[1], p[0]));
}

/* Rates 1, p[2] and p[2] p[3]. */
static double two_falls(double t)
{
	double at = fmin(t, p[0]) + p[2] * (fmax(fmin(t, p[1]), p[0]) - p[0]) +
		    p[2] * p[3] * fmax(0, t - p[1]);

	return at / (p[0] + p[2] * (p[1] - p[0]) + p[2] * p[3] * (1 - p[1]));
}

/* A steady part, and one that grows from nothing to everything towards the end. */
static double late(double t)
{
	return p[0] * t + (1 - p[0]) * pow(t, p[1]);
}

static double gamma_fall(double d, double t, double dt)
{
	return d + gamma_deviate(p[0] * dt) / p[0] * (t < p[1] ? 1.6 : p[2]);
}

static const struct kind {
	const char *name;
	double (*curve)(double t);
	double (*process)(double d, double t, double dt);
	double range[5][2]; /* of the parameters */
	int held;           /* 1: only tests */
} kinds[] = {
	{ "linear", linear, NULL, { { 0 } }, 0 },
	{ "Wiener", NULL, wiener, { { 0.05, 0.25 } }, 0 },
	{ "gamma", NULL, gamma_process, { { 20, 200 } }, 0 },
	{ "crack", crack, NULL, { { 1.2, 1.8 }, { 0.1, 0.4 } }, 0 },
	{ "exponential", exponential, NULL, { { 2, 4 } }, 0 },
	{ "root", root, NULL, { { 0 } }, 0 },
	{ "three phases", three_phases, NULL,
		{ { 0.05, 0.15 }, { 0.02, 0.08 }, { 0.3, 0.5 }, { 0.65, 0.8 },
			{ 1.5, 4 } },
		0 },
	{ "knee", knee, NULL, { { 0.6, 0.8 }, { 0.3, 0.5 } }, 0 },
	{ "bathtub", bathtub, NULL,
		{ { 0.1, 0.3 }, { 0.05, 0.15 }, { 0.2, 0.4 }, { 0.08, 0.15 } }, 0 },
	{ "bearing", bearing, NULL, { { 0.03, 0.15 } }, 0 },
	{ "Hill", hill, NULL, { { 1.5, 4 }, { 0.35, 0.8 } }, 0 },
	{ "saturating", saturating, NULL, { { 1, 4 } }, 0 },
	{ "fall", fall, NULL, { { 0.2, 0.7 }, { 0.15, 0.6 } }, 0 },
	{ "power", power, NULL, { { 1.5, 4 } }, 1 },
	{ "steep", steep, NULL, { { 0.2, 0.6 }, { 0.3, 0.85 }, { 1.5, 6 } }, 1 },
	{ "two knees", two_knees, NULL,
		{ { 0.2, 0.4 }, { 0.5, 0.8 }, { 0.4, 2.5 }, { 1, 7 } }, 1 },
	{ "logarithm", logarithm, NULL, { { 3, 50 } }, 1 },
	{ "season", season, NULL, { { 0.01, 0.04 }, { 10, 80 } }, 1 },
	{ "sigmoid", sigmoid, NULL, { { 4, 12 }, { 0.4, 0.8 } }, 1 },
	{ "stairs", stairs, NULL, { { 8, 30 }, { 0.1, 0.9 } }, 1 },
	{ "Wiener, ever faster", NULL, faster_wiener, { { 0.05, 0.25 } }, 1 },
	{ "low power", power, NULL, { { 0.3, 0.8 } }, 1 },
	{ "hyperbolic tangent", tangent, NULL, { { 1, 2.2 } }, 1 },
	{ "Gompertz", gompertz, NULL, { { 2, 6 }, { 3, 6 } }, 1 },
	{ "Wiener, ever slower", NULL, slower_wiener, { { 0.03, 0.12 }, { 0.7, 2.5 } },
		1 },
	{ "gamma with a knee", NULL, gamma_knee, { { 20, 200 }, { 0.4, 0.8 } }, 1 },
	{ "Weibull", weibull, NULL, { { 1.5, 4 }, { 0.45, 0.9 } }, 1 },
	{ "two falls", two_falls, NULL,
		{ { 0.15, 0.4 }, { 0.45, 0.8 }, { 0.3, 0.7 }, { 0.3, 0.7 } }, 1 },
	{ "late", late, NULL, { { 0.2, 0.6 }, { 5, 12 } }, 1 },
	{ "gamma with a fall", NULL, gamma_fall,
		{ { 20, 200 }, { 0.2, 0.5 }, { 0.3, 0.9 } }, 1 },
	{ "20 levels", coarse, NULL, { { 0.8, 2 } }, 1 },
	{ "squares", square, NULL, { { 0 } }, 0 },
};

enum { KINDS = sizeof kinds / sizeof *kinds };

struct series {
	int n, direction;
	double t[ROWS], y[ROWS], threshold, life, noise;
};

/* The damage over time, up to its passage of 1. */
static void draw_path(const struct kind *k, struct series *s)
{
	double rows = k->held ? between(15, 2000) : between(60, 300), d = 0, t = 0;
	int poisson = k->held && uniform(0, 1) < 0.3;

	draw_parameters(k->range);
	s->life = 1;
	for (s->n = 0; s->n < ROWS; s->n++) {
		double dt = s->n == 0 ? 0 : 1 / rows, before = d;

		if (poisson && s->n > 0)
			dt *= -log(uniform(0, 1));
		d = k->curve ? k->curve(t + dt) : dt > 0 ? k->process(d, t, dt) : 0;
		if (k->process && d >= 1)
			s->life = t + dt * (1 - before) / (d - before);
		t += dt;
		if ((k->process && d >= 1) || (k->curve && t > 1))
			return;
		s->t[s->n] = t;
		s->y[s->n] = d;
		if (k->process)
			s->life = t;
	}
}

/* The recorded series: with noise and faults, in some unit. */
static void record(const struct kind *k, struct series *s)
{
	double noise = loud * (k->held ? between(0.002, 0.04) : between(0.005, 0.02)),
	       e = 0;
	double offset = uniform(-3, 3), range = between(0.05, 20),
	       unit = between(0.01, 1e4);
	int fault = k->held ? (int)uniform(0, 8) : 0;
	double memory = fault == 1 ? 0.8 : 0, levels = k->curve == coarse ? 20
						       : fault == 4       ? 50
									  : 0;

	s->direction = uniform(0, 1) < 0.5 ? 1 : -1;
	range *= s->direction;
	for (int i = 0; i < s->n; i++) {
		double z = draw_normal(dice), y;

		if (fault == 2)
			z /= sqrt(gamma_deviate(1.5) / 1.5); /* Student, 3 */
		e = memory * e + sqrt(1 - memory * memory) * z;
		y = s->y[i] + noise * e;
		if (fault == 3 && uniform(0, 1) < 0.03)
			y += uniform(-1, 1);
		if (levels > 0)
			y = round(y * levels) / levels;
		if (fault == 5 && i > 0 && uniform(0, 1) < 0.5)
			s->y[i] = s->y[i - 1]; /* stuck */
		else
			s->y[i] = offset + range * y;
		if (fault == 6 && i > 0 && uniform(0, 1) < 0.2)
			s->y[i] = NAN;
		s->t[i] *= unit;
	}
	s->threshold = offset + range;
	s->life *= unit;
	s->noise = noise;
}

struct score {
	int n;
	double error[2000], inside, crps, fifth[5];
};

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/* As scripts/validate-life scores the quantiles of a program. */
static void add_score(struct score *s, double *life, double left, double end)
{
	double crps = 0, q[20];
	int fifth = 0;

	qsort(life, DRAWS, sizeof *life, ascending);
	for (int k = 1; k < 20; k++) {
		double e;

		q[k] = life[k * (DRAWS - 1) / 20];
		e = fmin(4, (q[k] - left) / end);
		crps += 2 * (e < 0 ? -k / 20.0 : 1 - k / 20.0) * e / 19;
		if (k == 10)
			s->error[s->n++] = 100 * e;
	}
	s->crps += 100 * crps;
	s->inside += q[1] <= left && left <= q[19];
	while (fifth < 4 && left > q[4 * (fifth + 1)])
		fifth++;
	s->fifth[fifth]++;
}

static void judge(const struct series *s, const struct bank_chances *chances,
	struct score score[PARTS])
{
	struct bank_par par = { .threshold = s->threshold,
		.direction = s->direction,
		.families = families,
		.steady = families > 0 };
	struct bank *b = bank_new(&par);
	double life[DRAWS];
	int part = 0;

	for (int i = 0; i <= s->n && part < PARTS; i++) {
		while (part < PARTS && i > 0 &&
			(i == s->n || s->t[i] > (0.4 + 0.2 * part) * s->life)) {
			double now = s->t[i - 1];

			if (bank_ready(b)) {
				bank_draw(b, chances, now, s->threshold, life);
				for (int k = 0; k < DRAWS; k++)
					if (life[k] > 10 * (now - s->t[0]))
						life[k] = INFINITY;
				add_score(&score[part], life, s->life - now, s->life);
			}
			part++;
		}
		if (i < s->n)
			bank_add(b, s->t[i], s->y[i]);
	}
	bank_free(b);
}

static double median(double *x, int n)
{
	qsort(x, (size_t)n, sizeof *x, ascending);
	return n > 0 ? x[n / 2] : NAN;
}

static void report(const char *name, struct score score[PARTS])
{
	printf("# %-20s", name);
	for (int k = 0; k < PARTS; k++)
		printf(" %6.1f", score[k].crps / score[k].n);
	printf(" |");
	for (int k = 0; k < PARTS; k++)
		printf(" %+6.1f", median(score[k].error, score[k].n));
	printf(" |");
	for (int k = 0; k < PARTS; k++)
		printf(" %.2f", score[k].inside / score[k].n);
	for (int k = 0; k < PARTS; k++) {
		printf(" |");
		for (int f = 0; f < 5; f++)
			printf(" %.2f", score[k].fifth[f] / score[k].n);
	}
	puts("");
}

int main(int argc, char **argv)
{
	int paths = argc > 1 ? atoi(argv[1]) : 200;
	/* standard error of the coverage of so many paths */
	double error = sqrt(LEAST * (1 - LEAST) / paths);
	struct bank_chances *chances = bank_chances_new(DRAWS, 1);
	static struct series s;
	static struct score score[PARTS];

	families = argc > 2 ? (unsigned)atoi(argv[2]) : 0;
	loud = argc > 3 ? atof(argv[3]) : 1;
	printf("# CRPS, median error (%% of life), coverage, and fifths at 40, 60, 80 %%\n");
	for (int k = 0; k < KINDS; k++) {
		memset(score, 0, sizeof score);
		for (int path = 0; path < paths; path++) {
			dice = draw_new(2026, (uint32_t)(k * 2000 + path), RNG_PARTICLE);
			draw_path(&kinds[k], &s);
			record(&kinds[k], &s);
			judge(&s, chances, score);
			draw_free(dice);
		}
		report(kinds[k].name, score);
		for (int i = 0; i < PARTS && argc < 3; i++)
			ok(score[i].inside >= (LEAST - 4 * error) * score[i].n,
				"%s at %d %% of life: the 90 %% interval holds %.2f",
				kinds[k].name, 40 + 20 * i, score[i].inside / score[i].n);
	}
	bank_chances_free(chances);
	return tap_done();
}
