/* window.c - one window of a section: the joint fit of its pulses and its goodness */
#include "num/robust.h"
#include "signal/separate/separate_state.h"
#include <math.h>
#include <string.h>

/* Position at which a window is cut: the widest gap between arrivals in its
 * later half that leaves room for the pulses behind it. */
static double choose_cut(const struct separate *s, const struct account *a)
{
	double n = (double)a->n, lo = 0.4 * n, widest = -1, cut = 0;
	double hi = n - 2.2 * shape_reach(s->cal.shape) * s->cal.duration;

	for (int i = 0; i <= a->m; i++) {
		double from = i ? a->pulse[i - 1].t : 0,
		       to = i < a->m ? a->pulse[i].t : n;

		if (from < lo)
			from = lo;
		if (to > hi)
			to = hi;
		if (to - from > widest) {
			widest = to - from;
			cut = (from + to) / 2;
		}
	}
	return cut;
}

void separate_hide(struct separate *s, long long from, size_t n)
{
	for (int c = 0; c < 2; c++) {
		const struct buffer *t = &s->buffer[c];
		const unsigned char *flags =
			t->hidden + (from + (c ? s->cal.shift : 0) - t->begin);

		s->scene.hidden[c] =
			!s->cal.whitening.tap && memchr(flags, 1, n) ? flags : NULL;
	}
}

enum separate_status separate_fit_window(
	struct separate *s, const double *const y[], struct account *a)
{
	enum joint_status status =
		joint_fit(s->joint, &s->scene, y[0], y[1], a->n, a->pulse, &a->m, &a->r);

	if (status != JOINT_OK)
		return status == JOINT_MEMORY ? SEPARATE_MEMORY : SEPARATE_WIDE;
	s->counters.fits++;
	s->counters.steps += (double)a->r.steps;
	s->counters.searches += (double)a->r.searches;
	memcpy(s->pulse, a->pulse, sizeof s->pulse);
	a->boundary = a->cut ? choose_cut(s, a) : INFINITY;
	a->done = 0;
	while (a->done < a->m && a->pulse[a->done].t < a->boundary)
		a->done++;
	goodness_of_fit(s->joint, a->done, a->boundary,
		s->cal.chi2 < CALIBRATE_TOLERABLE || s->cal.dense, &a->goodness);
	return SEPARATE_OK;
}

/* Standard deviation of the difference of two delays: by those of the window, where they
 * are eight or more, or by the range that is searched.  That is at least twice as wide as
 * that of the delays seen, and two that are spread evenly over a range differ by 1 / sqrt
 * 6 of it in root mean square. */
static double delay_scatter(const struct separate *s, const struct account *a)
{
	double widest = 0.5 * (s->scene.delta_max - s->scene.delta_min) / sqrt(6);
	double x[JOINT_PULSES_MAX];

	if (a->m < 8)
		return widest;
	for (int i = 0; i < a->m; i++)
		x[i] = a->pulse[i].delta;
	return fmin(widest, M_SQRT2 * robust_spread(x, (size_t)a->m));
}

void separate_keep_fit(struct separate *s, const struct account *a)
{
	double scatter = delay_scatter(s, a);

	for (int i = 0; i < a->m; i++)
		if (has_quadrature(s) || isinf(s->cal.transit))
			memset(s->pair_odds[i], 0, sizeof s->pair_odds[i]);
		else
			joint_pair_odds(s->joint, i, scatter, s->pair_odds[i]);
}

int separate_is_described(const struct account *a)
{
	return a->goodness.stretch < SEPARATE_MISFIT;
}
