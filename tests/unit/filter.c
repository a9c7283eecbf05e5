/* The particle filter against the Kalman filter, and resampling against its definition.
 */
#include "life/particle/filter.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

enum { STEPS = 400 };
static const double DRIFT = 0.02, PROCESS = 0.1, NOISE = 0.2;

/* A drifting random walk observed with noise. */
struct walk {
	double x[STEPS], y[STEPS];
};

static void make_walk(struct walk *w, uint64_t seed)
{
	struct draw *d = draw_new(seed, 0, RNG_NOISE);
	double x = 0;

	for (int k = 0; k < STEPS; k++) {
		x += DRIFT + PROCESS * draw_normal(d);
		w->x[k] = x;
		w->y[k] = x + NOISE * draw_normal(d);
	}
	draw_free(d);
}

/* Root mean square error of the Kalman filter, and its log evidence. */
static double kalman(const struct walk *w, double *evidence)
{
	double x = 0, p = NOISE * NOISE, sum = 0;

	*evidence = 0;
	for (int k = 0; k < STEPS; k++) {
		double e, s, gain;

		x += DRIFT;
		p += PROCESS * PROCESS;
		e = w->y[k] - x;
		s = p + NOISE * NOISE;
		gain = p / s;
		*evidence -= 0.5 * (log(2 * M_PI * s) + e * e / s);
		x += gain * e;
		p *= 1 - gain;
		sum += (x - w->x[k]) * (x - w->x[k]);
	}
	return sqrt(sum / STEPS);
}

/* The same quantities of the particle filter. */
static double particles(const struct walk *w, const struct filter_par *par,
	double missing, double *evidence)
{
	struct draw *d = draw_new(5, 0, RNG_FILTER);
	struct filter *f = filter_new(par, d);
	double *mean = malloc(par->particles * sizeof *mean), past = 0, sum = 0;

	*evidence = 0;
	filter_start(f, &past, 1, sqrt(3) * NOISE);
	for (int k = 0; k < STEPS; k++) {
		struct filter_step now = filter_step(f, 0);

		for (size_t i = 0; i < par->particles; i++)
			mean[i] = now.x[now.ancestor[i]] + DRIFT;
		filter_predict(f, mean, PROCESS);
		if (!(missing > 0) || fmod(k * missing, 1) >= missing)
			*evidence += filter_update(f, w->y[k], NOISE);
		sum += (filter_now(f).mean - w->x[k]) * (filter_now(f).mean - w->x[k]);
	}
	free(mean);
	filter_free(f);
	draw_free(d);
	return sqrt(sum / STEPS);
}

/* Over twenty series, N = 2000: the theory says 1 + O(1/N); 2 % is the claim. */
static void test_kalman(double share, const char *name)
{
	struct filter_par par = { 2000, 2, share };
	double best = 0, got = 0, log_best, log_got, worst = 0;

	for (int s = 0; s < 20; s++) {
		struct walk w;
		double a, b;

		make_walk(&w, (uint64_t)s);
		a = kalman(&w, &log_best);
		b = particles(&w, &par, 0, &log_got);
		best += a * a;
		got += b * b;
		worst = tap_max(worst, fabs(log_got - log_best));
	}
	ok(fabs(sqrt(got / best) - 1) < 0.02,
		"%s: the mean is within %.4f of the Kalman filter's error", name,
		sqrt(got / best));
	/* The standard deviation of the log evidence is about sqrt(STEPS / N) = 0.45. */
	ok(worst < 2.5, "%s: the log evidence is within %.2f of the Kalman filter's",
		name, worst);
}

/* Ancestors rise, and over many draws particle i is taken n w_i times on the mean. */
static void test_resampling(void)
{
	enum { N = 16, DRAWS = 20000 };
	struct draw *d = draw_new(3, 0, RNG_FILTER);
	double weight[N], sum = 0, count[N] = { 0 }, worst = 0;
	uint32_t ancestor[N];
	int rising = 1, most = 0;

	for (int i = 0; i < N; i++)
		sum += weight[i] = i == 7 ? 0 : 1 + (i * 5) % 7;
	for (int k = 0; k < DRAWS; k++) {
		int copies[N] = { 0 };

		resample(d, weight, sum, N, ancestor);
		for (int i = 0; i < N; i++) {
			rising &= i == 0 || ancestor[i] >= ancestor[i - 1];
			count[ancestor[i]]++;
			copies[ancestor[i]]++;
		}
		for (int i = 0; i < N; i++) {
			int off = abs(copies[i] - (int)(N * weight[i] / sum));

			most = off > most ? off : most;
		}
	}
	for (int i = 0; i < N; i++) {
		double want = N * weight[i] / sum;

		worst = tap_max(worst, fabs(count[i] / DRAWS - want));
	}
	draw_free(d);
	ok(rising, "systematic: the ancestors ascend");
	ok(count[7] == 0, "systematic: an ancestor without weight has no copies");
	/* Five standard errors of a multinomial count, sqrt(N w (1 - w) / DRAWS). */
	ok(worst < 0.05, "systematic: the resampling is unbiased, worst deviation %.3f",
		worst);
	ok(most <= 1, "systematic: the number of copies is within one of n w");
}

