/* tones.c - see tones.h */
#include "signal/noise/tones.h"
#include "num/cholesky.h"
#include "num/dot.h"
#include "num/parabola.h"
#include "num/periodogram.h"
#include "num/robust.h"
#include "num/select.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	TERMS_MAX = 2 * TONES_MAX + 1,
	RUN = 64 /* samples for each sine and cosine that is computed */
};

struct line {
	double power, omega;
};

static int by_power(const void *x, const void *y)
{
	const struct line *p = x, *q = y;

	return p->power > q->power ? -1 : p->power < q->power;
}

/* Pulses are clipped to a multiple of the usual sample, which includes the lines:
 * unclipped, the spectrum of rare strong pulses would hide lines. */
static void add_clipped(
	struct periodogram *p, const double *y, size_t n, double clip, double *power)
{
	double mean = mean_of(y, n), limit, *work = p->x;

	for (size_t i = 0; i < n; i++)
		work[i] = fabs(y[i] - mean);
	limit = clip * robust_median(work, n);
	if (limit <= 0)
		limit = INFINITY; /* silence except for pulses */
	for (size_t i = 0; i < n; i++)
		work[i] = fmax(fmin(y[i] - mean, limit), -limit) *
			  (0.5 - 0.5 * cos(2 * M_PI * (double)i / (double)n));
	periodogram_add(p, 1, power, n / 2 + 1);
}

static int pick_lines(const double *power, size_t n, size_t side, int max, double *omega)
{
	enum { KEEP = 256 };
	struct line line[KEEP] = { { 0, 0 } };
	double around[2 * TONES_SIDE];
	int count = 0;

	for (size_t k = 3; k + 3 <= n / 2; k++) {
		size_t from = k > side ? k - side : 0,
		       to = k + side < n / 2 ? k + side : n / 2;
		int m = 0;

		if (power[k] <= power[k - 1] || power[k] < power[k + 1])
			continue;
		for (size_t i = from; i < to; i++)
			if (i + 2 < k || i > k + 2)
				around[m++] = power[i];
		if (!robust_median_at_most(around, (size_t)m, power[k] / 40) ||
			count == KEEP)
			continue;
		/* The main lobe of a Hann window is nearly a parabola in the logarithm.
		 */
		line[count].power = power[k];
		line[count++].omega =
			2 * M_PI / (double)n *
			((double)k + parabola_top(log(power[k - 1]), log(power[k]),
					     log(power[k + 1])));
	}
	qsort(line, (size_t)count, sizeof *line, by_power);
	if (count > max)
		count = max;
	for (int i = 0; i < count; i++)
		omega[i] = line[i].omega;
	sort_numbers(omega, (size_t)count);
	return count;
}

enum num_status tones_find(const double *y1, const double *y2, size_t n, int side,
	double clip, int max, double *omega, int *tones)
{
	struct periodogram *p;
	double *power;
	enum num_status status;

	*tones = 0;
	if (n < 1024)
		return NUM_OK;
	while (fft_good_size(n) != n || n % 2)
		n--;
	p = periodogram_new(n);
	power = calloc(n / 2 + 1, sizeof *power);
	status = p && power ? NUM_OK : NUM_MEMORY;
	if (status == NUM_OK) {
		add_clipped(p, y1, n, clip, power);
		add_clipped(p, y2, n, clip, power);
		*tones = pick_lines(
			power, n, (size_t)side, max > TONES_MAX ? TONES_MAX : max, omega);
	}
	periodogram_free(p);
	free(power);
	return status;
}

/* Terms (a constant, then cosine and sine of each tone) of a run of samples from index 0
 * on, and the sums of their products.  Those of any other run follow by rotating each
 * tone by its phase at the beginning of the run. */
struct basis {
	int tones, terms;
	double omega[TONES_MAX];
	double term[TERMS_MAX][RUN], gram[TERMS_MAX][TERMS_MAX];
};

