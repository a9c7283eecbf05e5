/* by_fit.c - sections taken apart by joint fits, window by window */
#include "num/standing.h"
#include "signal/separate/separate_state.h"
#include <math.h>
#include <string.h>

/* Largest number of pulses that are searched for in n samples: three numbers of each may
 * be half of the values that the samples have.  Those are 4 SHAPE_BAND per duration in
 * the band of pulses on two channels; in a whole section, which may be no particles, only
 * those that stand out of the noise: so many more pulses describe whatever these are. */
static enum separate_status most_pulses(
	const struct separate *s, long long from, size_t n, int whole, int *most)
{
	double values = 4 * SHAPE_BAND * (double)n / s->cal.duration, standing;
	const struct channels y = channels_at(s, from);

	if (whole && standing_count(y.at, n, &standing) != NUM_OK)
		return SEPARATE_MEMORY;
	values = whole ? fmin(values, standing) : values;
	*most = (int)fmin(
		s->par.sources ? s->par.sources : 4 + values / 6, s->par.most_pulses);
	return SEPARATE_OK;
}

/* Subtracts a pulse from channels k of sensor 1 and k + 1 of sensor 2, whose noise is
 * that of the first components times noise. */
static void take_off(struct separate *s, long long from, const struct joint_pulse *p,
	int k, const double noise[2])
{
	struct buffer *one = &s->buffer[k], *two = &s->buffer[k + 1];
	size_t n = (size_t)(ready(s) - from);

	joint_add(&s->scene, p, -1 / noise[0], one->x + (from - one->begin), NULL, n);
	joint_add(&s->scene, p, -1 / noise[1], NULL,
		two->x + (from + s->cal.shift - two->begin), n);
}

/* Subtracts the first done of m pulses from the record and carries the others into the
 * next window; returns its first sample. */
static long long cut_section(
	struct separate *s, long long from, double boundary, int m, int done)
{
	double reach = shape_reach(s->cal.shape) * s->cal.duration;
	long long start = from + (long long)floor(boundary - reach + s->cal.delta_min);

	for (int i = 0; i < done; i++)
		take_off(s, from, &s->pulse[i], 0, (const double[]){ 1, 1 });
	for (int i = 0; i < done && s->with_both; i++) {
		const struct quadrature_pulse *b = &s->both[i];

		take_off(s, from,
			&(struct joint_pulse){ .t = b->t, .delta = b->delta, .a = b->b },
			2, s->quadrature.noise);
	}
	if (start <= from)
		start = from + 1;
	s->carried = m - done;
	for (int i = 0; i < s->carried; i++) {
		s->pulse[i] = s->pulse[done + i];
		s->pulse[i].t -= (double)(start - from);
	}
	return start;
}

/* Consecutive unresolved windows after which the rest of the section is reported as
 * unresolved.  Of 10404 particles in 20 records (scenes dense, poisson-50, group-25-dB
 * and group-skew of tests/matrix/scenes.tsv, seeds 11 and 12) 1, 2, 3 and 5 find 4974,
 * 5100, 5327 and 5383; of the rows 5.7, 5.8, 6.8 and 6.9 % are wrong. */
enum { PATIENCE = 3 };

/* Fits the pulses of a window to both components.  If the residual of the second exceeds
 * the noise, it is an event that the first does not show, or else they are doubted. */
static enum separate_status fit_quadrature(
	struct separate *s, struct account *a, struct foreign *event)
{
	struct channels y = channels_at(s, a->from);
	struct goodness *j = &a->goodness;
	int doubt;
	enum num_status status;

	status = quadrature_fit(&s->quadrature, s->joint, &s->scene, y.at, y.at + 2,
		s->pulse, a->m, j->chi2, s->both, &doubt);
	if (status == NUM_MEMORY)
		return SEPARATE_MEMORY;
	s->with_both = status == NUM_OK;
	if (!doubt || j->stretch == SEPARATE_UNRESOLVED)
		return SEPARATE_OK;
	if (a->whole && separate_find_foreign(s, a->from, a->n, 1, event) != NUM_OK)
		return SEPARATE_MEMORY;
	/* Without a pulse there is no row that could be marked as a misfit. */
	j->stretch = a->m > 0 ? SEPARATE_MISFIT : SEPARATE_UNRESOLVED;
	for (int i = 0; i < a->done; i++)
		j->pulse[i] = SEPARATE_MISFIT;
	return SEPARATE_OK;
}

/* Explains a window that is no event of another kind. */
static enum separate_status explain(
	struct separate *s, struct account *a, struct foreign *event)
{
	enum separate_status status = SEPARATE_OK;