static void test_weights(void)
{
	struct filter_par par = { 500, 3, 0.5 };
	struct draw *d = draw_new(1, 0, RNG_FILTER);
	struct filter *f = filter_new(&par, d);
	double *mean = calloc(500, sizeof *mean), past = 0, evidence;

	filter_start(f, &past, 1, 1);
	near(filter_now(f).ess, 500, 1e-9, "the weights are equal at the start");
	filter_predict(f, mean, 1);
	/* 1e6 standard deviations away: exp() of every weight is 0 */
	evidence = filter_update(f, 1e3, 1e-3);
	ok(isfinite(evidence) && isfinite(filter_now(f).mean),
		"weights that underflow stay finite");
	ok(filter_now(f).ess >= 1 && filter_now(f).mean > 1.5,
		"the nearest particle survives");
	filter_predict(f, mean, 1);
	near(filter_now(f).ess, 500, 1e-9,
		"the filter resamples after the collapse of the weights");
	filter_free(f);
	free(mean);
	draw_free(d);
}

/* Histories: the states of lag 1 seen through the ancestors are those the particles came
 * from, here marked by their values. */
static void test_genealogy(void)
{
	struct filter_par par = { 64, 4, 1 };
	struct draw *d = draw_new(2, 0, RNG_FILTER);
	struct filter *f = filter_new(&par, d);
	struct filter_step now, before;
	double mean[64], past = 0;
	int good = 1;

	filter_start(f, &past, 1, 1);
	for (int k = 0; k < 6; k++) {
		now = filter_step(f, 0);
		for (int i = 0; i < 64; i++)
			mean[i] = now.x[now.ancestor[i]];
		filter_predict(f, mean, 0);
		filter_update(f, 0.3, 0.2);
		now = filter_step(f, 0);
		before = filter_step(f, 1);
		for (int i = 0; i < 64; i++)
			good &= before.x[before.ancestor[now.ancestor[i]]] ==
				now.x[now.ancestor[i]];
	}
	ok(good, "without process noise every particle equals its ancestor");
	filter_free(f);
	draw_free(d);
}

static void test_normals(void)
{
	enum { N = 1000000 };
	struct draw *d = draw_new(9, 0, RNG_FILTER);
	double *z = malloc(N * sizeof *z), m1 = 0, m2 = 0, m4 = 0, beyond = 0, tail = 0;

	draw_normals(d, z, N);
	for (int i = 0; i < N; i++) {
		m1 += z[i] / N;
		m2 += z[i] * z[i] / N;
		m4 += pow(z[i], 4) / N;
		beyond += z[i] > 1;
		tail += fabs(z[i]) > 3.5;
	}
	/* Each within five standard errors. */
	near(m1, 0, 5e-3, "the mean of normals is 0");
	near(m2, 1, 5 * sqrt(2) * 1e-3, "the variance of normals is 1");
	near(m4, 3, 5 * sqrt(96) * 1e-3, "the fourth moment of normals is 3");
	near(beyond / N, 0.15865525393, 5 * 3.7e-4,
		"the share of normals above one is right");
	near(tail / N, 4.6525816e-4, 5 * 2.2e-5,
		"the share of normals beyond the base layer is right");
	free(z);
	draw_free(d);
}

int main(void)
{
	struct filter_par par = { 2000, 2, 0.5 };
	struct walk w;
	double a, b, evidence;

	test_kalman(0.5, "systematic");
	test_kalman(1, "at every step");
	test_resampling();
	make_walk(&w, 1);
	b = particles(&w, &par, 0, &evidence);
	a = particles(&w, &par, 0.2, &evidence);
	ok(a > b && a < 2 * b,
		"with a fifth of the rows missing the error is %.3f, with all %.3f", a,
		b);
	test_weights();
	test_genealogy();
	test_normals();
	return tap_done();
}