static void make_basis(struct basis *b, int tones, const double *omega)
{
	b->tones = tones;
	b->terms = 1 + 2 * tones;
	memcpy(b->omega, omega, sizeof(double) * (size_t)tones);
	for (int i = 0; i < RUN; i++) {
		b->term[0][i] = 1;
		for (int k = 0; k < tones; k++) {
			b->term[1 + 2 * k][i] = cos(omega[k] * i);
			b->term[2 + 2 * k][i] = sin(omega[k] * i);
		}
	}
	for (int k = 0; k < b->terms; k++)
		for (int l = 0; l < b->terms; l++)
			b->gram[k][l] = dot(b->term[k], b->term[l], RUN);
}

/* Terms of the run from index t on, by the addition theorem. */
static void make_terms(const struct basis *b, double t, double term[][RUN])
{
	memcpy(term[0], b->term[0], sizeof term[0]);
	for (int k = 0; k < b->tones; k++) {
		const double *c0 = b->term[1 + 2 * k], *s0 = b->term[2 + 2 * k];
		double *c = term[1 + 2 * k], *s = term[2 + 2 * k];
		double ct = cos(b->omega[k] * t), st = sin(b->omega[k] * t);

		for (int i = 0; i < RUN; i++) {
			c[i] = ct * c0[i] - st * s0[i];
			s[i] = st * c0[i] + ct * s0[i];
		}
	}
}

/* Sum of the terms of a run times their coefficients. */
static void sum_terms(
	double term[][RUN], int terms, const double *coefficient, double *sum)
{
	double part[RUN] = { 0 };

	for (int k = 0; k < terms; k++)
		for (int i = 0; i < RUN; i++)
			part[i] += coefficient[k] * term[k][i];
	memcpy(sum, part, sizeof part);
}

/* Rotates the pair of rows of every tone by its phase at the first sample of term. */
static void turn_rows(const struct basis *b, double term[][RUN], double from[][TERMS_MAX],
	double to[][TERMS_MAX])
{
	memcpy(to[0], from[0], sizeof to[0]);
	for (int k = 1; k < b->terms; k += 2) {
		double c = term[k][0], s = term[k + 1][0];

		for (int l = 0; l < b->terms; l++) {
			to[k][l] = c * from[k][l] - s * from[k + 1][l];
			to[k + 1][l] = s * from[k][l] + c * from[k + 1][l];
		}
	}
}

/* The normal equations being accumulated: products of terms with each other and with the
 * samples. */
struct normal {
	double a[TERMS_MAX * TERMS_MAX], b[TERMS_MAX];
};

/* Adds a run in which all samples count. */
static void add_whole(
	struct normal *s, struct basis *b, double term[][RUN], const double *x)
{
	double once[TERMS_MAX][TERMS_MAX], turned[TERMS_MAX][TERMS_MAX],
		twice[TERMS_MAX][TERMS_MAX];

	turn_rows(b, term, b->gram, once);
	for (int k = 0; k < b->terms; k++)
		for (int l = 0; l < b->terms; l++)
			turned[k][l] = once[l][k];
	turn_rows(b, term, turned, twice);
	for (int k = 0; k < b->terms; k++) {
		s->b[k] += dot(term[k], x, RUN);
		for (int l = 0; l <= k; l++)
			s->a[k * TERMS_MAX + l] += twice[k][l];
	}
}

/* Adds the samples of a run whose mask is set. */
static void add_part(struct normal *s, const struct basis *b, double term[][RUN],
	const double *x, const unsigned char *mask)
{
	double part[TERMS_MAX][RUN], y[RUN];

	for (int i = 0; i < RUN; i++)
		y[i] = mask[i] ? x[i] : 0;
	for (int k = 0; k < b->terms; k++) {
		for (int i = 0; i < RUN; i++)
			part[k][i] = mask[i] ? term[k][i] : 0;
		s->b[k] += dot(term[k], y, RUN);
		for (int l = 0; l <= k; l++)
			s->a[k * TERMS_MAX + l] += dot(part[k], term[l], RUN);
	}
}

