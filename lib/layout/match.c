#include "layout/match.h"
#include "num/deviates.h"
#include <math.h>

static const double deviations = 3; /* of a window to either side: 99.7 % of arrivals */

/* Coordinate k of point i of a sequence that fills the unit cube of so many dimensions
 * evenly: multiples of powers of 1/g, g^(dimensions + 1) = g + 1, the golden ratio of one
 * dimension (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences"). */
static double coordinate(int i, int k, int dimensions)
{
	double g = 1.5, u;

	for (int n = 0; n < 40; n++)
		g = pow(1 + g, 1. / (dimensions + 1));
	u = 0.5 + (i + 1) * pow(g, -(k + 1));
	return fmax(u - floor(u), 1e-12);
}

static double normal(int i, int k, int dimensions)
{
	return normal_quantile(coordinate(i, k, dimensions));
}

/* Of particle i, by its place in the section and its own deviation from the oil. */
static double slowness(const struct match *m, int i, int dimensions)
{
	return traffic_slowness(&m->par->traffic, coordinate(i, 0, dimensions),
		2 * coordinate(i, 1, dimensions) - 1);
}

void match_begin(struct match *m, const struct layout_par *par, int coils)
{
	const double alone = 0;
	int own = 2 + 2 * coils, others = 2 + coils;
	struct bound b;

	bound_closed(&par->bound, &alone, 1, &b);
	m->par = par;
	m->coils = coils;
	m->time_error = b.time;
	m->width_error = b.velocity / (par->bound.velocity * par->bound.velocity);
	m->fastest = traffic_slowness(&par->traffic, 0, -1);
	m->slowest = traffic_slowness(&par->traffic, 1, 1);
	for (int i = 0; i < MATCH_OWN; i++) {
		m->own[i] = slowness(m, i, own);
		for (int k = 0; k < coils; k++) {
			m->own_time[i][k] = normal(i, 2 + 2 * k, own);
			m->own_width[i][k] = normal(i, 3 + 2 * k, own);
		}
	}
	for (int i = 0; i < MATCH_OTHERS; i++) {
		m->other[i] = slowness(m, i, others);
		for (int k = 0; k < coils; k++)
			m->other_time[i][k] = normal(i, 2 + k, others);
	}
}

/* Where the pulse is searched at a coil, from what the coils before it have measured:
 * in the range of the traffic from the last of them, and around the line through them
 * all. */
struct window {
	int coil;
	double low, width; /* the range: from the arrival at the coil before */
	double mean;       /* position of the coils before */
	double precision;  /* of the slowness by them, one over its variance */
	double narrow;     /* width around the line; INFINITY: it is not used */
};

struct windows {
	int count;
	struct window window[LAYOUT_COILS];
};

/* By arrivals and widths at the coils before, whose mean has independent errors. */
static double prediction_error(
	const struct match *m, const double *coil, struct window *w)
{
	double s2 = m->time_error * m->time_error, sum = 0, away;
	int n = w->coil;

	w->mean = 0;
	for (int k = 0; k < n; k++)
		w->mean += coil[k] / n;
	for (int k = 0; k < n; k++)
		sum += (coil[k] - w->mean) * (coil[k] - w->mean);
	w->precision = n / (m->width_error * m->width_error) + sum / s2;
	away = coil[n] - w->mean;
	return sqrt(s2 * (1 + 1. / n) + away * away / w->precision);
}

static void find_windows(
	const struct match *m, const double *coil, int by_width, struct windows *all)
{
	double error = deviations * sqrt(2) * m->time_error;

	*all = (struct windows){ .count = 0 };
	for (int k = 1; k < m->coils; k++) {
		struct window *w = &all->window[all->count];
		double way = coil[k] - coil[k - 1];

		if (!(way > 0))
			continue;
		*w = (struct window){ .coil = k,
			.low = way * m->fastest - error,
			.width = way * (m->slowest - m->fastest) + 2 * error,
			.narrow = INFINITY };
		if (by_width || all->count > 0)
			w->narrow = 2 * deviations * prediction_error(m, coil, w);
		all->count++;
	}
}

