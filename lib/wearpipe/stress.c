#include "stress/stress.h"
#include "num/pool.h"
#include "report.h"
#include "stress/stress_kernel.h"
#include <math.h>
#include <stdlib.h>
#include <wearpipe/stress.h>

struct wp_stress {
	struct pool *pool;
	struct stress *stress;
	size_t cells;
	double *tensor;
	int loaded;
};

struct wp_stress *wp_stress_new(const struct wp_stress_par *par, enum wp_status *status)
{
	struct stress_par wanted = { .nx = par->nx,
		.ny = par->ny,
		.dx = par->dx,
		.dy = par->dy,
		.nu = par->poisson,
		.mu = par->friction,
		.periodic = par->periodic };
	struct wp_stress *s;
	enum wp_status why;

	if (par->threads < 1)
		return report(status, WP_DOMAIN);
	s = calloc(1, sizeof *s);
	if (!s)
		return report(status, WP_NO_MEMORY);
	s->pool = wanted.pool = pool_new(par->threads);
	s->stress = s->pool ? stress_new(&wanted) : NULL;
	if (!s->stress) {
		why = s->pool ? status_of_errno() : WP_NO_MEMORY;
		wp_stress_free(s);
		return report(status, why);
	}
	s->cells = (size_t)par->nx * (size_t)par->ny;
	report(status, WP_OK);
	return s;
}

void wp_stress_free(struct wp_stress *s)
{
	if (!s)
		return;
	stress_free(s->stress);
	pool_free(s->pool);
	free(s->tensor);
	free(s);
}

enum wp_status wp_stress_load(struct wp_stress *s, const double *pressure)
{
	s->loaded = 0;
	for (size_t i = 0; i < s->cells; i++)
		if (!isfinite(pressure[i]))
			return WP_NUMBERS;
	if (stress_load(s->stress, pressure))
		return WP_NUMBERS;
	s->loaded = 1;
	return WP_OK;
}

enum wp_status wp_stress_tensor(struct wp_stress *s, double depth, double *tensor)
{
	if (!s->loaded || !(depth >= 0) || !isfinite(depth))
		return WP_DOMAIN;
	return stress_tensor(s->stress, depth, tensor) ? WP_NO_MEMORY : WP_OK;
}

enum wp_status wp_stress_mises(struct wp_stress *s, double depth, double *mises)
{
	enum wp_status status;

	if (!s->tensor)
		s->tensor = malloc(STRESS_COMPONENTS * s->cells * sizeof *s->tensor);
	if (!s->tensor)
		return WP_NO_MEMORY;
	status = wp_stress_tensor(s, depth, s->tensor);
	if (status != WP_OK)
		return status;
	for (size_t i = 0; i < s->cells; i++) {
		double t[STRESS_COMPONENTS];

		for (size_t c = 0; c < STRESS_COMPONENTS; c++)
			t[c] = s->tensor[c * s->cells + i];
		mises[i] = stress_von_mises(t);
	}
	return WP_OK;
}
