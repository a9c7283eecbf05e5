#include "life_table.h"
#include "cli/msg.h"
#include "common/quantile_columns.h"
#include "io/tables.h"
#include "life/score/metrics.h"
#include "num/select.h"
#include <math.h>
#include <stdlib.h>

struct lifetable {
	struct lifetable_par par;
	struct table_out *out;
	struct metrics metrics; /* with eol */
	double median;          /* of the row written last */
};

static char *column_names(const struct lifetable_par *par)
{
	if (par->samples)
		return xstrdup("t path rwl");
	return xappend(levels_columns(xstrdup("t mean"), "q", par->levels),
		" p_no_failure%s%s", par->grey ? " grey" : "",
		isnan(par->eol) ? "" : " truth error accuracy mass inside covered crps");
}

static char *column_units(const struct lifetable_par *par)
{
	char *units;

	if (par->samples)
		return xstrdup("s 1 s");
	units = xstrdup("s s");
	for (int i = 0; i < par->levels->n; i++)
		units = xappend(units, " s");
	return xappend(units, " 1%s%s", par->grey ? " s" : "",
		isnan(par->eol) ? "" : " s s 1 1 1 1 s");
}

struct lifetable *lifetable_open(const char *cmd, const struct lifetable_par *par)
{
	struct lifetable *t = xcalloc(1, sizeof *t);
	char *names = column_names(par), *units = column_units(par);

	t->par = *par;
	t->metrics = (struct metrics){ .eol = par->eol,
		.alpha = par->cone,
		.limit = isnan(par->horizon) ? 10 * par->eol : par->horizon };
	t->median = NAN;
	t->out = table_create(NULL, cmd, units, names);
	free(names);
	free(units);
	return t;
}

struct table_out *lifetable_out(struct lifetable *t)
{
	return t->out;
}

static void put_samples(
	const struct lifetable *t, double time, const struct forecast_row *row)
{
	long n = row->n == 1 && t->par.least > 1 ? t->par.least : row->n;

	for (long i = 0; i < n; i++) {
		double left = row->life[row->n == 1 ? 0 : i];

		table_put(t->out, time);
		table_put(t->out, (double)(t->par.first + i));
		table_put(t->out, left <= row->limit ? left : INFINITY);
		table_end_row(t->out);
	}
}

static double quantile(const struct forecast_row *row, double level)
{
	return row->n ? sorted_quantile(row->life, (size_t)row->n, level) : NAN;
}

static void put_scores(struct lifetable *t, double time, const struct forecast_row *row)
{
	const struct opt_list *levels = t->par.levels;
	struct metrics_row r = { .truth = t->par.eol - time,
		.error = NAN,
		.accuracy = NAN,
		.mass = NAN,
		.crps = NAN };
	int counted = row->n > 0 && metrics_add(&t->metrics, time, quantile(row, 0.5),
					    quantile(row, levels->v[0]),
					    quantile(row, levels->v[levels->n - 1]),
					    row->life, (size_t)row->n, &r) == NUM_OK;

	table_put(t->out, r.truth);
	table_put(t->out, r.error);
	table_put(t->out, r.accuracy);
	table_put(t->out, r.mass);
	table_put(t->out, counted ? (double)r.inside : NAN);
	table_put(t->out, counted ? (double)r.covered : NAN);
	table_put(t->out, r.crps);
}

static void put_summary(struct lifetable *t, double time, const struct forecast_row *row)
{
	size_t n = (size_t)row->n, failed;
	double mean;

	metric_cut(row->life, n, row->limit);
	mean = metric_mean(row->life, n, &failed);
	t->median = quantile(row, 0.5);
	table_put(t->out, time);
	table_put(t->out, mean);
	for (int i = 0; i < t->par.levels->n; i++)
		table_put(t->out, quantile(row, t->par.levels->v[i]));
	table_put(t->out, n > 0 ? (double)(n - failed) / (double)n : NAN);
	if (t->par.grey)
		table_put(t->out, row->grey);
	if (!isnan(t->par.eol))
		put_scores(t, time, row);
	table_end_row(t->out);
}

void lifetable_put(struct lifetable *t, double time, struct forecast_row row)
{
	if (t->par.samples)
		put_samples(t, time, &row);
	else
		put_summary(t, time, &row);
	table_flush(t->out);
}

double lifetable_median(const struct lifetable *t)
{
	return t->median;
}

static void write_scores(struct table_out *out, const struct metrics *m)
{
	struct metrics s = metrics_get(m);

	table_comment(out, "predictions", "%zu", s.n);
	table_comment(out, "infinite_medians", "%zu", s.infinite);
	table_comment(out, "bias", "%.6g s", s.bias);
	table_comment(out, "mean_absolute_error", "%.6g s", s.mae);
	table_comment(out, "root_mean_square_error", "%.6g s", s.rmse);
	table_comment(out, "relative_accuracy", "%.6g", s.accuracy);
	table_comment(out, "alpha_lambda", "%.6g", s.alpha_lambda);
	table_comment(out, "prognostic_horizon", "%.6g s", s.horizon);
	table_comment(out, "coverage", "%.6g", s.coverage);
	table_comment(out, "crps", "%.6g s", s.crps);
}

void lifetable_close(struct lifetable *t)
{
	if (!isnan(t->par.eol))
		write_scores(t->out, &t->metrics);
	table_done(t->out);
	free(t);
}
