/* by_masks.c - sections taken apart by masks */
#include "signal/separate/separate_state.h"
#include <math.h>
#include <string.h>

/* Arrival (zero crossing between the lobes) and amplitude of the one pulse in x. */
static void measure_pulse(const double *x, size_t n, double *t, double *a)
{
	size_t high = 0, low = 0;

	for (size_t i = 1; i < n; i++) {
		if (x[i] > x[high])
			high = i;
		if (x[i] < x[low])
			low = i;
	}
	*t = ((double)high + (double)low) / 2;
	*a = (x[high] - x[low]) / 2;
}

/* Compares the pulses that masks have found in n samples with those of a joint fit.  A
 * mask divides one pulse into several if noise moves the points of its histogram; a pulse
 * farther than a quarter of a duration from every pulse of the fit is a misfit. */
static enum separate_status confirm(struct separate *s, const struct channels *y,
	size_t n, const double *t, int m, enum separate_verdict *verdict)
{
	struct account a = { .n = n };
	int taken[JOINT_PULSES_MAX] = { 0 };
	enum separate_status status;

	s->scene.max_pulses = s->par.most_pulses;
	status = separate_fit_window(s, y->at, &a);
	if (status != SEPARATE_OK)
		return status;
	for (int k = 0; k < m; k++) {
		int best = -1;

		for (int i = 0; i < a.m; i++)
			if (!taken[i] &&
				(best < 0 || fabs(a.pulse[i].t - t[k]) <
						     fabs(a.pulse[best].t - t[k])))
				best = i;
		verdict[k] = m > 1 || a.m > 1 ? SEPARATE_OVERLAP : SEPARATE_ALONE;
		if (best >= 0 && fabs(a.pulse[best].t - t[k]) < s->cal.duration / 4)
			taken[best] = 1;
		else
			verdict[k] = SEPARATE_MISFIT;
	}
	return SEPARATE_OK;
}

enum separate_status separate_mask_section(
	struct separate *s, long long from, long long to)
{
	struct masks_source source[MASKS_SOURCES_MAX];
	size_t n = (size_t)(to - from);
	struct channels y = channels_at(s, from);
	double noise = separate_noise_at(s, 0, (double)from);
	int m;
	double t[MASKS_SOURCES_MAX], a[MASKS_SOURCES_MAX];
	enum separate_verdict verdict[MASKS_SOURCES_MAX], all = SEPARATE_ALONE;
	enum separate_status status;

	if (masks_find(s->masks, y.at[0], y.at[1], n, source, &m) != NUM_OK ||
		separate_reserve_sources(s, (size_t)m * n) != SEPARATE_OK)
		return SEPARATE_MEMORY;
	/* A single source needs no demixing. */
	if (m == 1)
		memcpy(s->source, y.at[0], n * sizeof *s->source);
	for (int k = 0; k < m && m > 1; k++)
		masks_separate(s->masks, k, s->source + (size_t)k * n);
	s->counters.singles += m == 1;
	s->counters.masks += m > 1;
	s->counters.masks_skipped += m == 1;
	for (int k = 0; k < m; k++) {
		double *x = s->source + (size_t)k * n;

		for (size_t i = 0; i < n; i++)
			x[i] *= noise;
		measure_pulse(x, n, &t[k], &a[k]);
	}
	status = confirm(s, &y, n, t, m, verdict);
	if (status != SEPARATE_OK)
		return status;
	for (int k = 0; k < m; k++) {
		struct entry *entry = separate_queue_entry(s);
		struct transit *p;

		if (!entry)
			return SEPARATE_MEMORY;
		p = &entry->row;
		entry->evidence.fits = verdict[k] != SEPARATE_MISFIT;
		entry->evidence.group = ++s->group;
		p->sources = m;
		p->t1 = (double)from + t[k];
		p->t2 = p->t1 + (double)s->cal.shift + source[k].delta;
		p->amplitude = a[k];
		p->verdict = verdict[k];
		all = verdict[k] > all ? verdict[k] : all;
		s->counters.rows++;
	}
	return separate_queue_report(s,
		&(struct separate_section){ .number = s->number,
			.begin = from,
			.end = to,
			.sources = m,
			.chi2 = NAN,
			.verdict = all,
			.masks = s->masks },
		(size_t)m);
}
