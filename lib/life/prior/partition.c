/* partition.c - see partition.h */
#include "life/prior/partition.h"
#include "num/running.h"
#include "num/status.h"
#include <gsl/gsl_randist.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* For the sizes, realisations are collected in groups by their number modulo this prime;
 * fewer realisations are groups of their own.  A mean over groups varies between draws
 * like one over their realisations; the spread of 251 of them is known to 4 %. */
enum { GROUPS = 251 };

/* Particles of a group of realisations in one step. */
struct shed {
	double count, large;
};

struct class
{
	const struct partition *owner;
	int sparse, twice;     /* twice: a realisation has a step twice */
	double pressure, area; /* own area after partition_close() */
	struct realisations *reader;
	long lowest, highest; /* first and last realisation */
	/* Over realisations, volume.n of them: volume of the steps that count for the
	 * rate. */
	struct running volume;
	struct regression steps; /* of the volume on the number of steps */
	struct running cell;     /* over realisations and steps: volume */
	struct shed *shed;       /* [shed_steps][GROUPS] */
	long shed_steps;
	long groups, first_group;
	double times[GROUPS]; /* how often each was drawn for the present replicate */
	/* Of a closed class. */
	double error, skewness; /* error: relative, of the mean */
	struct partition_wear all, now;
};

struct partition {
	double fragment_area, area, zone;
	long first_step;
	int sizes;
	struct class class[PARTITION_CLASSES_MAX];
	int order[PARTITION_CLASSES_MAX]; /* classes by pressure */
	int nclasses, culprit;
	long steps;
};

struct partition *partition_new(double area, long first_step, int sizes)
{
	struct partition *p = calloc(1, sizeof *p);

	if (p) {
		p->area = area;
		p->first_step = first_step;
		p->sizes = sizes;
	}
	return p;
}

void partition_free(struct partition *p)
{
	if (!p)
		return;
	for (int c = 0; c < p->nclasses; c++) {
		realisations_free(p->class[c].reader);
		free(p->class[c].shed);
	}
	free(p);
}

/* Adds the particles of a realisation to its group; those that are missing from a
 * particle table count. */
static enum num_status group_sizes(
	struct class *c, const struct realisation_cell *cell, size_t n)
{
	long group = (c->sparse ? cell->realisation : (long)c->volume.n) % GROUPS,
	     steps = cell[n - 1].step;
	size_t row = GROUPS * sizeof *c->shed;

	if (steps > c->shed_steps) {
		struct shed *more = realloc(c->shed, (size_t)steps * row);

		if (!more)
			return NUM_MEMORY;
		memset(more + c->shed_steps * GROUPS, 0,
			(size_t)(steps - c->shed_steps) * row);
		c->shed = more;
		c->shed_steps = steps;
	}
	for (size_t i = 0; i < n; i++) {
		struct shed *s = &c->shed[(cell[i].step - 1) * GROUPS + group];

		s->count += cell[i].count;
		s->large += cell[i].large;
	}
	return NUM_OK;
}

static void widen(struct class *c, long realisation)
{
	c->lowest = realisation < c->lowest ? realisation : c->lowest;
	c->highest = realisation > c->highest ? realisation : c->highest;
}

/* Takes the whole history of one realisation; its cells are sorted by step. */
static enum num_status take_history(
	void *to, const struct realisation_cell *cell, size_t n)
{
	struct class *c = to;
	double volume = 0, steps = 0;

	for (size_t i = 0, end; i < n; i = end) {
		double here = 0, rows = 0;

		for (end = i; end < n && cell[end].step == cell[i].step; end++) {
			here += cell[end].volume;
			rows += cell[end].count;
			c->twice |= cell[end].part != cell[i].part;
		}
		c->twice |= !c->sparse && rows > 1;
		if (c->twice)
			return NUM_DOMAIN;
		if (cell[i].step < c->owner->first_step)
			continue;
		running_add(&c->cell, here);
		volume += here;
		steps++;
	}
	widen(c, cell->realisation);
	if (c->owner->sizes && group_sizes(c, cell, n))
		return NUM_MEMORY;
	running_add(&c->volume, volume);
	regression_add(&c->steps, steps, volume);
	return NUM_OK;
}

int partition_class(struct partition *p, int sparse, double pressure, double area)
{
	struct class *c = &p->class[p->nclasses];
	int k = p->nclasses;

	if (p->nclasses == PARTITION_CLASSES_MAX)
		return -1;
	for (; k > 0 && p->class[p->order[k - 1]].pressure > pressure; k--)
		p->order[k] = p->order[k - 1];
	p->order[k] = p->nclasses;
	*c = (struct class){ .owner = p,
		.sparse = sparse,
		.pressure = pressure,
		.area = area,
		.lowest = LONG_MAX,
		.highest = -1 };
	c->reader = realisations_new(REALISATIONS_ROOM, take_history, c);
	return c->reader ? p->nclasses++ : -1;
}