/* Least squares over the samples whose mask is set; on request the variance of each
 * coefficient in units of that of a sample.  NUM_DOMAIN where these samples do not
 * determine the coefficients. */
static enum num_status fit_masked(struct basis *b, double term[][RUN], const double *x,
	const unsigned char *mask, size_t runs, double *coefficient, double *variance)
{
	struct normal s = { { 0 }, { 0 } };
	size_t terms = (size_t)b->terms;

	for (size_t r = 0; r < runs; r++, term += b->terms, x += RUN, mask += RUN)
		if (!memchr(mask, 0, RUN))
			add_whole(&s, b, term, x);
		else if (memchr(mask, 1, RUN))
			add_part(&s, b, term, x, mask);
	if (cholesky_factor(s.a, terms, TERMS_MAX, 1e-10))
		return NUM_DOMAIN;
	cholesky_solve(s.a, terms, TERMS_MAX, s.b);
	memcpy(coefficient, s.b, sizeof(double) * (size_t)b->terms);
	for (int k = 0; variance && k < b->terms; k++) {
		double unit[TERMS_MAX] = { 0 };

		unit[k] = 1;
		cholesky_solve(s.a, terms, TERMS_MAX, unit);
		variance[k] = unit[k];
	}
	return NUM_OK;
}

/* Marks the samples at which the mean square of rest over some neighbours is at most
 * twice its median, that is, those without pulses.  Returns that median; work and sorted
 * hold n. */
static double mark_pulse_free(
	const double *rest, size_t n, double *work, double *sorted, unsigned char *mask)
{
	size_t half = n / 1024 > 8 ? n / 1024 : 8, count = 0;
	double sum = 0, median;

	for (size_t i = 0; i < n + half; i++) {
		if (i < n) {
			sum += rest[i] * rest[i];
			count++;
		}
		if (i > 2 * half) {
			sum -= rest[i - 2 * half - 1] * rest[i - 2 * half - 1];
			count--;
		}
		if (i >= half)
			work[i - half] = sum > 0 ? sum / (double)count : 0;
	}
	memcpy(sorted, work, n * sizeof *work);
	median = robust_median(sorted, n);
	for (size_t i = 0; i < n; i++)
		mask[i] = work[i] <= 2 * median;
	return median;
}

enum num_status tones_fit(const double *x, size_t n, double start, int tones,
	const double *omega, double *coefficient, double *deviation, double *variance)
{
	enum { PASSES = 4 };
	size_t terms = 1 + 2 * (size_t)tones, runs = (n + RUN - 1) / RUN,
	       room = runs * RUN;
	struct basis basis;
	double(*term)[RUN] = malloc(terms * runs * sizeof *term);
	double *y = calloc(room, sizeof *y); /* x, filled up with zeros */
	double *rest = malloc(3 * room * sizeof *rest), level = 0;
	unsigned char *mask = calloc(room, 1);
	enum num_status status = !term || !y || !rest || !mask ? NUM_MEMORY
				 : n > 4 * terms               ? NUM_OK
							       : NUM_DOMAIN;

	memset(coefficient, 0, sizeof(double) * terms);
	if (!status) {
		make_basis(&basis, tones, omega);
		for (size_t r = 0; r < runs; r++)
			make_terms(&basis, start + (double)(r * RUN), term + r * terms);
		memcpy(rest, x, n * sizeof *x);
		coefficient[0] = robust_median(rest, n);
		memcpy(y, x, n * sizeof *x);
	}
	/* At first the rest is the record itself: it is even everywhere if tones
	 * dominate, otherwise between the pulses. */
	for (int pass = 0; !status && pass < PASSES; pass++) {
		for (size_t r = 0; r < runs; r++)
			sum_terms(term + r * terms, basis.terms, coefficient,
				rest + r * RUN);
		for (size_t i = 0; i < n; i++)
			rest[i] = x[i] - rest[i];
		level = mark_pulse_free(rest, n, rest + room, rest + 2 * room, mask);
		if (fit_masked(&basis, term, y, mask, runs, coefficient, variance)) {
			memset(mask, 1, n);
			if (fit_masked(
				    &basis, term, y, mask, runs, coefficient, variance))
				status = NUM_DOMAIN;
		}
	}
	if (deviation)
		*deviation = sqrt(level);
	free(term);
	free(y);
	free(rest);
	free(mask);
	return status;
}