	if (!s->par.sources && (a->r.negative || !separate_is_described(a)))
		status = separate_try_rivals(s, a);
	else if (separate_is_described(a))
		separate_follow(s, a);
	return status == SEPARATE_OK && has_quadrature(s) ? fit_quadrature(s, a, event)
							  : status;
}

enum separate_status separate_fit_section(
	struct separate *s, long long from, long long to, int cut, long long *next)
{
	struct account a = { .cut = cut, .m = s->carried };
	enum separate_status status;
	struct foreign event = { .verdict = SEPARATE_MISFIT };
	int unresolved, shorter;
	long before, after;

	/* The noise on either side of a section shows that no pulse extends there. */
	before = s->window == SEEK ? sections_aside(s->sections, 0) : 0;
	before = from - s->buffer[0].begin < before ? (long)(from - s->buffer[0].begin)
						    : before;
	after = cut ? 0 : sections_aside(s->sections, 1);
	after = ready(s) - to < after ? (long)(ready(s) - to) : after;
	a.from = from - before;
	a.n = (size_t)(to - from + before + after);
	a.whole = !cut && s->window == SEEK && !s->par.sources;
	status = most_pulses(s, from, (size_t)(to - from), a.whole, &s->scene.max_pulses);
	if (status != SEPARATE_OK)
		return status;
	s->scene.quiet[0] = (double)before;
	s->scene.quiet[1] = (double)after;
	for (int c = 0; c < 2; c++)
		s->scene.tone_knot[c] = (double)(s->buffer[c].tones.first - from +
						 before - (c ? s->cal.shift : 0));
	separate_hide(s, a.from, a.n);
	if (a.m > s->scene.max_pulses)
		a.m = s->scene.max_pulses;
	memcpy(a.pulse, s->pulse, sizeof a.pulse);
	s->scene.give_up = cut && !s->par.sources;
	/* A crowd may go on beside what is not described. */
	s->scene.hopeless = a.whole;
	status = separate_fit_window(s, channels_at(s, a.from).at, &a);
	s->scene.give_up = 0;
	if (status == SEPARATE_OK && separate_is_described(&a))
		status = separate_fit_without_common(s, &a);
	if (status == SEPARATE_OK &&
		(s->par.sources || a.goodness.stretch != SEPARATE_UNRESOLVED))
		separate_keep_fit(s, &a);
	if (status == SEPARATE_OK && a.whole && (a.m > 1 || !separate_is_described(&a)) &&
		separate_find_foreign(s, a.from, a.n, 0, &event) != NUM_OK)
		return SEPARATE_MEMORY;
	if (status == SEPARATE_OK && !verdict_is_foreign(event.verdict))
		status = explain(s, &a, &event);
	if (status == SEPARATE_OK && verdict_is_foreign(event.verdict)) {
		s->carried = s->failures = 0;
		*next = to;
		return s->same_shock ? SEPARATE_OK
				     : separate_give_event(s, a.from,
					       a.from + (long long)a.n, &event);
	}
	for (int i = 0; i < a.m; i++) {
		s->pulse[i].t -= (double)before;
		s->both[i].t -= (double)before;
	}
	a.boundary -= (double)before;
	if (status != SEPARATE_OK)
		return status;
	unresolved = a.goodness.stretch == SEPARATE_UNRESOLVED && !s->par.sources;
	/* In shorter windows, most pulses would be cut by the ends. */
	shorter = unresolved && (cut || a.r.full) &&
		  (double)(to - from) >
			  2 * fmax(10, 6 * shape_reach(s->cal.shape)) * s->cal.duration;
	if (!shorter)
		s->failures = unresolved ? s->failures + 1 : 0;
	if (shorter || (unresolved && (!cut || s->failures == PATIENCE))) {
		/* A short section is not unresolved because of the number of its pulses.
		 */
		s->strange = !shorter && !cut && s->window == SEEK && !a.r.full;
		s->window = shorter ? SHORTER : DENSE;
		s->span = (size_t)(to - from) / 2;
		s->carried = 0;
		*next = from;
		return SEPARATE_OK;
	}
	if (unresolved) {
		if (separate_dense_section(s, from, from + (long long)a.boundary) !=
			SEPARATE_OK)
			return SEPARATE_MEMORY;
	} else if (separate_give_pulses(s, from, to, a.m, a.done, &a.goodness) !=
		   SEPARATE_OK) {
		return SEPARATE_MEMORY;
	}
	s->counters.singles += !cut && a.m == 1 && s->window == SEEK;
	*next = to;
	if (cut)
		*next = cut_section(s, from, a.boundary, a.m, a.done);
	else
		s->carried = 0;
	return SEPARATE_OK;
}