static enum partition_status reading(
	const struct class *c, enum realisations_status status)
{
	if (status == REALISATIONS_AGAIN)
		return PARTITION_APART;
	if (status == REALISATIONS_STOP && c->twice)
		return PARTITION_TWICE;
	return status == REALISATIONS_OK ? PARTITION_OK : PARTITION_MEMORY;
}

void partition_simulated(struct partition *p, int class, long realisation, long step)
{
	widen(&p->class[class], realisation);
	if (step > p->steps)
		p->steps = step;
}

enum partition_status partition_fragment(
	struct partition *p, int class, const struct realisation_cell *row)
{
	struct class *c = &p->class[class];

	p->culprit = class;
	if (row->step > p->steps)
		p->steps = row->step;
	return reading(c, realisations_add(c->reader, row));
}

/* Moments of the rows read. */
static enum partition_status sum_up(struct partition *p, struct class *c)
{
	double scatter;

	if (c->highest < 0)
		return PARTITION_EMPTY;
	if (c->sparse) {
		double steps = fmax((double)(p->steps - p->first_step) + 1, 0);

		running_repeat(&c->volume, 0,
			(double)c->highest - (double)c->lowest + 1 - c->volume.n);
		c->steps = (struct regression){ .mean_x = steps };
		running_repeat(&c->cell, 0, c->volume.n * steps - c->cell.n);
	}
	if (!(c->steps.mean_x > 0))
		return PARTITION_EMPTY;
	c->all.mean = c->volume.mean / c->steps.mean_x;
	/* Of volume - mean * steps over the realisations, whose mean is 0. */
	scatter = c->volume.square - 2 * c->all.mean * c->steps.xy +
		  c->all.mean * c->all.mean * c->steps.xx;
	if (c->volume.n > 1)
		c->all.life_variance = fmax(scatter, 0) / (c->volume.n - 1) /
				       (c->steps.mean_x * c->steps.mean_x);
	c->all.step_variance = c->cell.n > 1 ? running_variance(&c->cell) : 0;
	if (c->all.mean > 0)
		c->error = sqrt(c->all.life_variance / c->volume.n) / c->all.mean;
	c->skewness = fmax(0, running_skewness(&c->volume));
	c->groups = (long)fmin(c->volume.n, GROUPS);
	c->first_group = c->sparse ? c->lowest % GROUPS : 0;
	return PARTITION_OK;
}

/* Own areas and the linear zone. */
static enum partition_status share_area(struct partition *p, double transition)
{
	double sum = 0;
	int given = 0;

	for (int c = 0; c < p->nclasses; c++) {
		if (p->class[c].area >= 0) {
			given = 1;
			sum += p->class[c].area;
		} else {
			p->class[c].area = 0;
		}
	}
	if (sum > p->area * (1 + 1e-9))
		return PARTITION_AREA;
	if (p->nclasses == 1) {
		if (!given)
			p->class[0].area = p->area;
	} else if (given) {
		p->zone = fmax(p->area - sum, 0);
	} else {
		p->zone = transition * p->area;
		p->class[p->order[0]].area = p->class[p->order[p->nclasses - 1]].area =
			(p->area - p->zone) / 2;
	}
	return PARTITION_OK;
}

enum partition_status partition_close(
	struct partition *p, double fragment_area, double transition)
{
	enum partition_status status = PARTITION_OK;

	p->fragment_area = fragment_area;
	for (int c = 0; c < p->nclasses; c++) {
		p->culprit = c;
		status = reading(&p->class[c], realisations_end(p->class[c].reader));
		if (status == PARTITION_OK)
			status = sum_up(p, &p->class[c]);
		if (status == PARTITION_OK && p->nclasses > 1 &&
			!(p->class[c].pressure > 0))
			status = PARTITION_PRESSURE;
		if (status != PARTITION_OK)
			return status;
	}
	for (int k = 1; k < p->nclasses; k++) {
		p->culprit = p->order[k];
		if (p->class[p->culprit].pressure == p->class[p->order[k - 1]].pressure)
			return PARTITION_PRESSURE;
	}
	return share_area(p, transition);
}

int partition_culprit(const struct partition *p)
{
	return p->culprit;
}

long partition_realisation(const struct partition *p)
{
	return realisations_culprit(p->class[p->culprit].reader);
}

double partition_count(const struct partition *p, int class, double *mean, double *error)
{
	*mean = p->class[class].all.mean;
	*error = p->class[class].error;
	return p->class[class].volume.n;
}

double partition_power_mean(double p0, double y0, double p1, double y1)
{
	double ratio = log(p1 / p0), power = log(y1 / y0) / ratio + 1;

	if (!(y0 > 0 && y1 > 0))
		return (y0 + y1) / 2;
	/* integral of y0 (p / p0)^(power - 1); by expm1, so that power = 0 needs no case
	 * of its own */
	if (fabs(power * ratio) < 1e-12)
		return y0 * p0 * ratio / (p1 - p0);
	return y0 * p0 * expm1(power * ratio) / power / (p1 - p0);
}