/* What it has to exceed for a tone to be there: noise does with probability 2e-9. */
static const double CLEAR = 40;

/* Power of tone k relative to that from noise: chi-square with two degrees of freedom. */
static double significance(
	const double *coefficient, const double *variance, double deviation, int k)
{
	double sum = 0;

	for (int i = 1 + 2 * k; i <= 2 + 2 * k; i++)
		sum += coefficient[i] * coefficient[i] / variance[i];
	return sum / (deviation * deviation);
}

enum num_status tones_confirm(const double *y1, const double *y2, size_t n, double band,
	int *tones, double *omega)
{
	double c[2][TERMS_MAX], v[2][TERMS_MAX], d[2];
	enum num_status status = NUM_OK;
	int kept = 0;

	for (int i = 0; i < 2 && *tones && status == NUM_OK; i++)
		status = tones_fit(i ? y2 : y1, n, 0, *tones, omega, c[i], &d[i], v[i]);
	if (*tones == 0 || status != NUM_OK)
		return status == NUM_MEMORY ? NUM_MEMORY : NUM_OK;
	for (int k = 0; k < *tones; k++)
		if (significance(c[0], v[0], d[0], k) * band > CLEAR ||
			significance(c[1], v[1], d[1], k) * band > CLEAR)
			omega[kept++] = omega[k];
	*tones = kept;
	return NUM_OK;
}

void tones_remove(double *x, size_t n, double start, int tones, const double *omega,
	double at_a, const double *from, double at_b, const double *to)
{
	struct basis basis;
	double term[TERMS_MAX][RUN], change[TERMS_MAX];

	make_basis(&basis, tones, omega);
	for (int k = 0; k < basis.terms; k++)
		change[k] = k > 0 ? to[k] - from[k] : 0;
	for (size_t i = 0; i < n; i += RUN) {
		size_t m = n - i < RUN ? n - i : RUN;
		double first[RUN], more[RUN];

		make_terms(&basis, start + (double)i, term);
		sum_terms(term, basis.terms, from, first);
		sum_terms(term, basis.terms, change, more);
		for (size_t k = 0; k < m; k++) {
			double t = start + (double)(i + k);
			double part = at_b > at_a ? (t - at_a) / (at_b - at_a) : 0;
			double between = part < 0 ? 0 : part > 1 ? 1 : part;

			x[i + k] -=
				first[k] + between * (to[0] - from[0]) + part * more[k];
		}
	}
}

void tones_track_start(struct tones_track *t, int tones, const double *omega,
	long long start, size_t hop)
{
	*t = (struct tones_track){ .tones = tones,
		.flat = start,
		.hop = (long long)hop,
		.first = start + (long long)hop / 2 };
	memcpy(t->omega, omega, (size_t)tones * sizeof *omega);
}

/* Turns the phase of tone k. */
static void turn_phase(double *coefficient, int k, double angle)
{
	double co = cos(angle), si = sin(angle);
	double *c = coefficient + 1 + 2 * k, a = c[0], b = c[1];

	c[0] = a * co + b * si;
	c[1] = b * co - a * si;
}

/* Moves on by a knot at index at, whose coefficients are those of x[0 .. to - from) from
 * index from on. */
static enum num_status add_knot(
	struct tones_track *t, const double *x, long long from, long long to, double at)
{
	double *c = t->coefficient[0], fresh[1 + 2 * TONES_MAX];
	double variance[1 + 2 * TONES_MAX], deviation;
	enum num_status status = tones_fit(x, (size_t)(to - from), (double)from - at,
		t->tones, t->omega, fresh, &deviation, variance);

