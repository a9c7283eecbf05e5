/* debrisstat - statistics of wear particles: fits, steps, sizes, shapes */
#include "contact/statistics.h"
#include "num/rng.h"
#include "shell/msg.h"
#include "shell/opt.h"
#include "shell/stats.h"
#include "shell/tables.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum output { FITS, STEPS, SIZES, ASPECTS };
static const char *const outputs[] = { "fits", "steps", "sizes", "aspects", NULL };
static const char *const growths[] = { "cumulative", "step", NULL };

static int output, growth, truncated;
static struct opt_list diameters = { 2, { 0, INFINITY } }, range;
static struct opt_list edges = { 8, { 1, 1.25, 1.5, 2, 3, 5, 8, 13 } };
static double bin = 10e-6, confidence = 0.95;
static long realisations, bootstrap, seed = 1;
static const char *summary_path;

static const struct opt opts[] = { { 'o', "output", OPT_WORD, UNIT_NONE, &output, 0, 0,
					   "fits|steps|sizes|aspects", "what to print",
					   outputs, 0 },
	{ 'd', "diameter", OPT_LIST, UNIT_LENGTH, &diameters, 0, 1e30, "LO:HI",
		"only particles of this equivalent diameter", NULL, 0 },
	{ 't', "truncated", OPT_FLAG, UNIT_NONE, &truncated, 0, 0, NULL,
		"fit the Weibull distribution as cut off at --diameter", NULL, 0 },
	{ 'p', "step", OPT_LIST, UNIT_COUNT, &range, 1, 1e9, "A[:B]",
		"only these steps; default all", NULL, 0 },
	{ 'g', "growth", OPT_WORD, UNIT_NONE, &growth, 0, 0, "cumulative|step",
		"what the power law follows: all particles so far, or those of a step",
		growths, 0 },
	{ 'b', "bin", OPT_NUM, UNIT_LENGTH, &bin, 1e-30, 1e30, "W",
		"width of the classes of sizes", NULL, 0 },
	{ 'a', "aspects", OPT_LIST, UNIT_NONE, &edges, 1, 1e9, "A,A,...",
		"edges of the classes of aspect ratio", NULL, 0 },
	{ 'C', "confidence", OPT_NUM, UNIT_FRACTION, &confidence, 0.01, 0.9999, "C",
		"of the intervals", NULL, 0 },
	{ 'B', "bootstrap", OPT_INT, UNIT_COUNT, &bootstrap, 0, 1e6, "N",
		"intervals by drawing the realisations N times anew", NULL, 0 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e15, "N", "of --bootstrap", NULL,
		0 },
	{ 'n', "realisations", OPT_INT, UNIT_COUNT, &realisations, 0, 1e9, "N",
		"realisations there were, with those that gave no particle", NULL, 0 },
	{ 'U', "summary", OPT_TEXT, UNIT_NONE, &summary_path, 0, 0, "FILE",
		"summary of debrisgen, to know of steps without particles", NULL, 0 },
	OPT_END };

static const struct prog prog = { "debrisstat",
	"Fit and count the wear particles of an ensemble.", "[file]",
	"table: realisation, step, volume, diameter, aspect", "table", opts };

struct row {
	long realisation, step;
	double diameter, volume, aspect;
};

/* One step of one realisation. */
struct cell {
	int there;
	size_t begin, end; /* rows */
	double volume;
};

struct data {
	struct row *row;
	size_t rows, room;
	long *id; /* realisations, ascending */
	size_t ids, id_room;
	long first, last;  /* steps counted */
	long steps;        /* up to the last */
	size_t all;        /* realisations, with those without a row */
	struct cell *cell; /* [realisation * steps + step - 1] */
};

static int by_realisation(const void *a, const void *b)
{
	const struct row *p = a, *q = b;

	if (p->realisation != q->realisation)
		return p->realisation < q->realisation ? -1 : 1;
	return (p->step > q->step) - (p->step < q->step);
}

static int ascending(const void *a, const void *b)
{
	long p = *(const long *)a, q = *(const long *)b;

	return (p > q) - (p < q);
}

static void note_realisation(struct data *d, long id)
{
	if (d->ids && d->id[d->ids - 1] == id)
		return;
	if (d->ids == d->id_room) {
		d->id_room = d->id_room ? 2 * d->id_room : 64;
		d->id = xrealloc(d->id, d->id_room, sizeof(*d->id));
	}
	d->id[d->ids++] = id;
}

