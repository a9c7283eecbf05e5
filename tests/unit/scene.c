/* Arrivals, drawn particles and the signal made piece by piece. */
#include "signal/simulate/scene.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

static const struct stream oil = { 7, 0, { 0.01, 1e-3, PIPE_LAMINAR, 7 }, 0.25,
	{ 1e-4, 4e-4 }, { 50e-6, 150e-6 }, 0 };

static int all(const struct arrivals_par *par, double *time)
{
	struct arrivals *a = arrivals_new(par);
	int n = 0;

	while (arrivals_next(a, &time[n]))
		n++;
	arrivals_free(a);
	return n;
}

static void test_bursts(void)
{
	static double t[20000];
	struct arrivals_par par = { 1, 0, 0, 20000, 4, 0.5, 1, 0.3, 0.05 };
	int n = all(&par, t), bad = 0;
	double mean[4] = { 0 };

	for (int i = 0; i < n; i++) {
		double x = t[i] - 0.5 - i / 4;

		bad += x < 0 || x > 0.3 || (i % 4 && t[i] - t[i - 1] < 0.05 - 1e-12);
		mean[i % 4] += x / (n / 4);
	}
	ok(n == 20000 && !bad,
		"bursts are within their span and never closer than the gap");
	/* k-th smallest of four on [0, 0.15], and k gaps; standard error 0.0005 */
	for (int k = 0; k < 4; k++)
		near(mean[k], 0.15 * (k + 1) / 5 + 0.05 * k, 0.002,
			"the mean place in the burst is its middle");
	par.number = 10;
	n = all(&par, t);
	ok(n == 10 && t[9] < 2.8 + 1e-12, "a last burst may be incomplete");
	par = (struct arrivals_par){ 1, 0, 0, 5, 0, 1, 0, 0.4, 0.1 };
	all(&par, t);
	near(t[4] - t[0], 0.4, 1e-15,
		"without freedom particles are exactly one gap apart");
	near(t[0], 1, 1e-15, "without freedom the first particle is at the start");
}

static void test_poisson(void)
{
	static double t[4000];
	double sum = 0, square = 0;
	int closest = 0;

	for (uint32_t r = 0; r < 2000; r++) {
		struct arrivals_par par = { 1, r, 50, UINT64_MAX, 0, 0, 0, 2, 0 };
		int n = all(&par, t);

		sum += n;
		square += (double)n * n;
	}
	/* mean = variance = 100; standard errors 0.22 and 3.2 */
	near(sum / 2000, 100, 0.9, "Poisson: the mean number is right");
	near(square / 2000 - sum * sum / 4e6, 100, 13,
		"Poisson: the variance of the number is right");
	for (uint32_t r = 0; r < 200; r++) {
		struct arrivals_par par = { 1, r, 50, UINT64_MAX, 0, 0, 0, 2, 0.015 };
		int n = all(&par, t);

		for (int i = 1; i < n; i++)
			closest += t[i] - t[i - 1] < 0.015 - 1e-12;
	}
	ok(closest == 0, "Poisson: the gap is a dead time");
}

static void test_draws(void)
{
	double mean = 0, cube = 0;
	int bad = 0;

	for (uint64_t i = 0; i < 20000; i++) {
		struct passage p = { .time = { 1 } };
		double wall;

		passage_draw(&oil, i, &p);
		wall = 0.005 - p.radius;
		bad += p.diameter < 50e-6 || p.diameter > 150e-6 ||
		       wall < passage_clearance(&oil, p.diameter) ||
		       p.velocity < passage_slowest(&oil) ||
		       fabs((p.time[1] - 1) * p.velocity / 0.25 - 1) > 1e-12;
		mean += p.diameter / 20000;
		cube += pow(p.diameter / 1e-4, 3) / 20000;
	}
	ok(!bad,
		"drawn particles are within their ranges, and the transit follows from the spacing");
	near(mean, 100e-6, 1e-6, "the mean diameter is right");
	near(cube, 1.25, 0.03, "the mean volume of diameters from 0.5 to 1.5 is right");
}

/* One scene in pieces of a given size. */
static void render(size_t piece, size_t n, double *x)
{
	struct scene_par par = { .rate = 1e4,
		.shape = PULSE_GAUSS,
		.length = 0.127,
		.kappa = 7.85e10,
		.gain = 0.9,
		.seed = 3,
		.noise = 0.1,
		.corner = 300,
		.common = 0.3,
		.drift = 0.2,
		.drift_time = 0.02,
		.nlines = 2,
		.line = { 50, 4321 },
		.line_level = { 0.3, 0.1 } };
	struct scene *s = scene_new(&par);

	for (uint64_t i = 0; i < 40; i++) {
		struct passage p = { .time = { 0.01 * (double)i } };

		passage_draw(&oil, i, &p);
		scene_pass(s, &p);
	}
	for (size_t i = 0; i < n; i += piece)
		scene_next(s, x + 2 * i, piece < n - i ? piece : n - i);
	scene_free(s);
}

static void test_pieces(void)
{
	static double whole[2 * 5000], x[2 * 5000];
	static const size_t piece[] = { 1, 7, 256, 4096 };

	render(5000, 5000, whole);
	for (size_t k = 0; k < 4; k++) {
		double worst = 0;

		render(piece[k], 5000, x);
		for (size_t i = 0; i < 2 * 5000; i++)
			worst = tap_max(worst, fabs(x[i] - whole[i]));
		ok(worst < 2e-13, "pieces of %zu frames give the same signal (%.1g)",
			piece[k], worst);
	}
}

static void test_memory(void)
{
	struct scene_par par = { .rate = 1e4,
		.shape = PULSE_SINE,
		.length = 0.127,
		.kappa = 7.85e10,
		.gain = 1 };
	struct scene *s = scene_new(&par);
	double x[2 * 100], energy = 0;
	size_t most = 0;

	for (int i = 0; i < 1000; i++) {
		struct passage p = { { 0.01 * i + 0.006, 0.01 * i + 0.026 }, 1e-4, 0,
			12.7, { 1, 0 } };

		scene_pass(s, &p);
		scene_next(s, x, 100);
		most = scene_pending(s) > most ? scene_pending(s) : most;
		for (int k = 0; k < 200; k++)
			energy += x[k] * x[k];
	}
	ok(most <= 4, "particles that have passed are forgotten (%zu held)", most);
	/* one sine period of 100 samples and amplitude kappa v d^3: half the square times
	 * 100, at two sensors; the last particles are still on their way */
	near(energy / 1000 / 100 / pow(7.85e10 * 12.7e-12, 2), 1, 0.005,
		"the energy of the pulses is right");
	near(scene_end(s), 9.99 + 0.026 + 0.005, 1e-9,
		"the end of the last pulse is right");
	scene_free(s);
}

int main(void)
{
	test_bursts();
	test_poisson();
	test_draws();
	test_pieces();
	test_memory();
	return tap_done();
}
