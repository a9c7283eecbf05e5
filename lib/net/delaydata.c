/* delaydata.c - the simulated sections that the thesis trains its delay networks on */
#include "net/delaydata.h"
#include "net/delayloss.h"
#include "num/philox.h"
#include <math.h>

/* Places in the stream of one sample; network.h draws at lower ones. */
#define DRAWS ((uint64_t)2 << 40)
#define NOISE ((uint64_t)3 << 40)

enum { DRAWS_EACH = 5 }; /* numbers drawn per source */

struct source {
	double begin, length, amplitude, gain, delay;
};

static double between(const double range[2], double u)
{
	return range[0] + (range[1] - range[0]) * u;
}

static void draw_source(
	const struct delaydata_par *par, uint32_t i, int k, struct source *s)
{
	uint64_t first = DRAWS + (uint64_t)k * DRAWS_EACH;
	double u[DRAWS_EACH];

	for (unsigned j = 0; j < DRAWS_EACH; j++)
		u[j] = philox_uniform(par->seed, i, RNG_NETWORK, first + j);
	s->length = par->section == DELAYDATA_RANGE ? par->length[1] - par->length[0]
						    : between(par->length, u[0]);
	s->amplitude = between(par->amplitude, u[1]);
	s->gain = between(par->gain, u[2]);
	s->delay = u[3];
	/* Arrivals that leave the pulse complete in both channels. */
	s->begin = fmax(par->span - s->length - par->unit, 0) * u[4];
}

/* Whether a comes before b in the order of the labels. */
static int precedes(
	enum delaydata_order order, const struct source *a, const struct source *b)
{
	if (order == DELAYDATA_ARRIVAL)
		return a->begin < b->begin;
	return order == DELAYDATA_SORTED && a->delay < b->delay;
}

static void add_source(const struct delaydata_par *par, const struct source *s,
	double amplitude, double shift, network_real *x)
{
	double frequency = par->section == DELAYDATA_PERIOD ? 2 * M_PI / s->length : 1;
	double phase = par->section == DELAYDATA_RANGE ? par->length[0] : 0;
	double step = par->span / par->points;

	for (int i = 0; i < par->points; i++) {
		double u = i * step - s->begin - shift;

		if (par->endless || (u >= 0 && u < s->length))
			x[i] = (network_real)(x[i] +
					      amplitude * sin(frequency * u + phase));
	}
}

static void scale_channels(const struct delaydata_par *par, network_real *x)
{
	double peak = 0;

	for (int p = 0; p < par->points; p++)
		peak = fmax(peak, fabs((double)x[p]));
	for (int p = 0; p < 2 * par->points && peak > 0; p++)
		x[p] = (network_real)(x[p] / peak);
}

void delaydata_sample(
	const struct delaydata_par *par, uint32_t i, network_real *x, network_real *delay)
{
	struct source source[DELAYS_MAX];

	for (int k = 0; k < par->sources; k++) {
		struct source s;
		int at = k;

		draw_source(par, i, k, &s);
		for (; at > 0 && precedes(par->order, &s, &source[at - 1]); at--)
			source[at] = source[at - 1];
		source[at] = s;
	}
	for (int p = 0; p < 2 * par->points; p++)
		x[p] = 0;
	for (int k = 0; k < par->sources; k++) {
		const struct source *s = &source[k];

		add_source(par, s, s->amplitude, 0, x);
		add_source(par, s, s->amplitude * s->gain, par->unit * s->delay,
			x + par->points);
		delay[k] = (network_real)s->delay;
	}
	if (par->scaled)
		scale_channels(par, x);
	for (int p = 0; p < 2 * par->points && par->noise > 0; p += 2) {
		double normal[2];

		philox_normal2(par->seed, i, RNG_NETWORK, NOISE + (uint64_t)p, normal);
		x[p] = (network_real)(x[p] + par->noise * normal[0]);
		x[p + 1] = (network_real)(x[p + 1] + par->noise * normal[1]);
	}
}