static double positive(struct table_in *t, int column)
{
	double v = table_number(t, column);

	if (!(v > 0) || !isfinite(v))
		die(EXIT_RUN, "%s: line %ld: %s is %g, want a positive number",
			table_name(t), table_line(t), table_column_name(t, column), v);
	return v;
}

static long whole(struct table_in *t, int column, double least)
{
	double v = table_number(t, column);

	if (!(v >= least) || v > 1e9 || v != floor(v))
		die(EXIT_RUN, "%s: line %ld: %s is %g, want a whole number from %g on",
			table_name(t), table_line(t), table_column_name(t, column), v,
			least);
	return (long)v;
}

static void read_particles(struct data *d, const char *path, char **cmd)
{
	struct table_in *t = table_open(path);
	int more = table_next(t);
	int cr, cs, cd, cv, ca;

	*cmd = opt_cmd(table_key(t, "cmd"), NULL);
	if (table_columns(t) == 0)
		die(EXIT_RUN, "%s: no table", table_name(t));
	cr = table_need(t, "realisation");
	cs = table_need(t, "step");
	cd = table_need(t, "diameter");
	cv = table_need(t, "volume");
	ca = table_need(t, "aspect");
	for (; more; more = table_next(t)) {
		struct row r = { whole(t, cr, 0), whole(t, cs, 1), positive(t, cd),
			positive(t, cv), positive(t, ca) };

		if (d->rows == d->room) {
			d->room = d->room ? 2 * d->room : 1024;
			d->row = xrealloc(d->row, d->room, sizeof(*d->row));
		}
		d->row[d->rows++] = r;
		note_realisation(d, r.realisation);
		d->steps = r.step > d->steps ? r.step : d->steps;
	}
	table_close(t);
}

static void sort_ids(struct data *d)
{
	size_t kept = 0;

	if (d->ids)
		qsort(d->id, d->ids, sizeof(*d->id), ascending);
	for (size_t i = 0; i < d->ids; i++)
		if (kept == 0 || d->id[kept - 1] != d->id[i])
			d->id[kept++] = d->id[i];
	d->ids = kept;
}

/* Place of a realisation that has been noted. */
static size_t place_of(const struct data *d, long id)
{
	size_t low = 0, high = d->ids;

	while (high - low > 1) {
		size_t middle = low + (high - low) / 2;

		if (d->id[middle] <= id)
			low = middle;
		else
			high = middle;
	}
	return low;
}

/* Reads the summary twice: for its size, then for the steps that took place. */
static void read_summary(struct data *d, int mark)
{
	struct table_in *t = table_open(summary_path);
	int more = table_next(t), cr = table_need(t, "realisation");
	int cs = table_need(t, "step");

	for (; more; more = table_next(t)) {
		long id = whole(t, cr, 0), step = whole(t, cs, 1);

		if (mark)
			d->cell[place_of(d, id) * d->steps + step - 1].there = 1;
		else
			note_realisation(d, id);
		d->steps = step > d->steps ? step : d->steps;
	}
	table_close(t);
}

static void arrange(struct data *d)
{
	size_t n;

	if (summary_path)
		read_summary(d, 0);
	sort_ids(d);
	if (realisations && (size_t)realisations < d->ids)
		die(EXIT_RUN, "--realisations %ld, but the table has %zu", realisations,
			d->ids);
	if (bootstrap && d->ids < 2)
		die(EXIT_RUN, "--bootstrap wants at least two realisations, got %zu",
			d->ids);
	d->all = realisations ? (size_t)realisations : d->ids;
	d->first = range.n > 0 ? (long)range.v[0] : 1;
	d->last = range.n > 1 ? (long)range.v[1] : range.n ? d->first : d->steps;
	if (d->last > d->steps)
		d->steps = d->last;
	n = d->all * (size_t)d->steps;
	d->cell = xcalloc(n + 1, sizeof(*d->cell));
	if (summary_path)
		read_summary(d, 1);
	if (d->rows)
		qsort(d->row, d->rows, sizeof(*d->row), by_realisation);
	for (size_t i = 0; i < d->rows; i++) {
		const struct row *r = &d->row[i];
		struct cell *c =
			&d->cell[place_of(d, r->realisation) * d->steps + r->step - 1];

		if (c->end == c->begin)
			c->begin = i;
		c->end = i + 1;
		c->there = 1;
		c->volume += r->volume;
	}
	for (size_t i = 0; !summary_path && i < n; i++)
		d->cell[i].there = 1;
}

