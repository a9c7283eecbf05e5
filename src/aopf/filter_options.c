#include "filter_options.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include <float.h>
#include <math.h>

static const char *const orders[] = { "window", "insample", NULL };

struct filtering filtering = { .particles = 300, .seed = 1 };

static struct opt_choice order = { ORDER_WINDOW, 0 };
static double share = 0.5, process = NAN, noise = NAN;
static long largest = 60;

struct opt filtering_rows[] = { OPT_HEADING("Particle filter"),
	{ 0, "order", OPT_CHOICE, UNIT_COUNT, &order, 4, 1000, "N|window|insample",
		"order of the grey model, or the rule that selects it", orders, 0 },
	{ 0, "max-order", OPT_INT, UNIT_COUNT, &largest, 4, 1000, "N",
		"largest order that may be chosen", NULL, 0 },
	{ 0, "particles", OPT_INT, UNIT_COUNT, &filtering.particles, 1, 1e7, "N",
		"number of particles", NULL, 0 },
	{ 0, "ess", OPT_NUM, UNIT_FRACTION, &share, 0, 1, "X",
		"resample below this effective sample size, as a fraction; 1: always",
		NULL, 0 },
	{ 0, "sigma-u", OPT_NUM, UNIT_NONE, &process, 0, DBL_MAX, "SD",
		"process noise per row, in units of y (default from forecast errors)",
		NULL, 0 },
	{ 0, "sigma-v", OPT_NUM, UNIT_NONE, &noise, 0, DBL_MAX, "SD",
		"observation noise, in units of y (default from second differences)",
		NULL, 0 },
	OPT_END };

struct adaptive *filtering_new(int unit)
{
	struct adaptive_par par = {
		.filter = { (size_t)filtering.particles, 0, share },
		.order = { order.word < 0 ? ORDER_FIXED : (enum order_rule)order.word,
			order.word < 0 ? (int)order.value : (int)largest },
		.process = process,
		.noise = noise,
		.seed = (uint64_t)filtering.seed,
		.realisation = (uint32_t)unit,
	};
	struct adaptive *a = adaptive_new(&par);

	if (!a)
		die(EXIT_RUN, "no memory for %ld particles", filtering.particles);
	return a;
}

void filtering_count(const struct adaptive *a)
{
	struct adaptive_counts c = adaptive_counts(a);

	stats_add("resamplings", (double)c.resamplings);
	stats_add("outliers", (double)c.outliers);
	stats_add("restarts", (double)c.restarts);
	stats_add("orders", (double)c.order.tried);
	stats_add("order_changes", (double)c.order.changes);
}
