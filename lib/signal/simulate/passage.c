/* passage.c - drawing particles and their arrivals */
#include "signal/simulate/passage.h"
#include "num/philox.h"
#include <math.h>
#include <stdlib.h>

/* Uniform numbers of one particle, by address. */
enum { DRAW_ARRIVAL, DRAW_DIAMETER, DRAW_RADIUS, DRAW_LAG, DRAWS };

struct arrivals {
	struct arrivals_par par;
	uint64_t done; /* particles so far */
	double at;     /* time used up in the window beyond the gaps, s */
	double last;
};

static double draw(uint64_t seed, uint32_t realisation, uint64_t index, int what)
{
	return philox_uniform(
		seed, realisation, RNG_PARTICLE, DRAWS * index + (uint64_t)what);
}

struct arrivals *arrivals_new(const struct arrivals_par *par)
{
	struct arrivals *a = calloc(1, sizeof *a);

	if (!a)
		return NULL;
	a->par = *par;
	if (a->par.burst == 0)
		a->par.burst = par->number;
	return a;
}

void arrivals_free(struct arrivals *arrivals)
{
	free(arrivals);
}

static int next_poisson(struct arrivals *a, double u, double *time)
{
	double mean = fmax(1 / a->par.rate - a->par.gap, 0);

	/* the dead time counts between neighbours, not before the first */
	a->at += (a->done ? a->par.gap : 0) - mean * log(u);
	*time = a->par.start + a->at;
	return a->at <= a->par.span;
}

/* The k-th smallest of what is left is drawn from the smallest up: of m uniform numbers
 * on [0, 1] the smallest is 1 - u^(1/m). */
static int next_ordered(struct arrivals *a, double u, double *time)
{
	uint64_t i = a->done % a->par.burst, n = a->par.burst, burst = a->done / n;
	double slack = a->par.span - (double)(n - 1) * a->par.gap;

	if (n > a->par.number - (a->done - i))
		n = a->par.number - (a->done - i);
	if (i == 0)
		a->at = 0;
	a->at += (fmax(slack, 0) - a->at) * -expm1(log(u) / (double)(n - i));
	*time = a->par.start + (double)burst * a->par.period + (double)i * a->par.gap +
		a->at;
	return 1;
}

int arrivals_next(struct arrivals *a, double *time)
{
	double u = draw(a->par.seed, a->par.realisation, a->done, DRAW_ARRIVAL);

	if (a->done == a->par.number)
		return 0;
	if (!(a->par.rate > 0 ? next_poisson(a, u, time) : next_ordered(a, u, time)))
		return 0;
	a->last = *time = fmax(*time, a->done ? a->last : *time);
	a->done++;
	return 1;
}

double passage_clearance(const struct stream *stream, double diameter)
{
	return 0.5 * fmax(diameter, 0.01 * stream->pipe.bore);
}

double passage_slowest(const struct stream *stream)
{
	double v = pipe_velocity(
		&stream->pipe, 0.5 * stream->pipe.bore - passage_clearance(stream, 0));

	return stream->spacing / (stream->spacing / v + stream->lag[1]);
}

void passage_carry(const struct stream *stream, uint64_t index, struct passage *p)
{
	double reach = 0.5 * stream->pipe.bore - passage_clearance(stream, p->diameter);
	double u = draw(stream->seed, stream->realisation, index, DRAW_LAG), transit;

	p->radius = pipe_position(&stream->pipe, reach,
		draw(stream->seed, stream->realisation, index, DRAW_RADIUS));
	transit = stream->spacing / pipe_velocity(&stream->pipe, p->radius) +
		  stream->lag[0] + u * (stream->lag[1] - stream->lag[0]);
	p->velocity = stream->spacing / transit;
	p->time[1] = p->time[0] + transit;
	p->response[0] = 1;
	p->response[1] = 0;
}

void passage_draw(const struct stream *stream, uint64_t index, struct passage *p)
{
	double u = draw(stream->seed, stream->realisation, index, DRAW_DIAMETER);
	double a = stream->diameter[0], b = stream->diameter[1];

	if (stream->by_volume)
		p->diameter = cbrt(a * a * a + u * (b * b * b - a * a * a));
	else
		p->diameter = a + u * (b - a);
	passage_carry(stream, index, p);
}
