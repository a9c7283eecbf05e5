#include "debris/surrogate.h"
#include "num/deviates.h"
#include "num/lanes.h"
#include "num/lesser.h"
#include "num/select.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A hundred surfaces leave 80 scores: coverage of 90 % then varies by 3 % (standard
 * deviation) from one surrogate to another. */
enum { LEAST = 100 };
const char *const surrogate_property_names[] = { "flow", "lay", "oblique", "friction",
	"poisson" };

static const double SURE = 0.9; /* confidence level of the report */

static void find_range(const struct surrogate_sample *sample, const char *held, size_t n,
	struct surrogate *s)
{
	for (int k = 0; k < SURROGATE_PROPERTIES; k++) {
		double *least = &s->least[k], *most = &s->most[k];

		*least = INFINITY;
		*most = -INFINITY;
		for (size_t i = 0; i < n; i++) {
			if (held[i])
				continue;
			*least = fmin(*least, sample[i].contact.property[k]);
			*most = fmax(*most, sample[i].contact.property[k]);
		}
	}
}

/* ---- intervals ---- */

/* Sorts the scores and keeps as many quantiles of them as fit. */
static void keep_scores(double *all, size_t n, struct surrogate_scores *kept)
{
	int most = n < SURROGATE_SCORES ? (int)n : SURROGATE_SCORES;

	sort_numbers(all, n);
	for (int i = 0; i < most; i++)
		kept->score[i] = all[(size_t)(((double)i + 0.5) * (double)n / most)];
	kept->count = most;
}

/* Conformal bound: the k-th largest score, k = floor((1 - level) (n + 1)).  nan: there is
 * none. */
static double bound(const struct surrogate_scores *s, double level)
{
	int n = s->count, k = (int)floor((1 - level) * (n + 1) + 1e-9);

	return k > 0 && k <= n ? s->score[n - k] : NAN;
}

/* The bound of a class.  If the fit has too few surfaces of it, that of the other one,
 * but at least the quantile of normal errors, as the deviations are standard errors. */
static double bound_of(
	const struct surrogate_scores *s, enum surrogate_class class, double level)
{
	double own = bound(&s[class], level),
	       other = bound(&s[SURROGATE_SAMPLED - class], level);

	if (!isnan(own) || isnan(other))
		return own;
	return fmax(other, normal_quantile(0.5 + 0.5 * level));
}

double surrogate_highest_level(const struct surrogate *s)
{
	int most = 0;

	for (int c = 0; c < SURROGATE_CLASSES; c++)
		most = larger_int(
			most, lesser_int(s->particle[c].count, s->total[c].count));
	return 1 - 1.0 / (most + 1);
}

/* Some or all regions of a surface.  The errors of cells left out are independent, those
 * of the sums have a cause in common. */
struct sum {
	double volume, squares, fourths, sums;
};

static void add_to(struct sum *sum, const struct footprint *f)
{
	double square = f->error * f->error;

	sum->volume += f->volume;
	sum->squares += square + f->jumps * f->jumps;
	sum->fourths += square > 0 ? square * square / f->freedom : 0;
	sum->sums += f->sums;
}

/* By how much the 90 % quantile of Student's distribution exceeds that of the normal one
 * (Abramowitz and Stegun, 26.7.5; 5 % less than it is with two degrees of freedom). */
static double student(double freedom)
{
	const double x = 1.6449, x2 = x * x;

	return 1 + (x2 + 1) / (4 * freedom) +
	       ((5 * x2 + 16) * x2 + 3) / (96 * freedom * freedom);
}

/* Of the logarithm of a volume, in terms of the normal distribution.  The degrees of
 * freedom of a sum are those of Welch (1947). */
static double deviation_of(const struct sum *sum)
{
	double left_out = sqrt(sum->squares);

	if (sum->fourths > 0)
		left_out *= student(sum->squares * sum->squares / sum->fourths);
	return hypot(left_out, sum->sums) / sum->volume;
}

static enum surrogate_class class_of(const struct sum *sum)
{
	return sum->fourths > 0 ? SURROGATE_SAMPLED : SURROGATE_MEASURED;
}

static double deviation_of_one(const struct footprint *f, enum surrogate_class *class)
{
	struct sum sum = { 0 };

	add_to(&sum, f);
	*class = class_of(&sum);
	return deviation_of(&sum);
}

struct loaded {
	double cells, flowing;
};