static int counted(const struct row *r)
{
	return r->diameter >= diameters.v[0] && r->diameter <= diameters.v[1];
}

static const struct cell *cell_at(const struct data *d, size_t realisation, long step)
{
	return &d->cell[realisation * (size_t)d->steps + (size_t)(step - 1)];
}

static double count_cell(const struct data *d, const struct cell *c)
{
	double n = 0;

	for (size_t i = c->begin; i < c->end; i++)
		n += counted(&d->row[i]);
	return n;
}

/* Fits */

enum quantity {
	SHAPE,
	SCALE,
	WEIBULL_MEAN,
	KS,
	MEAN_DIAMETER,
	FACTOR,
	EXPONENT,
	OFFSET,
	VOLUME_STEP,
	QUANTITIES
};
static const char *const quantity_names[] = { "weibull_shape", "weibull_scale",
	"weibull_mean", "ks_distance", "mean_diameter", "power_factor", "power_exponent",
	"power_offset", "volume_per_step" };

/* Diameters of the realisations picked; the caller frees. */
static double *pick_diameters(
	const struct data *d, const size_t *pick, size_t picks, size_t *count)
{
	size_t room = 64, n = 0;
	double *x = xcalloc(room, sizeof(*x));

	for (size_t i = 0; i < picks; i++)
		for (long s = d->first; s <= d->last; s++) {
			const struct cell *c = cell_at(d, pick[i], s);

			for (size_t k = c->begin; k < c->end; k++) {
				if (!counted(&d->row[k]))
					continue;
				if (n == room) {
					room *= 2;
					x = xrealloc(x, room, sizeof(*x));
				}
				x[n++] = d->row[k].diameter;
			}
		}
	*count = n;
	return x;
}

static int fit_diameters(const double *x, size_t n, struct weibull *w)
{
	return weibull_fit(x, n, truncated ? diameters.v[0] : 0,
		truncated ? diameters.v[1] : INFINITY, confidence, w);
}

static void estimate_growth(const struct data *d, const size_t *pick, size_t picks,
	struct estimate out[QUANTITIES])
{
	size_t n = (size_t)(d->last - d->first + 1), used = 0;
	double *x = xcalloc(2 * n + 1, sizeof(*x)), *y = x + n, sum = 0;
	struct power p;

	for (long s = 1; s <= d->last; s++) {
		sum = growth ? 0 : sum;
		for (size_t i = 0; i < picks; i++)
			sum += count_cell(d, cell_at(d, pick[i], s));
		if (s < d->first)
			continue;
		x[used] = (double)s;
		y[used++] = sum;
	}
	if (power_fit(x, y, n, confidence, &p) == 0) {
		out[FACTOR] = p.factor;
		out[EXPONENT] = p.exponent;
		out[OFFSET] = p.offset;
	}
	free(x);
}

/* Mean over realisations of the mean over their steps. */
static void estimate_volume(const struct data *d, const size_t *pick, size_t picks,
	struct estimate out[QUANTITIES])
{
	double *v = xcalloc(picks + 1, sizeof(*v)), deviation;
	size_t n = 0;

	for (size_t i = 0; i < picks; i++) {
		double sum = 0, steps = 0;

		for (long s = d->first; s <= d->last; s++) {
			sum += cell_at(d, pick[i], s)->volume;
			steps += cell_at(d, pick[i], s)->there;
		}
		if (steps > 0)
			v[n++] = sum / steps;
	}
	out[VOLUME_STEP] = sample_mean(v, n, confidence, &deviation);
	free(v);
}

