#include "debris/surrogate.h"
#include "num/lanes.h"
#include "num/lesser.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A hundred surfaces leave 40 scores: coverage of 90 % then varies by 5 % (standard
 * deviation) from one surrogate to another. */
enum { LEAST = 100 };
const char *const surrogate_property_names[] = { "flow", "lay", "oblique", "friction",
	"poisson" };

enum part { FIT, CALIBRATE, CHECK };
static const double SURE = 0.9; /* confidence level of the report */

/* Of direct sums in single precision. */
static const double ROUNDING = 1e-5;
/* Errors of the sums have longer tails than those of cells left out, which are about
 * normal, and are up to twice as large on some kinds of surfaces as on others: a normal
 * distribution describes them that has their bound of this share, so many standard
 * deviations away.  Of 320 rough surfaces of which every cell was measured intervals of
 * 90 % hold 247 with the bound of .9 (1.645) and 280 with that of .95. */
static const double TAIL = 0.95, TAIL_BOUND = 1.96;

static enum part part_of(long place)
{
	return place % 5 < 2 ? FIT : place % 5 < 4 ? CALIBRATE : CHECK;
}

static void find_range(const struct surrogate_sample *sample, const char *part, size_t n,
	struct surrogate *s)
{
	for (int k = 0; k < SURROGATE_PROPERTIES; k++) {
		double *least = &s->least[k], *most = &s->most[k];

		*least = INFINITY;
		*most = -INFINITY;
		for (size_t i = 0; i < n; i++) {
			if (part[i] != FIT)
				continue;
			*least = fmin(*least, sample[i].contact.property[k]);
			*most = fmax(*most, sample[i].contact.property[k]);
		}
	}
}

/* ---- intervals ---- */

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/* Sorts the scores and keeps as many quantiles of them as fit. */
static int keep_scores(double *all, size_t n, double *kept)
{
	int most = n < SURROGATE_SCORES ? (int)n : SURROGATE_SCORES;

	qsort(all, n, sizeof *all, ascending);
	for (int i = 0; i < most; i++)
		kept[i] = all[(size_t)(((double)i + 0.5) * (double)n / most)];
	return most;
}

/* Conformal bound: the k-th largest score, k = floor((1 - level) (n + 1)).  nan: there is
 * none. */
static double bound(const double *score, int n, double level)
{
	int k = (int)floor((1 - level) * (n + 1) + 1e-9);

	return k > 0 && k <= n ? score[n - k] : NAN;
}

double surrogate_highest_level(const struct surrogate *s)
{
	int n = s->particles < s->totals ? s->particles : s->totals;

	return 1 - 1.0 / (n + 1);
}

/* Some or all regions of a surface.  The errors of cells left out are independent, those
 * of the sums have a cause in common. */
struct sum {
	double volume, squares, fourths, change;
};

static void add_to(struct sum *sum, const struct footprint *f)
{
	double square = f->error * f->error;

	sum->volume += f->volume;
	sum->squares += square;
	sum->fourths += square > 0 ? square * square / f->freedom : 0;
	sum->change += f->change;
}

/* By how much the 90 % quantile of Student's distribution exceeds that of the normal one
 * (Abramowitz and Stegun, 26.7.5; 2 % less than it is with three degrees of freedom). */
static double student(double freedom)
{
	const double x = 1.6449, x2 = x * x;

	return 1 + (x2 + 1) / (4 * freedom) +
	       ((5 * x2 + 16) * x2 + 3) / (96 * freedom * freedom);
}

/* Of the logarithm of a volume, in terms of the normal distribution.  The degrees of
 * freedom of a sum are those of Welch (1947). */
static double deviation_of(const struct surrogate *s, const struct sum *sum,
	const struct surrogate_contact *contact)
{
	double left_out = 0;

	if (sum->squares > 0)
		left_out = sqrt(sum->squares) *
			   student(sum->squares * sum->squares / sum->fourths);
	return hypot(left_out, s->sums * contact->pressure * sum->change) / sum->volume;
}

static double deviation_of_one(const struct surrogate *s, const struct footprint *f,
	const struct surrogate_contact *contact)
{
	struct sum sum = { 0 };

	add_to(&sum, f);
	return deviation_of(s, &sum, contact);
}

struct loaded {
	double cells, flowing, square;
};

static struct loaded find_loaded(const double *pressure, size_t cells, double hardness)
{
	struct loaded l = { 0 };

	for (size_t i = lanes_next(pressure, 0, cells); i < cells;
		i = lanes_next(pressure, i + 1, cells)) {
		double p = pressure[i];

		l.cells += p > 0;
		l.flowing += p > 0 && hardness > 0 && p >= hardness;
		l.square += p * p;
	}
	return l;
}

/* Sums of products of the gradients, in cells. */
struct gradients {
	lanes xx, xy, yy;
};

/* Between two rows. */
static void add_gradients(
	const double *p, const double *q, size_t nx, struct gradients *sum)
{
	for (size_t x = 0; x + 1 < nx; x += 2) {
		int n = x + 2 < nx ? 2 : 1;
		lanes a = lanes_load(p + x, n), b = lanes_load(p + x + 1, n),
		      c = lanes_load(q + x, n), d = lanes_load(q + x + 1, n);
		lanes gx = (b + d) - (a + c), gy = (d - b) + (c - a);

		lanes_add(&sum->xx, gx * gx, n);
		lanes_add(&sum->xy, gx * gy, n);
		lanes_add(&sum->yy, gy * gy, n);
	}
}