static struct loaded find_loaded(const struct stress_span *run,
	const struct stress_span *end, const double *pressure, size_t nx, double hardness)
{
	struct loaded l = { 0 };

	for (; hardness > 0 && run < end; run++) {
		const double *row = pressure + (size_t)run->y * nx;

		for (int x = run->begin; x < run->end; x++) {
			l.cells += row[x] > 0;
			l.flowing += row[x] > 0 && row[x] >= hardness;
		}
	}
	return l;
}

/* The runs of loaded cells that are not passed yet. */
struct ahead {
	const struct stress_span *run, *end;
};

/* The next loaded cell of row y from x on, or nx; y and x never go back. */
static size_t next_loaded(struct ahead *a, int y, size_t x, size_t nx)
{
	while (a->run < a->end &&
		(a->run->y < y || (a->run->y == y && (size_t)a->run->end <= x)))
		a->run++;
	if (a->run == a->end || a->run->y > y)
		return nx;
	return (size_t)a->run->begin > x ? (size_t)a->run->begin : x;
}

/* Sums of products of the gradients, in cells. */
struct gradients {
	lanes xx, xy, yy;
};

/* Between two rows, y and the next.  Where no cell is loaded the gradients are zero. */
static void add_gradients(const double *p, size_t nx, int y, struct ahead *ahead,
	struct ahead *below, struct gradients *sum)
{
	const double *q = p + nx;
	size_t next_p = next_loaded(ahead, y, 0, nx),
	       next_q = next_loaded(below, y + 1, 0, nx);

	for (size_t x = 0; x + 1 < nx; x += 2) {
		int n = x + 2 < nx ? 2 : 1;

		if (next_p < x)
			next_p = next_loaded(ahead, y, x, nx);
		if (next_q < x)
			next_q = next_loaded(below, y + 1, x, nx);
		if (next_p > x + 2 && next_q > x + 2) {
			x = (lesser(next_p, next_q) - 1) / 2 * 2 - 2;
			continue;
		}
		lanes a = lanes_load(p + x, n), b = lanes_load(p + x + 1, n),
		      c = lanes_load(q + x, n), d = lanes_load(q + x + 1, n);
		lanes gx = (b + d) - (a + c), gy = (d - b) + (c - a);

		lanes_add(&sum->xx, gx * gx, n);
		lanes_add(&sum->xy, gx * gy, n);
		lanes_add(&sum->yy, gy * gy, n);
	}
}

struct surrogate_contact surrogate_contact(const struct stress_par *par,
	const struct stress *stress, const double *pressure, double hardness)
{
	size_t nx = (size_t)par->nx, count;
	const struct stress_span *run = stress_loads(stress, &count);
	struct loaded l = find_loaded(run, run + count, pressure, nx, hardness);
	struct ahead ahead = { run, run + count }, below = ahead;
	struct gradients g = { .xx = { 0 } };
	double xx, xy, yy, sum;

	for (int y = 0; y + 1 < par->ny; y++)
		add_gradients(pressure + (size_t)y * nx, nx, y, &ahead, &below, &g);
	xx = (g.xx[0] + g.xx[1]) / (par->dx * par->dx);
	xy = (g.xy[0] + g.xy[1]) / (par->dx * par->dy);
	yy = (g.yy[0] + g.yy[1]) / (par->dy * par->dy);
	sum = xx + yy > 0 ? xx + yy : 1;
	return (struct surrogate_contact){
		.property = { [SURROGATE_FLOW] = l.cells > 0 ? l.flowing / l.cells : 0,
			[SURROGATE_LAY] = (par->axis ? yy - xx : xx - yy) / sum,
			[SURROGATE_OBLIQUE] = 2 * fabs(xy) / sum,
			[SURROGATE_FRICTION] = fabs(par->mu),
			[SURROGATE_POISSON] = par->nu },
	};
}

static int is_between(double x, double low, double high)
{
	double rounding = 1e-9 * (1 + fabs(x));

	return x >= low - rounding && x <= high + rounding;
}

static struct surrogate_guess guess_of(double volume, double half_width)
{
	return (struct surrogate_guess){ volume, volume * exp(-half_width),
		volume * exp(half_width) };
}

int surrogate_guess(const struct surrogate *s, const struct footprint *footprint,
	size_t count, const struct surrogate_contact *contact, double level,
	struct surrogate_guess *guess, struct surrogate_guess *total)
{
	struct sum sum = { 0 };
	double all;

