/* queue.c - the queue of rows, and of sections to report, which are held until tested
 */
#include "num/room.h"
#include "signal/separate/separate_state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct entry *separate_queue_entry(struct separate *s)
{
	if (room_for(&s->queue, &s->capacity, s->count + 1, sizeof *s->queue))
		return NULL;
	s->queue[s->count] = (struct entry){ .row = { .section = s->number,
						     .t1_se = NAN,
						     .t2_se = NAN,
						     .delay_se = NAN,
						     .amplitude_se = NAN,
						     .correlation = NAN,
						     .phase = NAN,
						     .phase_se = NAN,
						     .chi2 = NAN,
						     .most = NAN } };
	return &s->queue[s->count++];
}

enum separate_status separate_queue_report(
	struct separate *s, const struct separate_section *section, size_t rows)
{
	struct report *r;

	if (!s->par.on_section)
		return SEPARATE_OK;
	if (room_for(&s->report, &s->report_capacity, s->reports + 1, sizeof *s->report))
		return SEPARATE_MEMORY;
	r = &s->report[s->reports++];
	memset(r, 0, sizeof *r);
	r->section = *section;
	if (section->dense)
		r->dense = *section->dense;
	r->source = s->source;
	s->source = NULL;
	r->first = s->count - rows;
	r->rows = rows;
	return SEPARATE_OK;
}

static void give_reports(struct separate *s)
{
	for (size_t i = 0; i < s->reports; i++) {
		struct report *r = &s->report[i];

		if (r->section.dense)
			r->section.dense = &r->dense;
		r->section.source = r->source;
		/* from means to samples of the record */
		r->section.begin *= s->ratio;
		r->section.end *= s->ratio;
		campbell_scale(&r->dense, 1, 1. / s->ratio);
		for (size_t k = r->first; k < r->first + r->rows; k++)
			if (s->queue[k].evidence.doubted &&
				r->section.verdict < SEPARATE_UNRESOLVED)
				r->section.verdict = SEPARATE_MISFIT;
		s->par.on_section(s->par.context, &r->section);
		free(r->source);
	}
	s->reports = 0;
}

/* Doubts those of the n rows not yet tested that may be two particles, parts of two, or
 * none; a holds n.  Rows doubted already tell how often one pulse follows another as
 * well.
 */
static void test_pairs(struct separate *s, struct evidence *a, size_t n)
{
	struct entry *q = s->queue + s->tested;
	double half = validation_half(s->validation);
	struct flow flow;
	size_t m = 0;

	validation_flow(s->validation, &flow);
	for (size_t i = 0; i < n; i++)
		if (q[i].evidence.pulse) {
			a[m] = q[i].evidence;
			/* A delay found is that of the flow and its error. */
			if (half > 0 && a[m].var > 0)
				a[m].exchange *= exp(fmin(
					-0.5 * q[i].more_square / (flow.var + a[m].var),
					300));
			a[m++].doubted = q[i].row.verdict >= SEPARATE_MISFIT;
		}
	/* Errors of a shape decay in two durations, but it may be known as far as it
	 * reaches only, and then pulses are fitted to what lies beyond. */
	together_test(s->together, fmax(2, 2 * shape_reach(s->cal.shape)), a, m);
	m = 0;
	for (size_t i = 0; i < n; i++)
		if (q[i].evidence.pulse && a[m++].doubted &&
			q[i].row.verdict < SEPARATE_MISFIT) {
			q[i].row.verdict = SEPARATE_MISFIT;
			if (fmax(a[m - 1].shape, a[m - 1].half) > a[m - 1].pair)
				s->counters.misfits++;
			else {
				s->counters.together++;
				q[i].row.together = 1;
			}
		}
}

enum separate_status separate_test_rows(struct separate *s)
{
	size_t n = s->count - s->tested;
	struct evidence *e = malloc((n ? n : 1) * sizeof *e);

	if (!e)
		return SEPARATE_MEMORY;
	for (size_t i = 0; i < n; i++)
		e[i] = s->queue[s->tested + i].evidence;
	validation_test(s->validation, e, n);
	for (size_t i = 0; i < n; i++) {
		struct entry *q = &s->queue[s->tested + i];

		q->evidence.doubted = e[i].doubted;
		/* Of events, those of no name are among the rows tested. */
		s->counters.misfits +=
			e[i].doubted && (!verdict_is_foreign(q->row.verdict) ||
						q->row.verdict == SEPARATE_TRANSIENT);
		if (!e[i].doubted || q->row.verdict >= SEPARATE_UNRESOLVED)
			continue;
		s->counters.foreign += q->evidence.fits;
		q->row.verdict = SEPARATE_MISFIT;
	}
	test_pairs(s, e, n);
	free(e);
	s->tested = s->count;
	give_reports(s);
	return SEPARATE_OK;
}

int separate_next(struct separate *s, struct transit *p)
{
	if (s->given == s->tested) {
		if (s->given == s->count)
			s->given = s->tested = s->count = 0;
		return 0;
	}
	*p = s->queue[s->given++].row;
	/* A mean belongs to the middle of its samples. */
	p->t1 = p->t1 * s->ratio + 0.5 * (s->ratio - 1);
	p->t2 = p->t2 * s->ratio + 0.5 * (s->ratio - 1);
	p->t1_se *= s->ratio;
	p->t2_se *= s->ratio;
	p->delay_se *= s->ratio;
	return 1;
}