/* The distance is left out of draws: it has no interval. */
static void estimate_all(const struct data *d, const size_t *pick, size_t picks,
	int distance, struct estimate out[QUANTITIES])
{
	struct weibull w;
	double deviation, *x;
	size_t n;

	for (int q = 0; q < QUANTITIES; q++)
		out[q] = (struct estimate){ NAN, NAN, NAN };
	x = pick_diameters(d, pick, picks, &n);
	if (n > 0)
		out[MEAN_DIAMETER] = sample_mean(x, n, confidence, &deviation);
	if (fit_diameters(x, n, &w) == 0) {
		out[SHAPE] = w.shape;
		out[SCALE] = w.scale;
		out[WEIBULL_MEAN].value = w.mean;
		if (distance)
			out[KS].value = weibull_distance(&w, x, n);
	}
	free(x);
	if (d->last >= d->first)
		estimate_growth(d, pick, picks, out);
	estimate_volume(d, pick, picks, out);
}

/* Particles of one surface hang together, so whole realisations are drawn. */
static void resample(const struct data *d, struct estimate out[QUANTITIES])
{
	double *draw = xcalloc((size_t)bootstrap * QUANTITIES, sizeof(*draw));
	size_t *pick = xcalloc(d->all + 1, sizeof(*pick));

	for (long b = 0; b < bootstrap; b++) {
		struct estimate e[QUANTITIES];

		for (size_t i = 0; i < d->all; i++)
			pick[i] = (size_t)(philox_uniform((uint64_t)seed, (uint32_t)b,
						   RNG_BOOTSTRAP, i) *
					   (double)d->all);
		estimate_all(d, pick, d->all, 0, e);
		for (int q = 0; q < QUANTITIES; q++)
			draw[q * bootstrap + b] = e[q].value;
	}
	for (int q = 0; q < QUANTITIES; q++) {
		double *x = draw + q * bootstrap;
		size_t n = 0;

		for (long b = 0; b < bootstrap; b++)
			if (!isnan(x[b]))
				x[n++] = x[b];
		out[q].low = sample_quantile(x, n, 0.5 - 0.5 * confidence);
		out[q].high = sample_quantile(x, n, 0.5 + 0.5 * confidence);
	}
	stats_add("draws", (double)bootstrap);
	free(draw);
	free(pick);
}

static size_t *pick_all(const struct data *d)
{
	size_t *pick = xcalloc(d->all + 1, sizeof(*pick));

	for (size_t i = 0; i < d->all; i++)
		pick[i] = i;
	return pick;
}

static void put_quantity(struct table_out *t, const char *name, struct estimate e)
{
	table_put_text(t, name);
	table_put(t, e.value);
	table_put(t, e.low);
	table_put(t, e.high);
	table_end_row(t);
}

static void print_fits(const struct data *d, const char *cmd)
{
	struct table_out *t = table_create(NULL, cmd, NULL, "quantity value low high");
	size_t *pick = pick_all(d), n;
	double *x = pick_diameters(d, pick, d->all, &n);
	struct estimate e[QUANTITIES], plain = { NAN, NAN, NAN };

	estimate_all(d, pick, d->all, 1, e);
	if (bootstrap)
		resample(d, e);
	plain.value = (double)d->all;
	put_quantity(t, "realisations", plain);
	plain.value = (double)(d->last - d->first + 1);
	put_quantity(t, "steps", plain);
	plain.value = (double)n;
	put_quantity(t, "particles", plain);
	for (int q = 0; q < QUANTITIES; q++)
		put_quantity(t, quantity_names[q], e[q]);
	table_done(t);
	free(pick);
	free(x);
}

/* Steps */

static void print_steps(const struct data *d, const char *cmd)
{
	struct table_out *t = table_create(NULL, cmd, "1 1 1 1 1 m3 m3 m3 m3 m 1 m",
		"step realisations particles particles_sd cumulative_particles volume "
		"volume_sd cumulative_volume cumulative_volume_sd mean_diameter "
		"weibull_shape weibull_scale");
	double *count = xcalloc(3 * d->all + 1, sizeof(*count)), all = 0;
	double *volume = count + d->all, *total = volume + d->all;
	double *sum = xcalloc(d->all + 1, sizeof(*sum));
	size_t *pick = pick_all(d);

	for (long s = 1; s <= d->last; s++) {
		struct data one = *d;
		struct weibull w;
		double sd[3], mean[3], spread, *x;
		size_t n = 0, m;

		for (size_t r = 0; r < d->all; r++) {
			const struct cell *c = cell_at(d, r, s);

			sum[r] += c->volume;
			if (!c->there)
				continue;
			count[n] = count_cell(d, c);
			all += count[n];
			volume[n] = c->volume;
			total[n++] = sum[r];
		}
		if (s < d->first)
			continue;
		mean[0] = sample_mean(count, n, confidence, &sd[0]).value;
		mean[1] = sample_mean(volume, n, confidence, &sd[1]).value;
		mean[2] = sample_mean(total, n, confidence, &sd[2]).value;
		one.first = one.last = s;
		x = pick_diameters(&one, pick, d->all, &m);
		if (fit_diameters(x, m, &w))
			w.shape.value = w.scale.value = NAN;
		double row[] = { (double)s, (double)n, mean[0], sd[0], all, mean[1],
			sd[1], mean[2], sd[2],
			sample_mean(x, m, confidence, &spread).value, w.shape.value,
			w.scale.value };

		for (size_t k = 0; k < sizeof(row) / sizeof(*row); k++)
			table_put(t, row[k]);
		table_end_row(t);
		free(x);
	}
	table_done(t);
	free(count);
	free(sum);
	free(pick);
}