	*total = (struct surrogate_guess){ 0 };
	for (int k = 0; k < SURROGATE_PROPERTIES && count > 0; k++)
		if (!is_between(contact->property[k], s->least[k], s->most[k]))
			return 0;
	if (count == 0)
		return 1;
	for (size_t i = 0; i < count; i++) {
		enum surrogate_class class;
		double deviation = deviation_of_one(&footprint[i], &class);
		double one = bound_of(s->particle, class, level);

		if (isnan(one))
			return 0;
		guess[i] = guess_of(footprint[i].volume, one * deviation);
		add_to(&sum, &footprint[i]);
	}
	all = bound_of(s->total, class_of(&sum), level);
	if (!isfinite(sum.volume + sum.sums + all))
		return 0;
	*total = guess_of(sum.volume, all * deviation_of(&sum));
	return 1;
}

/* Particles of the surface that begins at i. */
static size_t surface_end(const struct surrogate_sample *sample, size_t n, size_t i)
{
	size_t end = i;

	while (end < n && sample[end].surface == sample[i].surface)
		end++;
	return end;
}

/* For a surface: ln of the true over the estimated total, and its deviation. */
static double total_error(const struct surrogate_sample *x, size_t n, double *deviation,
	enum surrogate_class *class)
{
	struct sum sum = { 0 };
	double truth = 0;

	for (size_t i = 0; i < n; i++) {
		truth += x[i].volume;
		add_to(&sum, &x[i].footprint);
	}
	*deviation = deviation_of(&sum);
	*class = class_of(&sum);
	return log(truth / sum.volume);
}

/* The scores of one class. */
static void calibrate(const struct surrogate_sample *sample, const char *held, size_t n,
	enum surrogate_class class, struct surrogate *s, double *score)
{
	size_t count = 0, end;
	enum surrogate_class its;

	for (size_t i = 0; i < n; i++) {
		double deviation = deviation_of_one(&sample[i].footprint, &its);

		if (!held[i] && its == class)
			score[count++] =
				fabs(log(sample[i].volume / sample[i].footprint.volume)) /
				deviation;
	}
	keep_scores(score, count, &s->particle[class]);
	count = 0;
	for (size_t i = 0; i < n; i = end) {
		double deviation, error;

		end = surface_end(sample, n, i);
		error = total_error(sample + i, end - i, &deviation, &its);
		if (!held[i] && its == class)
			score[count++] = fabs(error) / deviation;
	}
	keep_scores(score, count, &s->total[class]);
}

/* Surfaces of a class that has too few scores are not estimated, and not checked. */
static void check(const struct surrogate_sample *sample, const char *held, size_t n,
	const struct surrogate *s, struct surrogate_report *r)
{
	double squares = 0;
	size_t end;

	r->checked = 0;
	for (size_t i = 0; i < n; i = end) {
		double deviation, error, size;
		enum surrogate_class class;

		end = surface_end(sample, n, i);
		error = total_error(sample + i, end - i, &deviation, &class);
		size = bound_of(s->total, class, SURE);
		if (!held[i] || isnan(size))
			continue;
		r->checked++;
		r->within += fabs(error) <= size * deviation;
		r->width += size * deviation;
		squares += error * error;
		r->most = fmax(r->most, fabs(error));
	}
	if (r->checked == 0)
		return;
	r->rms = sqrt(squares / (double)r->checked);
	r->width /= (double)r->checked;
}

enum surrogate_status surrogate_fit(const struct surrogate_sample *sample, size_t n,
	struct surrogate *s, struct surrogate_report *report)
{
	char *held = malloc(n + 1);
	double *score = malloc((n + 1) * sizeof *score);
	size_t end;
	long place = 0;

	memset(s, 0, sizeof *s);
	memset(report, 0, sizeof *report);
	if (!held || !score) {
		free(held);
		free(score);
		return SURROGATE_MEMORY;
	}
	for (size_t i = 0; i < n; i = end, place++) {
		int last = place % 5 == 4;

		end = surface_end(sample, n, i);
		memset(held + i, last, end - i);
		report->fitted += !last;
	}
	if (place >= LEAST) {
		find_range(sample, held, n, s);
		calibrate(sample, held, n, SURROGATE_MEASURED, s, score);
		calibrate(sample, held, n, SURROGATE_SAMPLED, s, score);
		check(sample, held, n, s, report);
	}
	free(held);
	free(score);
	return place >= LEAST ? SURROGATE_OK : SURROGATE_FEW;
}
