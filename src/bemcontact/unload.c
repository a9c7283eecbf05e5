#include "cli/msg.h"
#include "contact/flow.h"
#include "tables.h"
#include "task.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static long steps;

struct opt unload_rows[] = {
	{ 0, "unload", OPT_INT, UNIT_COUNT, &steps, 0, 1e6, "N",
		"take the load off in N equal steps, each a row of --table", 0, 0 },
	OPT_END,
};

int unload_wanted(void)
{
	return steps > 0;
}

/* Unloads the plastically deformed surface completely. */
static int take_off(
	const struct task *t, const struct contact_result *full, const double *height)
{
	size_t n = (size_t)t->par.nx * (size_t)t->par.ny;
	double *p = xcalloc(n, sizeof *p);
	int converged = 1;

	memcpy(p, t->p, n * sizeof *p);
	for (long k = steps - 1; k >= 0; k--) {
		enum contact_status status = press_to(t, height, CONTACT_PRESSURE,
			full->pressure * (double)k / (double)steps, p, NULL);
		struct contact_result found = *contact_result(t->c);

		count_work(&found, 1);
		converged &= status == CONTACT_OK;
		put_row(t, height, &found, p, status == CONTACT_OK, 0);
	}
	free(p);
	return converged;
}

int unload_solve(
	const struct task *t, const struct contact_result *full, double *residual)
{
	size_t n = (size_t)t->par.nx * (size_t)t->par.ny;
	double *height = residual, hardness = t->par.hardness;
	struct contact_flow flow;
	int converged = 1;

	if (!residual && steps == 0)
		return 1;
	if (!(hardness > 0))
		hardness = INFINITY;
	if (!residual)
		height = xcalloc(n, sizeof *height);
	flow = contact_unloaded(n, t->h, t->p, t->gap, hardness, height);
	record_set(t->r, "flow_depth", "%.17g", flow.depth);
	record_set(t->r, "flow_volume", "%.17g", flow.sum * t->par.dx * t->par.dy);
	if (steps > 0)
		converged = take_off(t, full, height);
	if (!residual)
		free(height);
	return converged;
}
