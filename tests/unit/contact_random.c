/* Random problems, most of them small and odd: the preconditioned solver must solve
 * them all, to the energy that Polonsky and Keer's finds. */
#include "contact/solver.h"
#include "num/fft.h"
#include "num/philox.h"
#include "tap.h"
#include <stdlib.h>

enum { PROBLEMS = 600 };

/* Uniform in (0, 1), a function of problem and place. */
static double draw(int problem, uint64_t place)
{
	return philox_uniform(1, (uint32_t)problem, RNG_NOISE, place);
}

static double range(int problem, uint64_t place, double low, double high)
{
	return low * pow(high / low, draw(problem, place));
}

/* Noise, waves, a paraboloid, spikes, or a rough wave. */
static double height(int problem, int kind, int nx, int ny, int x, int y)
{
	double u = draw(problem, 1000 + (uint64_t)(y * nx + x));

	switch (kind) {
	case 0:
		return u;
	case 1:
		return sin(x * 0.3 + 0.1) * cos(y * 0.2);
	case 2:
		return -(pow(x - nx / 2.0, 2) + pow(y - ny / 2.0, 2)) /
		       (nx * nx + ny * ny);
	case 3:
		return u < 0.1;
	default:
		return cos(x * 0.5) * cos(y * 0.4) + 0.3 * u;
	}
}

struct outcome {
	int solved, compared;
	double worst; /* relative difference in energy */
	long iterations;
};

static void solve_one(int k, struct outcome *o)
{
	struct contact_par par = { .nx = (int)range(k, 1, 1, 50),
		.ny = (int)range(k, 2, 1, 50),
		.dx = range(k, 3, 1e-8, 1e-4),
		.estar = range(k, 4, 1e6, 1e12),
		.boundary = draw(k, 5) < 0.5 ? CONTACT_FREE : CONTACT_PERIODIC,
		.tolerance = 1e-9,
		.max_iterations = 3000 };
	size_t n = (size_t)par.nx * (size_t)par.ny;
	double amplitude = range(k, 6, 1e-9, 1e-1), energy;
	double mean = par.estar * amplitude / par.dx * range(k, 7, 1e-6, 3);
	double *h = fft_alloc(n), *p = fft_alloc(n), *q = fft_alloc(n);
	struct contact *c;

	par.dy = par.dx * range(k, 8, 0.3, 3);
	if (draw(k, 9) < 0.4)
		par.hardness = mean * (1 + range(k, 10, 1e-3, 100));
	for (int y = 0; y < par.ny; y++)
		for (int x = 0; x < par.nx; x++)
			h[y * par.nx + x] = amplitude * height(k, (int)(5 * draw(k, 11)),
								par.nx, par.ny, x, y);
	c = contact_new(&par);
	if (contact_solve(c, h, CONTACT_PRESSURE, mean, p, NULL) == CONTACT_OK)
		o->solved++;
	else
		printf("# problem %d: %dx%d, optimality gap %g after %ld iterations\n", k,
			par.nx, par.ny, contact_result(c)->optimality_gap,
			contact_result(c)->iterations);
	energy = contact_result(c)->energy;
	o->iterations += contact_result(c)->iterations;
	contact_free(c);
	if (par.hardness == 0) {
		par.solver = CONTACT_PK;
		c = contact_new(&par);
		if (contact_solve(c, h, CONTACT_PRESSURE, mean, q, NULL) == CONTACT_OK) {
			double difference = fabs(energy / contact_result(c)->energy - 1);

			o->compared++;
			/* Full periodic contact of equal heights has no energy at all. */
			if (contact_result(c)->energy > 1e-12 * mean * amplitude)
				o->worst = tap_max(o->worst, difference);
		}
		contact_free(c);
	}
	fft_free(h);
	fft_free(p);
	fft_free(q);
}

int main(void)
{
	struct outcome o = { 0 };

	for (int k = 0; k < PROBLEMS; k++)
		solve_one(k, &o);
	ok(o.solved == PROBLEMS,
		"%d of %d random problems are solved in %.1f iterations on average",
		o.solved, PROBLEMS, (double)o.iterations / PROBLEMS);
	ok(o.compared > PROBLEMS / 2 && o.worst < 1e-6,
		"both solvers find the same energy in %d problems, to %.1e", o.compared,
		o.worst);
	return tap_done();
}