struct surrogate_contact surrogate_contact(const struct stress_par *par,
	const double *pressure, double yield, double hardness)
{
	size_t nx = (size_t)par->nx, ny = (size_t)par->ny;
	struct loaded l = find_loaded(pressure, nx * ny, hardness);
	struct gradients g = { .xx = { 0 } };
	double xx, xy, yy, sum;

	for (size_t y = 0; y + 1 < ny; y++)
		add_gradients(pressure + y * nx, pressure + (y + 1) * nx, nx, &g);
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
		.pressure = sqrt(l.square / (double)(nx * ny)) / yield,
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
	double one = bound(s->particle, s->particles, level),
	       all = bound(s->total, s->totals, level);
	struct sum sum = { 0 };

	*total = (struct surrogate_guess){ 0 };
	for (int k = 0; k < SURROGATE_PROPERTIES && count > 0; k++)
		if (!is_between(contact->property[k], s->least[k], s->most[k]))
			return 0;
	if (isnan(one) || isnan(all))
		return 0;
	if (count == 0)
		return 1;
	for (size_t i = 0; i < count; i++) {
		guess[i] = guess_of(footprint[i].volume,
			one * deviation_of_one(s, &footprint[i], contact));
		add_to(&sum, &footprint[i]);
	}
	if (!isfinite(sum.volume))
		return 0;
	*total = guess_of(sum.volume, all * deviation_of(s, &sum, contact));
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
static double total_error(const struct surrogate *s, const struct surrogate_sample *x,
	size_t n, double *deviation)
{
	struct sum sum = { 0 };
	double truth = 0;

	for (size_t i = 0; i < n; i++) {
		truth += x[i].volume;
		add_to(&sum, &x[i].footprint);
	}
	*deviation = deviation_of(s, &sum, &x->contact);
	return log(truth / sum.volume);
}

/* How far the sums are off: from the regions of which every cell was measured. */
static double find_sums(
	const struct surrogate_sample *sample, const char *part, size_t n, double *error)
{
	size_t count = 0;

	for (size_t i = 0; i < n; i++) {
		const struct surrogate_sample *x = &sample[i];
		const struct footprint *f = &x->footprint;

		if (part[i] == FIT && f->error == 0 && f->change > 0)
			error[count++] = fabs(x->volume - f->volume) /
					 (f->change * x->contact.pressure);
	}
	qsort(error, count, sizeof *error, ascending);
	return fmax(ROUNDING,
		count > 0 ? error[(size_t)(TAIL * (double)count)] / TAIL_BOUND : 0);
}

static void calibrate(const struct surrogate_sample *sample, const char *part, size_t n,
	struct surrogate *s, double *score)
{
	size_t count = 0, end;

	for (size_t i = 0; i < n; i++)
		if (part[i] == CALIBRATE)
			score[count++] =
				fabs(log(sample[i].volume / sample[i].footprint.volume)) /
				deviation_of_one(
					s, &sample[i].footprint, &sample[i].contact);
	s->particles = keep_scores(score, count, s->particle);
	count = 0;
	for (size_t i = 0; i < n; i = end) {
		double deviation, error;

		end = surface_end(sample, n, i);
		if (part[i] != CALIBRATE)
			continue;
		error = total_error(s, sample + i, end - i, &deviation);
		score[count++] = fabs(error) / deviation;
	}
	s->totals = keep_scores(score, count, s->total);
}

static void check(const struct surrogate_sample *sample, const char *part, size_t n,
	const struct surrogate *s, struct surrogate_report *r)
{
	double size = bound(s->total, s->totals, SURE), squares = 0;
	size_t end;

	for (size_t i = 0; i < n; i = end) {
		double deviation, error;

		end = surface_end(sample, n, i);
		if (part[i] != CHECK)
			continue;
		error = total_error(s, sample + i, end - i, &deviation);
		r->within += fabs(error) <= size * deviation;
		r->width += size * deviation;
		squares += error * error;
		r->most = fmax(r->most, fabs(error));
	}
	r->rms = sqrt(squares / (double)r->checked);
	r->width /= (double)r->checked;
}

enum surrogate_status surrogate_fit(const struct surrogate_sample *sample, size_t n,
	struct surrogate *s, struct surrogate_report *report)
{
	char *part = malloc(n + 1);
	double *score = malloc((n + 1) * sizeof *score);
	size_t end;
	long place = 0;

	memset(s, 0, sizeof *s);
	memset(report, 0, sizeof *report);
	if (!part || !score) {
		free(part);
		free(score);
		return SURROGATE_MEMORY;
	}
	for (size_t i = 0; i < n; i = end, place++) {
		enum part p = part_of(place);

		end = surface_end(sample, n, i);
		memset(part + i, (int)p, end - i);
		report->fitted += p == FIT;
		report->calibrated += p == CALIBRATE;
		report->checked += p == CHECK;
	}
	if (place >= LEAST) {
		find_range(sample, part, n, s);
		s->sums = find_sums(sample, part, n, score);
		calibrate(sample, part, n, s, score);
		check(sample, part, n, s, report);
	}
	free(part);
	free(score);
	return place >= LEAST ? SURROGATE_OK : SURROGATE_FEW;
}