/* Where the windows of own particle i begin, after it has passed the first coil, and how
 * wide they are. */
static void place_windows(const struct match *m, const double *coil,
	const struct windows *all, int i, double *begin, double *width)
{
	double precision = 1 / (m->width_error * m->width_error),
	       s2 = m->time_error * m->time_error;
	double arrival[LAYOUT_COILS] = { 0 }, slow[LAYOUT_COILS] = { 0 };

	for (int k = 0; k < m->coils; k++) {
		arrival[k] = m->own[i] * (coil[k] - coil[0]) +
			     m->time_error * m->own_time[i][k];
		slow[k] = m->own[i] + m->width_error * m->own_width[i][k];
	}
	for (int j = 0; j < all->count; j++) {
		const struct window *w = &all->window[j];
		double time = 0, sum = 0, end;

		begin[j] = arrival[w->coil - 1] + w->low;
		width[j] = w->width;
		if (isinf(w->narrow))
			continue;
		for (int k = 0; k < w->coil; k++) {
			time += arrival[k] / w->coil;
			sum += precision * slow[k] +
			       (coil[k] - w->mean) * arrival[k] / s2;
		}
		time += (coil[w->coil] - w->mean) * sum / w->precision;
		end = fmin(begin[j] + w->width, time + w->narrow / 2);
		begin[j] = fmax(begin[j], time - w->narrow / 2);
		width[j] = fmax(end - begin[j], 0);
	}
}

/* Length of the union of intervals, which it sorts. */
static double union_of(double *begin, double *width, int n)
{
	double length = 0, end = -INFINITY;

	for (int i = 1; i < n; i++)
		for (int j = i; j > 0 && begin[j] < begin[j - 1]; j--) {
			double b = begin[j], w = width[j];

			begin[j] = begin[j - 1];
			width[j] = width[j - 1];
			begin[j - 1] = b;
			width[j - 1] = w;
		}
	for (int i = 0; i < n; i++) {
		double last = fmax(end, begin[i] + width[i]);

		length += last - fmax(end, begin[i]);
		end = last;
	}
	return length;
}

/* The mean over the others of the time during which they would be in one of the windows
 * that begin here and are so wide. */
static double exposed(const struct match *m, const double *coil,
	const struct windows *all, const double *begin, const double *width)
{
	double sum = 0;

	if (all->count == 1)
		return width[0];

	for (int i = 0; i < MATCH_OTHERS; i++) {
		double from[LAYOUT_COILS], wide[LAYOUT_COILS];

		for (int j = 0; j < all->count; j++) {
			const struct window *w = &all->window[j];

			from[j] = begin[j] - m->other[i] * (coil[w->coil] - coil[0]) -
				  m->time_error * m->other_time[i][w->coil];
			wide[j] = width[j];
		}
		sum += union_of(from, wide, all->count);
	}
	return sum / MATCH_OTHERS;
}

/* The probability; 0 as soon as it is known to be below least: the time during which
 * another particle is in one of the windows is at least the width of the widest. */
static double unique(
	const struct match *m, const double *coil, int by_width, double least)
{
	const struct traffic *t = &m->par->traffic;
	double begin[MATCH_OWN][LAYOUT_COILS], width[MATCH_OWN][LAYOUT_COILS];
	double sum = 0, most = 0;
	struct windows all;

	find_windows(m, coil, by_width, &all);
	if (all.count == 0)
		return 1;
	for (int i = 0; i < MATCH_OWN; i++) {
		double widest = 0;

		place_windows(m, coil, &all, i, begin[i], width[i]);
		for (int j = 0; j < all.count; j++)
			widest = fmax(widest, width[i][j]);
		most += traffic_unique(t, widest) / MATCH_OWN;
	}
	if (most < least)
		return 0;
	for (int i = 0; i < MATCH_OWN; i++)
		sum += traffic_unique(t, exposed(m, coil, &all, begin[i], width[i]));
	return sum / MATCH_OWN;
}

double match_unique(const struct match *m, const double *coil, int by_width)
{
	return unique(m, coil, by_width, 0);
}

int match_reaches(const struct match *m, const double *coil, double least)
{
	return unique(m, coil, 1, least) >= least;
}