/* Classes */

static void print_sizes(const struct data *d, const char *cmd)
{
	struct table_out *t = table_create(
		NULL, cmd, "m m 1 1/m 1/m", "low high count density weibull");
	size_t *pick = pick_all(d), n, classes = 0;
	double *x = pick_diameters(d, pick, d->all, &n), *count;
	struct weibull w;
	int fitted = fit_diameters(x, n, &w) == 0;

	for (size_t i = 0; i < n; i++) {
		if (x[i] / bin > 1e6)
			die(EXIT_RUN, "--bin %g m: more than a million classes", bin);
		if ((size_t)(x[i] / bin) + 1 > classes)
			classes = (size_t)(x[i] / bin) + 1;
	}
	count = xcalloc(classes + 1, sizeof(*count));
	for (size_t i = 0; i < n; i++)
		count[(size_t)(x[i] / bin)]++;
	for (size_t i = 0; i < classes; i++) {
		table_put(t, (double)i * bin);
		table_put(t, (double)(i + 1) * bin);
		table_put(t, count[i]);
		table_put(t, count[i] / ((double)n * bin));
		table_put(t, fitted ? weibull_density(&w, ((double)i + 0.5) * bin) : NAN);
		table_end_row(t);
	}
	table_done(t);
	free(count);
	free(pick);
	free(x);
}

static void print_aspects(const struct data *d, const char *cmd)
{
	struct table_out *t = table_create(NULL, cmd, "1 1 1 1", "low high count share");
	double count[OPT_LIST_MAX + 1] = { 0 }, all = 0;

	for (size_t i = 0; i < d->rows; i++) {
		const struct row *r = &d->row[i];
		int k = 0;

		if (!counted(r) || r->step < d->first || r->step > d->last)
			continue;
		while (k < edges.n && r->aspect >= edges.v[k])
			k++;
		count[k]++;
		all++;
	}
	for (int k = 1; k <= edges.n; k++) {
		table_put(t, edges.v[k - 1]);
		table_put(t, k < edges.n ? edges.v[k] : INFINITY);
		table_put(t, count[k]);
		table_put(t, all > 0 ? count[k] / all : NAN);
		table_end_row(t);
	}
	table_done(t);
}

static void check_options(void)
{
	if (diameters.n != 2 || diameters.v[0] >= diameters.v[1])
		die(EXIT_USAGE, "--diameter wants LO:HI with LO below HI");
	if (range.n > 2 || (range.n == 2 && range.v[0] > range.v[1]))
		die(EXIT_USAGE, "--step wants A or A:B with A not above B");
	for (int k = 1; k < edges.n; k++)
		if (edges.v[k] <= edges.v[k - 1])
			die(EXIT_USAGE, "--aspects: %g does not lie above %g", edges.v[k],
				edges.v[k - 1]);
}

int main(int argc, char **argv)
{
	static void (*const print[])(const struct data *, const char *) = { print_fits,
		print_steps, print_sizes, print_aspects };
	int first = opt_parse(&prog, argc, argv);
	struct data d = { 0 };
	char *cmd;

	check_options();
	read_particles(&d, argv[first], &cmd);
	arrange(&d);
	stats_add("particles", (double)d.rows);
	stats_add("realisations", (double)d.all);
	print[output](&d, cmd);
	free(d.row);
	free(d.id);
	free(d.cell);
	free(cmd);
	return shell_done(EXIT_SUCCESS);
}
