#include "reports.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "io/tables.h"
#include "stats/estimates.h"
#include <math.h>

static _Noreturn void no_memory(void)
{
	die(EXIT_RUN, "out of memory");
}

void report_end(struct table_out *t, const struct report_par *par)
{
	if (par->doubt)
		table_comment(t, "doubtful", "%s", par->doubt);
	table_done(t);
}

static void put_quantity(
	struct table_out *t, const char *name, const char *unit, struct estimate e)
{
	table_put_text(t, name);
	table_put(t, e.value);
	table_put(t, e.low);
	table_put(t, e.high);
	table_put_text(t, unit);
	table_end_row(t);
}

/* Names of enum estimate_quantity. */
static const char *const names[] = { "weibull_shape", "weibull_scale", "weibull_mean",
	"ks_distance", "mean_diameter", "power_factor", "power_exponent", "power_offset",
	"volume_per_step" };
static const char *const units[] = { "1", "m", "m", "1", "m", "1", "1", "1", "m3" };

void report_fits(const struct report_par *par, const struct ensemble *e)
{
	static const char *const counts[] = { "realisations", "steps", "particles" };
	const struct ensemble_par *of = ensemble_par(e);
	struct table_out *t = table_create(
		NULL, par->cmd, "1 unit unit unit 1", "quantity value low high unit");
	struct estimate out[ESTIMATES];

	if (estimate_all(e, out) ||
		(par->bootstrap && estimate_bootstrap(e, par->seed, par->bootstrap, out)))
		no_memory();
	if (par->bootstrap)
		stats_add("draws", (double)par->bootstrap);
	double count[] = { of->realisations, (double)(of->last - of->first + 1),
		ensemble_diameter(e)->n };
	for (int k = 0; k < 3; k++)
		put_quantity(t, counts[k], "1", (struct estimate){ count[k], NAN, NAN });
	for (int q = 0; q < ESTIMATES; q++)
		put_quantity(t, names[q], units[q], out[q]);
	report_end(t, par);
}

static void put_contrast(struct table_out *t, const char *name, const double value[2],
	const struct estimate_contrast *c, const char *unit)
{
	table_put_text(t, name);
	table_put(t, value[0]);
	table_put(t, value[1]);
	table_put(t, c->difference.value);
	table_put(t, c->difference.low);
	table_put(t, c->difference.high);
	table_put(t, c->ratio.value);
	table_put(t, c->ratio.low);
	table_put(t, c->ratio.high);
	table_put(t, c->realisations);
	table_put_text(t, unit);
	table_end_row(t);
}

/* Sliding distance, or number of steps, in which --depth is worn off the nominal area;
 * where the area is not known, life only has a ratio, that at equal areas and steps. */
static void put_life(struct table_out *t, const struct report_par *par,
	const struct study study[2], const double volume[2], const double log_error[2],
	const double n[2])
{
	int areas = study[0].area > 0 && study[1].area > 0;
	int distances = areas && study[0].distance > 0 && study[1].distance > 0;
	double life[2], error[2];
	struct estimate_contrast c;

	for (int i = 0; i < 2; i++) {
		life[i] = par->depth * (areas ? study[i].area : 1) / volume[i];
		life[i] *= distances ? study[i].distance : 1;
		error[i] = life[i] * log_error[i];
	}
	c = estimate_compare(life, error, log_error, n, par->confidence);
	if (!areas) {
		c.difference = (struct estimate){ NAN, NAN, NAN };
		life[0] = life[1] = NAN;
	}
	put_contrast(t, "life", life, &c, distances ? "m" : "1");
}

void report_comparison(const struct report_par *par, const struct study study[2])
{
	static const int shown[] = { ESTIMATE_VOLUME_STEP, ESTIMATE_MEAN_DIAMETER,
		ESTIMATE_SHAPE, ESTIMATE_SCALE, ESTIMATE_WEIBULL_MEAN };
	struct table_out *t = table_create(NULL, par->cmd,
		"1 unit unit unit unit unit 1 1 1 1 1",
		"quantity value other difference difference_low difference_high ratio "
		"ratio_low ratio_high realisations unit");
	double error[2][ESTIMATES], log_error[2][ESTIMATES], n[2];
	struct estimate value[2][ESTIMATES];
	const int worn = ESTIMATE_VOLUME_STEP;

	for (int i = 0; i < 2; i++) {
		const struct ensemble *e = study[i].particles;

		n[i] = ensemble_par(e)->realisations;
		if (n[i] < 2)
			die(EXIT_RUN,
				"--compare requires at least two realisations of each study, got %g",
				n[i]);
		if (estimate_all(e, value[i]) ||
			estimate_errors(e, par->seed + (uint64_t)i, par->bootstrap,
				value[i], error[i], log_error[i]))
			no_memory();
	}
	for (size_t k = 0; k < sizeof shown / sizeof *shown; k++) {
		int q = shown[k];
		double v[] = { value[0][q].value, value[1][q].value };
		struct estimate_contrast c =
			estimate_compare(v, (double[]){ error[0][q], error[1][q] },
				(double[]){ log_error[0][q], log_error[1][q] }, n,
				par->confidence);

		put_contrast(t, names[q], v, &c, units[q]);
	}
	put_life(t, par, study, (double[]){ value[0][worn].value, value[1][worn].value },
		(double[]){ log_error[0][worn], log_error[1][worn] }, n);
	report_end(t, par);
}

static double mean(const struct running *t)
{
	return t->n > 0 ? t->mean : NAN;
}

void report_steps(const struct report_par *par, const struct ensemble *e)
{
	struct table_out *t = table_create(NULL, par->cmd, "1 1 1 1 1 m3 m3 m3 m3 m 1 m",
		"step realisations particles particles_sd cumulative_particles volume "
		"volume_sd cumulative_volume cumulative_volume_sd mean_diameter "
		"weibull_shape weibull_scale");
	const struct ensemble_par *of = ensemble_par(e);

	for (long s = of->first; s <= of->last; s++) {
		const struct ensemble_step *o = ensemble_step(e, s);
		const struct sketch *x = ensemble_step_diameters(e, s);
		struct running diameter = { 0 };
		struct weibull w = { { NAN, NAN, NAN }, { NAN, NAN, NAN }, NAN, 0, 0 };

		if (estimate_weibull(e, x, &w) == WEIBULL_MEMORY)
			no_memory();
		for (size_t i = 0; i < x->n; i++)
			running_repeat(&diameter, x->value[i], x->weight[i]);
		table_put_row(t,
			(double[]){ (double)s, o->count.n, mean(&o->count),
				sqrt(running_variance(&o->count)), o->total_count,
				mean(&o->volume), sqrt(running_variance(&o->volume)),
				mean(&o->total_volume),
				sqrt(running_variance(&o->total_volume)), mean(&diameter),
				w.shape.value, w.scale.value },
			12);
	}
	report_end(t, par);
}
