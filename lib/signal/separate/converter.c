/* converter.c - see converter.h */
#include "signal/separate/converter.h"
#include <math.h>

/* A limit must have been seen OFTEN times, and TIMES as often as the next value: in a
 * parabola quantised to a few steps, the top occurs ROUND = 1 / (sqrt 2 - 1) times as
 * often as the step below it. */
static const double OFTEN = 8, TIMES = 4, ROUND = 1 + M_SQRT2;

/* Probability below which a run of equal values was not measured. */
static const double RARELY = 1e-9;

static void see(struct converter_limit *l, double x)
{
	if (l->times == 0 || x > l->value) {
		l->next = l->value;
		l->next_times = l->times;
		l->value = x;
		l->times = 1;
	} else if (x == l->value) {
		l->times++;
	} else if (l->next_times == 0 || x > l->next) {
		l->next = x;
		l->next_times = 1;
	} else if (x == l->next) {
		l->next_times++;
	}
}

/* Components are turned back with an error of a few units in the last place. */
static const double ROUNDING = 1e-14;

static int is_at(const struct converter_limit *l, double x)
{
	return fabs(x - l->value) <= ROUNDING * fabs(l->value) && l->times >= OFTEN &&
	       l->times > TIMES * l->next_times;
}

int converter_saturates(const struct converter *c, double x)
{
	return is_at(&c->limit[0], x) || is_at(&c->limit[1], -x) ||
	       (c->blurred[0] && x >= c->from[0]) || (c->blurred[1] && -x >= c->from[1]);
}

/* Of x[0..n) those in a band at the top, and those in the next band. */
static void count(const double *x, size_t n, double top, double width, double in[2])
{
	in[0] = in[1] = 0;
	for (size_t i = 0; i < n; i++) {
		in[0] += x[i] > top - width;
		in[1] += x[i] > top - 2 * width && x[i] <= top - width;
	}
}

/* Copies the m samples beyond half of the way from the mean to the largest one, and the
 * peak of each of the e excursions that they make. */
static void excursions(const double *x, double sign, const unsigned char *hidden,
	size_t n, double half, double *beyond, size_t *m, double *peak, size_t *e)
{
	int inside = 0;

	*m = *e = 0;
	for (size_t i = 0; i < n; i++) {
		double v = sign * x[i];

		if (hidden[i])
			continue;
		if (v > half) {
			beyond[(*m)++] = v;
			*e += !inside;
			peak[*e - 1] = inside ? fmax(peak[*e - 1], v) : v;
		}
		inside = v > half;
	}
}

/* Where a limit begins: half a width below the band at the top that holds most samples
 * beyond ROUND times those of the next band.  No band is narrower than the step from the
 * largest value to the next one, so that neither is empty because values are rounded.
 * Without the half, 10 to 17 of 60 rows are doubted in four records with a limit of 0.8 V
 * and noise of 20 or 30 mV behind it; widths in steps of sqrt 2 miss a limit in two of
 * them.  work: 2 n. */
static int find_blurred(const double *x, double sign, const unsigned char *hidden,
	size_t n, double *work, double *from)
{
	double sum = 0, top = -INFINITY, next = -INFINITY, shown = 0, middle, most = 0;
	double *peak = work + n;
	size_t m, e;

	for (size_t i = 0; i < n; i++) {
		double v = sign * x[i];

		if (hidden[i])
			continue;
		if (v != top)
			next = fmax(next, fmin(v, top));
		top = fmax(top, v);
		sum += v;
		shown++;
	}
	middle = sum / shown;
	excursions(x, sign, hidden, n, (middle + top) / 2, work, &m, peak, &e);
	for (double width = fmax(top - next, ldexp(top - middle, -16));
		(double)e >= OFTEN && width < (top - middle) / 4; width *= 1.1) {
		double samples[2], peaks[2];

		count(work, m, top, width, samples);
		count(peak, e, top, width, peaks);
		if (peaks[0] < OFTEN || peaks[0] <= TIMES * peaks[1] ||
			samples[0] - ROUND * samples[1] <= most)
			continue;
		most = samples[0] - ROUND * samples[1];
		*from = top - 1.5 * width;
	}
	return most > 0;
}

int converter_find_blurred(struct converter *c, const double *x, double sign,
	const unsigned char *hidden, size_t n, double *work)
{
	for (int side = 0; side < 2; side++)
		c->blurred[side] = find_blurred(
			x, side ? -sign : sign, hidden, n, work, &c->from[side]);
	return c->blurred[0] || c->blurred[1];
}

/* Takes in x, which follows c->last: votes for the usual value, and counts the run that
 * has ended if it was measured and had that value. */
static void watch_usual(struct converter *c, double x)
{
	if (c->run > 0 && x != c->last && c->last == c->usual && !c->stands) {
		c->usual_samples += (double)c->run;
		c->usual_repeats += (double)(c->run - 1);
	}
	if (c->lead == 0 && x != c->usual) {
		c->usual = x;
		c->usual_samples = c->usual_repeats = 0;
	}
	c->lead += x == c->usual ? 1 : -1;
}

size_t converter_next(struct converter *c, double *sample)
{
	double share = (c->repeats + 1) / (c->samples + 2), x = *sample;

	if (isnan(x)) {
		*sample = c->last;
		return 1;
	}
	watch_usual(c, x);
	c->run = c->samples > 0 && x == c->last ? c->run + 1 : 1;
	if (x == c->usual && c->usual_samples > 0)
		share = fmax(share, (c->usual_repeats + 1) / (c->usual_samples + 2));
	c->last = x;
	c->samples++;
	see(&c->limit[0], x);
	see(&c->limit[1], -x);
	if ((double)(c->run - 1) * log(share) >= log(RARELY)) {
		c->repeats += c->run > 1;
		c->stands = 0;
		return converter_saturates(c, x) ? 1 : 0;
	}
	if (c->stands)
		return 1;
	c->stands = 1;
	return c->run;
}