	if (status == NUM_MEMORY)
		return status;
	for (int k = 0; k < t->tones && t->knots > 0; k++) {
		turn_phase(c, k, t->omega[k] * (at - t->at));
		turn_phase(t->coefficient[1], k, t->omega[k] * (at - t->at));
	}
	t->before = t->at;
	t->at = at;
	if (t->keeps_offset)
		fresh[0] = 0;
	t->fits += status == NUM_OK;
	if (status == NUM_DOMAIN && t->knots > 0)
		memcpy(fresh, c, sizeof fresh);
	memmove(t->coefficient[1], c, 2 * sizeof fresh);
	memcpy(c, fresh, sizeof fresh);
	t->knots++;
	for (int k = 0; k < t->tones; k++)
		t->clear[k] = status == NUM_OK &&
			      significance(c, variance, deviation, k) > CLEAR;
	for (int k = 1; k <= 2 * t->tones; k++) {
		double step = c[k] - t->coefficient[1][k];
		double bend = step - t->coefficient[1][k] + t->coefficient[2][k];

		t->power[(k - 1) / 2] += c[k] * c[k] / 2;
		t->step += t->knots > 1 ? step * step : 0;
		t->bend += t->knots > 2 ? bend * bend : 0;
	}
	return NUM_OK;
}

/* The frequencies of clear tones become those by which they turned since the last knot,
 * as far as the tones stay apart. */
static void follow_turn(struct tones_track *t)
{
	const double gap = 2 * M_PI / (double)t->hop;
	const double *c = t->coefficient[0];
	double *old = t->coefficient[1];

	for (int k = 0; k < t->tones && t->knots > 1; k++) {
		double a = c[1 + 2 * k], b = c[2 + 2 * k];
		double turn = atan2(a * old[2 + 2 * k] - b * old[1 + 2 * k],
			a * old[1 + 2 * k] + b * old[2 + 2 * k]);
		double omega = t->omega[k] + turn / (t->at - t->before);
		double below = k > 0 ? t->omega[k - 1] : 0;
		double above = k + 1 < t->tones ? t->omega[k + 1] : M_PI;

		if (t->clear[k] && omega - below > gap && above - omega > gap) {
			t->omega[k] = omega;
			turn_phase(old, k, turn);
		}
	}
}

enum num_status tones_track_run(
	struct tones_track *t, double *x, long long begin, long long end, int ended)
{
	while (t->flat < end) {
		long long middle = t->first + t->knots * t->hop, to = middle + t->hop;
		long long from = middle - t->hop, until = middle;

		if (to > end && !ended)
			return NUM_OK;
		if (to > end) /* the last one describes the rest */
			to = until = end;
		from = from > t->flat ? from : t->flat;
		follow_turn(t);
		if (add_knot(t, x + (from - begin), from, to,
			    t->tones ? 0.5 * (double)(from + to) : (double)middle) ==
			NUM_MEMORY)
			return NUM_MEMORY;
		if (t->knots == 1 && until < end)
			continue; /* which way it changes is not known yet */
		tones_remove(x + (t->flat - begin), (size_t)(until - t->flat),
			(double)t->flat - t->at, t->tones, t->omega, t->before - t->at,
			t->coefficient[t->knots > 1], 0, t->coefficient[0]);
		t->flat = until;
	}
	return NUM_OK;
}

/* Mean of a sum of squares of differences that that many knots more than one give. */
static double mean_square(const struct tones_track *t, double sum, int more)
{
	return t->tones > 0 && t->knots > more
		       ? sum / (2.0 * t->tones * (t->knots - more))
		       : INFINITY;
}

double tones_track_change(const struct tones_track *t)
{
	return mean_square(t, t->step, 1);
}

double tones_track_left(const struct tones_track *t)
{
	return t->knots > 2 ? mean_square(t, t->bend, 2) / 2 : tones_track_change(t);
}
