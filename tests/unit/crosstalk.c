/* Crosstalk from the large pulses of a record of which nothing is known */
#include "signal/learn/crosstalk.h"
#include "num/philox.h"
#include "signal/pulse/shape.h"
#include "tap.h"
#include <math.h>
#include <stdlib.h>

enum { N = 40000, COUNT = 30 };

static const double T = 120, AMPLITUDE = 40;

/* Adds a pulse of amplitude a and duration T around t. */
static void add_pulse(const struct shape *shape, double t, double a, double *p, double *y)
{
	shape_sample(shape, t, T, 0, N, p, NULL, NULL);
	for (int i = 0; i < N; i++)
		y[i] += a * p[i];
}

/* COUNT particles in noise 1, with pulses that follow each other after lag, shares of
 * each channel in the other one, and so many shocks, which both show at once. */
static void make_record(double lag, const double share[2], int shocks, double *y)
{
	struct shape *shape = shape_new(PULSE_GAUSS);
	double *p = malloc(N * sizeof *p), z[2];

	for (int i = 0; i < 2 * N; i++)
		y[i] = 0;
	for (int k = 0; k < COUNT; k++) {
		double u = philox_uniform(5, 0, RNG_PARTICLE, (uint64_t)k);
		double t = 500 + (k + 0.6 * u) * (N - 2000) / COUNT;

		add_pulse(shape, t, AMPLITUDE, p, y);
		add_pulse(shape, t + lag, 0.8 * AMPLITUDE, p, y + N);
		for (int c = 0; c < 2 && k < shocks; c++)
			add_pulse(shape, t + 2.5 * lag, AMPLITUDE, p, y + c * N);
	}
	for (int i = 0; i < N; i++) {
		double own[] = { y[i], y[N + i] };

		philox_normal2(5, 0, RNG_NOISE, (uint64_t)i, z);
		for (int c = 0; c < 2; c++)
			y[c * N + i] = own[c] + share[c] * own[!c] + z[c];
	}
	free(p);
	shape_free(shape);
}

/* What a high-pass with this time constant, samples, leaves of y. */
static void high_pass(double tau, double *y)
{
	double slow = 0;

	for (int i = 0; i < N; i++) {
		slow += (y[i] - slow) / tau;
		y[i] -= slow;
	}
}

/* 1 if it could be looked for. */
static int find(const double *y, const unsigned char *const hidden[2], double share[2])
{
	const double *const x[] = { y, y + N };
	double *work = malloc(2 * N * sizeof *work);
	struct marks m[2] = { { .count = 0 }, { .count = 0 } };
	enum num_status status = work ? marks_find(y, N, 0, work, &m[0]) : NUM_MEMORY;

	if (status == NUM_OK)
		status = marks_find(y + N, N, 0, work, &m[1]);
	if (status == NUM_OK)
		status = crosstalk_find(x, hidden, N, m, share);
	marks_clear(&m[0]);
	marks_clear(&m[1]);
	free(work);
	return status == NUM_OK;
}

/* Standard error of the median of COUNT pulses of duration T whose mean square is about a
 * tenth of that of their peak. */
static int is_near(const double share[2], const double truth[2])
{
	double se = sqrt(M_PI_2 / (COUNT * 0.1 * T)) / AMPLITUDE;

	return fabs(share[0] - truth[0]) < 4 * se && fabs(share[1] - truth[1]) < 4 * se;
}

int main(void)
{
	static const double none[2] = { 0, 0 }, some[2] = { 0.02, -0.07 };
	static const unsigned char *const seen[2] = { NULL, NULL };
	double *y = malloc(2 * N * sizeof *y), share[2];
	unsigned char *flags = calloc(N, 1);
	const unsigned char *const hidden[2] = { flags, NULL };
	int looked;

	if (!y || !flags)
		return 1;
	make_record(3 * T, some, 0, y);
	looked = find(y, seen, share);
	ok(looked && is_near(share, some),
		"the share of either channel is found with its sign (%.4f, %.4f)",
		share[0], share[1]);
	make_record(3 * T, some, COUNT / 3, y);
	looked = find(y, seen, share);
	ok(looked && is_near(share, some), "shocks do not change it (%.4f, %.4f)",
		share[0], share[1]);
	for (int i = 0; i < N; i++) {
		flags[i] = y[i] > 0.5 * AMPLITUDE;
		y[i] = fmin(y[i], 0.5 * AMPLITUDE);
	}
	looked = find(y, hidden, share);
	ok(looked && share[1] == 0,
		"pulses with samples that are not known do not tell it");
	make_record(3 * T, none, 0, y);
	looked = find(y, seen, share);
	ok(looked && share[0] == 0 && share[1] == 0, "there is none in channels apart");
	make_record(0.5 * T, none, 0, y);
	looked = find(y, seen, share);
	ok(looked && share[0] == 0 && share[1] == 0,
		"nor where the pulses of both sensors overlap");
	make_record(1.5 * T, none, 0, y);
	high_pass(0.8 * T, y);
	high_pass(0.8 * T, y + N);
	looked = find(y, seen, share);
	ok(looked && share[0] == 0 && share[1] == 0,
		"nor is the tail that a high-pass leaves taken for it (%.4f, %.4f)",
		share[0], share[1]);
	free(flags);
	free(y);
	return tap_done();
}
