/* foreign_event.c - sections that hold an event that is no particle */
#include "signal/separate/separate_state.h"
#include <math.h>

/* 1 if the pulse has two lobes, so that a bubble, which has one, is no pulse.  Between
 * the lobes of a particle's pulse half of the distance lies at equal areas. */
static int has_two_lobes(const struct shape *shape)
{
	enum { STEPS = 400 };
	double reach = shape_reach(shape), T = STEPS / (2 * reach);
	double value[STEPS], sum = 0, size = 0;

	shape_sample(shape, 0.5 * STEPS, T, 0, STEPS, value, NULL, NULL);
	for (int i = 0; i < STEPS; i++) {
		sum += value[i];
		size += fabs(value[i]);
	}
	return fabs(sum) < 0.5 * size;
}

static struct foreign_stretch stretch_at(
	const struct separate *s, long long at_1, long long at_2, size_t n, int component)
{
	return (struct foreign_stretch){
		.y = { channels_at(s, at_1).at[2 * component],
			channels_at(s, at_2).at[2 * component + 1] },
		.hidden = { s->scene.hidden[0], s->scene.hidden[1] },
		.n = n,
		.shift = (size_t)s->cal.shift,
		.lost = s->scene.lost,
		.duration = s->cal.duration
	};
}

/* An event at one sensor, in [from, from + n), is part of a shock if the other sensor has
 * the same at the same time, which is a transit time away in the aligned channels. */
static void look_for_other_half(struct separate *s, long long from, size_t n,
	int component, struct foreign *event)
{
	int at_2 = isnan(event->t[0]);
	long shift = s->cal.shift;
	long long begin = at_2 ? from + shift : from, end = begin + (long long)n;
	struct foreign shock;
	struct foreign_stretch stretch;

	if (shift <= 0 || end > s->buffer[0].clean || end > s->buffer[1].clean ||
		begin < s->buffer[1].begin)
		return;
	stretch = stretch_at(s, begin, begin - shift, n, component);
	for (int c = 0; c < 2; c++)
		if (stretch.hidden[c])
			stretch.hidden[c] =
				s->buffer[c].hidden + (begin - s->buffer[c].begin);
	foreign_at_once(&stretch, &shock);
	if (shock.verdict != SEPARATE_SHOCK)
		return;
	s->same_shock = begin < s->shock_end;
	s->shock_end = end;
	shock.t[!at_2] += (double)(at_2 ? shift : -shift);
	*event = shock;
}

enum num_status separate_find_foreign(struct separate *s, long long from, size_t n,
	int component, struct foreign *event)
{
	struct foreign_stretch stretch = stretch_at(s, from, from, n, component);
	int lobes = has_two_lobes(s->cal.shape);

	s->same_shock = 0;
	if (foreign_find(&stretch, lobes ? s->scene.delta_min : INFINITY,
		    s->scene.delta_max, event) != NUM_OK)
		return NUM_MEMORY;
	if (component > 0) /* in units of the noise of the first */
		event->amplitude *= s->quadrature.noise[isnan(event->t[0])];
	if (event->verdict == SEPARATE_TRANSIENT)
		look_for_other_half(s, from, n, component, event);
	return NUM_OK;
}