/* Adds the moments of an area that wears as so many independent parts. */
static void add_area(struct partition_wear *wear, const struct partition_wear *m,
	double area, double fragment, double parts)
{
	double fragments = area / fragment;
	double n = parts > 0 ? parts : fmax(fragments, 1);

	wear->mean += fragments * m->mean;
	wear->step_variance += fragments * fragments / n * m->step_variance;
	wear->life_variance += fragments * fragments / n * m->life_variance;
}

/* Mean over the linear zone of a quantity known at each class. */
static double zone_mean(const struct partition *p, const double *y)
{
	const int *at = p->order;
	int last = p->nclasses - 1;
	double sum = 0, span = p->class[at[last]].pressure - p->class[at[0]].pressure;

	for (int k = 0; k < last; k++) {
		double low = p->class[at[k]].pressure,
		       high = p->class[at[k + 1]].pressure;

		sum += (high - low) *
		       partition_power_mean(low, y[at[k]], high, y[at[k + 1]]);
	}
	return sum / span;
}

/* Component from the present moments of the classes. */
static struct partition_wear integrate(const struct partition *p, double parts)
{
	double mean[PARTITION_CLASSES_MAX], step[PARTITION_CLASSES_MAX];
	double life[PARTITION_CLASSES_MAX];
	struct partition_wear wear = { 0 }, zone;

	for (int c = 0; c < p->nclasses; c++) {
		const struct class *k = &p->class[c];

		add_area(&wear, &k->now, k->area, p->fragment_area, parts);
		mean[c] = k->now.mean;
		step[c] = k->now.step_variance;
		life[c] = k->now.life_variance;
	}
	if (!(p->zone > 0))
		return wear;
	zone = (struct partition_wear){ zone_mean(p, mean), zone_mean(p, step),
		zone_mean(p, life) };
	add_area(&wear, &zone, p->zone, p->fragment_area, parts);
	return wear;
}

struct partition_wear partition_estimate(struct partition *p, double parts)
{
	for (int c = 0; c < p->nclasses; c++) {
		struct class *k = &p->class[c];

		k->now = k->all;
		for (int i = 0; i < GROUPS; i++)
			k->times[i] = 1;
	}
	return integrate(p, parts);
}

/* A draw of the mean, relative to the observed one: see partition.h. */
static double draw_mean(const struct class *c, gsl_rng *rng)
{
	/* the 90 % interval of three realisations lies above exp(-2.92) */
	const double tail = 4.7, square = 1.2, least = 0.01;
	double k = c->volume.n, t, more;

	if (!(c->error > 0))
		return 1;
	t = gsl_ran_tdist(rng, k - 1) * c->error;
	more = t < 0 ? square * t * t - tail * c->skewness * t / sqrt(c->error * k) : 0;
	/* With few realisations t may be of any size: no infinite rates. */
	return fmax(exp(fmin(more - t, 200)), least);
}

/* Resamples the groups with replacement. */
static void draw_groups(struct class *c, gsl_rng *rng)
{
	memset(c->times, 0, sizeof c->times);
	for (long i = 0; i < c->groups; i++)
		c->times[(c->first_group + (long)gsl_rng_uniform_int(
						   rng, (unsigned long)c->groups)) %
			 GROUPS]++;
}

struct partition_wear partition_replicate(struct partition *p, double parts, gsl_rng *rng)
{
	/* by pressure, so that the order of the tables does not matter */
	for (int c = 0; c < p->nclasses; c++) {
		struct class *k = &p->class[p->order[c]];
		double ratio = draw_mean(k, rng);

		k->now.mean = ratio * k->all.mean;
		k->now.step_variance = ratio * ratio * k->all.step_variance;
		k->now.life_variance = ratio * ratio * k->all.life_variance;
		if (p->sizes)
			draw_groups(k, rng);
	}
	return integrate(p, parts);
}

/* Particles that one fragment of a class sheds in a step, from 0. */
static struct shed shed_in(const struct class *c, long step)
{
	struct shed sum = { 0 };

	for (int i = 0; i < GROUPS && step < c->shed_steps; i++) {
		const struct shed *s = &c->shed[step * GROUPS + i];

		sum.count += c->times[i] / c->volume.n * s->count;
		sum.large += c->times[i] / c->volume.n * s->large;
	}
	return sum;
}

/* Area-weighted sum over classes and zone of what fragments shed. */
static double whole(const struct partition *p, const double *per_class)
{
	double sum = 0;

	for (int c = 0; c < p->nclasses; c++)
		sum += p->class[c].area * per_class[c];
	return p->zone > 0 ? sum + p->zone * zone_mean(p, per_class) : sum;
}

long partition_large(struct partition *p, double probability, int cumulative)
{
	double count[PARTITION_CLASSES_MAX], large[PARTITION_CLASSES_MAX], all = 0,
									   all_large = 0;

	for (long step = 0; step < p->steps; step++) {
		for (int c = 0; c < p->nclasses; c++) {
			struct shed s = shed_in(&p->class[c], step);

			count[c] = s.count;
			large[c] = s.large;
		}
		all = (cumulative ? all : 0) + whole(p, count);
		all_large = (cumulative ? all_large : 0) + whole(p, large);
		if (all > 0 && all_large >= probability * all)
			return step + 1;
	}
	return 0;
}
