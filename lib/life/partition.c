/* partition.c - see partition.h */
#include "life/partition.h"
#include "num/room.h"
#include <math.h>
#include <stdlib.h>

/* One realisation in one step. */
struct cell {
	long realisation, step;
	double volume, count, large;
};

/* One realisation: sums over the steps that count for the rate. */
struct history {
	size_t first, end; /* its cells */
	double volume, square;
	double rows; /* steps */
};

/* Of a set of realisations. */
struct moments {
	double mean, step_variance, life_variance;
};

struct class
{
	int sparse;
	double pressure, area; /* own area after partition_close() */
	struct cell *cell;
	size_t ncells, cell_room;
	struct history *history;
	size_t nhistories;    /* told of */
	size_t nrealisations; /* with those that shed nothing */
	size_t *times;        /* how often each history is in the present replicate */
	struct moments now;
};

struct partition {
	double fragment_area, area, zone;
	struct class class[PARTITION_CLASSES_MAX]; /* by rising pressure once closed */
	int order[PARTITION_CLASSES_MAX];          /* order[place] = the caller's index */
	int nclasses, culprit;
	long steps;
};

struct partition *partition_new(double fragment_area, double area)
{
	struct partition *p = calloc(1, sizeof *p);

	if (p) {
		p->fragment_area = fragment_area;
		p->area = area;
	}
	return p;
}

void partition_free(struct partition *p)
{
	if (!p)
		return;
	for (int c = 0; c < p->nclasses; c++) {
		free(p->class[c].cell);
		free(p->class[c].history);
		free(p->class[c].times);
	}
	free(p);
}

int partition_class(struct partition *p, int sparse, double pressure, double area)
{
	if (p->nclasses == PARTITION_CLASSES_MAX)
		return -1;
	p->class[p->nclasses] =
		(struct class){ .sparse = sparse, .pressure = pressure, .area = area };
	return p->nclasses++;
}

enum partition_status partition_fragment(struct partition *p, int class, long realisation,
	long step, double volume, double count, double large)
{
	struct class *c = &p->class[class];
	struct cell *last = c->ncells ? &c->cell[c->ncells - 1] : NULL;

	p->culprit = class;
	if (step > p->steps)
		p->steps = step;
	if (last && last->realisation == realisation && last->step == step) {
		if (!c->sparse)
			return PARTITION_TWICE;
		last->volume += volume;
		last->count += count;
		last->large += large;
		return PARTITION_OK;
	}
	if (room_for(&c->cell, &c->cell_room, c->ncells + 1, sizeof *c->cell))
		return PARTITION_MEMORY;
	c->cell[c->ncells++] = (struct cell){ realisation, step, volume, count, large };
	return PARTITION_OK;
}

static int compare_cells(const void *a, const void *b)
{
	const struct cell *x = a, *y = b;

	if (x->realisation != y->realisation)
		return x->realisation < y->realisation ? -1 : 1;
	return (x->step > y->step) - (x->step < y->step);
}

/* Sums of one realisation; its cells are sorted by step. */
static void sum_history(const struct partition *p, const struct class *c,
	struct history *h, long first_step)
{
	for (size_t i = h->first; i < h->end; i++) {
		if (c->cell[i].step < first_step)
			continue;
		h->volume += c->cell[i].volume;
		h->square += c->cell[i].volume * c->cell[i].volume;
		h->rows++;
	}
	if (c->sparse)
		h->rows =
			p->steps >= first_step ? (double)(p->steps - first_step + 1) : 0;
}

static enum partition_status gather(struct partition *p, struct class *c, long first_step)
{
	double rows = 0;

	if (c->ncells == 0)
		return PARTITION_EMPTY;
	qsort(c->cell, c->ncells, sizeof *c->cell, compare_cells);
	for (size_t i = 1; i < c->ncells; i++)
		if (compare_cells(&c->cell[i - 1], &c->cell[i]) == 0)
			return PARTITION_TWICE;
	c->history = calloc(c->ncells, sizeof *c->history);
	c->times = calloc(c->ncells, sizeof *c->times);
	if (!c->history || !c->times)
		return PARTITION_MEMORY;
	for (size_t i = 0; i < c->ncells; i++) {
		if (i == 0 || c->cell[i].realisation != c->cell[i - 1].realisation)
			c->history[c->nhistories++].first = i;
		c->history[c->nhistories - 1].end = i + 1;
	}
	for (size_t i = 0; i < c->nhistories; i++) {
		sum_history(p, c, &c->history[i], first_step);
		rows += c->history[i].rows;
	}
	c->nrealisations = c->nhistories;
	if (c->sparse)
		c->nrealisations = (size_t)(c->cell[c->ncells - 1].realisation -
					    c->cell[0].realisation) +
				   1;
	return rows > 0 ? PARTITION_OK : PARTITION_EMPTY;
}

/* Sorts the classes by pressure, keeping the caller's numbers in order[]. */
static void sort_classes(struct partition *p)
{
	for (int i = 0; i < p->nclasses; i++) {
		struct class moved = p->class[i];
		int k = i;

		for (; k > 0 && p->class[k - 1].pressure > moved.pressure; k--) {
			p->class[k] = p->class[k - 1];
			p->order[k] = p->order[k - 1];
		}
		p->class[k] = moved;
		p->order[k] = i;
	}
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
	if (p->nclasses == 1) {
		if (!given)
			p->class[0].area = p->area;
		return sum > p->area * (1 + 1e-9) ? PARTITION_AREA : PARTITION_OK;
	}
	if (!given) {
		p->zone = transition * p->area;
		p->class[0].area = p->class[p->nclasses - 1].area =
			(p->area - p->zone) / 2;
		return PARTITION_OK;
	}
	if (sum > p->area * (1 + 1e-9))
		return PARTITION_AREA;
	p->zone = fmax(p->area - sum, 0);
	return PARTITION_OK;
}

enum partition_status partition_close(
	struct partition *p, double transition, long first_step)
{
	for (int c = 0; c < p->nclasses; c++) {
		enum partition_status s = gather(p, &p->class[c], first_step);

		p->culprit = c;
		if (s != PARTITION_OK)
			return s;
		if (p->nclasses > 1 && !(p->class[c].pressure > 0))
			return PARTITION_PRESSURE;
	}
	sort_classes(p);
	for (int c = 1; c < p->nclasses; c++) {
		p->culprit = p->order[c];
		if (p->class[c].pressure == p->class[c - 1].pressure)
			return PARTITION_PRESSURE;
	}
	return share_area(p, transition);
}

int partition_culprit(const struct partition *p)
{
	return p->culprit;
}

double partition_power_mean(double p0, double y0, double p1, double y1)
{
	double ratio, power;

	if (!(y0 > 0 && y1 > 0))
		return (y0 + y1) / 2;
	ratio = log(p1 / p0);
	power = log(y1 / y0) / ratio + 1;
	/* integral of y0 (p / p0)^(power - 1), as expm1 so that power = 0 is no case */
	if (fabs(power * ratio) < 1e-12)
		return y0 * p0 * ratio / (p1 - p0);
	return y0 * p0 * expm1(power * ratio) / power / (p1 - p0);
}

/* Moments of the histories, each taken times[] times, out of n realisations. */
static void take_moments(struct class *c, double n)
{
	double rows = 0, volume = 0, square = 0, scatter = 0, per_history;

	for (size_t i = 0; i < c->nhistories; i++) {
		double times = (double)c->times[i];

		rows += times * c->history[i].rows;
		volume += times * c->history[i].volume;
	}
	/* Realisations that shed nothing have the rows of any other one. */
	if (c->sparse)
		rows = n * c->history[0].rows;
	c->now = (struct moments){ 0 };
	if (!(rows > 0))
		return;
	per_history = rows / n;
	c->now.mean = volume / rows;
	for (size_t i = 0; i < c->nhistories; i++) {
		const struct history *h = &c->history[i];
		double times = (double)c->times[i], d = h->volume - c->now.mean * h->rows;

		square += times * (h->square - 2 * c->now.mean * h->volume +
					  c->now.mean * c->now.mean * h->rows);
		scatter += times * d * d;
		n -= times;
	}
	square += n * c->now.mean * c->now.mean * per_history;
	scatter += n * c->now.mean * c->now.mean * per_history * per_history;
	c->now.step_variance = fmax(square / rows, 0);
	c->now.life_variance = scatter / (rows * per_history);
}

/* Adds the moments of an area that behaves as parts independent ones. */
static void add_area(struct partition_wear *wear, const struct moments *m, double area,
	double fragment, double parts)
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
	double sum = 0;
	int n = p->nclasses;

	for (int c = 0; c + 1 < n; c++)
		sum += (p->class[c + 1].pressure - p->class[c].pressure) *
		       partition_power_mean(p->class[c].pressure, y[c],
			       p->class[c + 1].pressure, y[c + 1]);
	return sum / (p->class[n - 1].pressure - p->class[0].pressure);
}

/* Component from the present moments of the classes. */
static void integrate(
	const struct partition *p, double parts, struct partition_wear *wear)
{
	double mean[PARTITION_CLASSES_MAX], step[PARTITION_CLASSES_MAX];
	double life[PARTITION_CLASSES_MAX];
	struct moments zone;

	*wear = (struct partition_wear){ 0 };
	for (int c = 0; c < p->nclasses; c++) {
		const struct class *k = &p->class[c];

		add_area(wear, &k->now, k->area, p->fragment_area, parts);
		mean[c] = k->now.mean;
		step[c] = k->now.step_variance;
		life[c] = k->now.life_variance;
	}
	if (!(p->zone > 0))
		return;
	zone = (struct moments){ zone_mean(p, mean), zone_mean(p, step),
		zone_mean(p, life) };
	add_area(wear, &zone, p->zone, p->fragment_area, parts);
}

void partition_estimate(struct partition *p, double parts, struct partition_wear *wear)
{
	for (int c = 0; c < p->nclasses; c++) {
		struct class *k = &p->class[c];

		for (size_t i = 0; i < k->nhistories; i++)
			k->times[i] = 1;
		take_moments(k, (double)k->nrealisations);
	}
	integrate(p, parts, wear);
}

void partition_replicate(
	struct partition *p, double parts, gsl_rng *rng, struct partition_wear *wear)
{
	for (int c = 0; c < p->nclasses; c++) {
		struct class *k = &p->class[c];

		for (size_t i = 0; i < k->nhistories; i++)
			k->times[i] = 0;
		for (size_t i = 0; i < k->nrealisations; i++) {
			size_t pick = gsl_rng_uniform_int(rng, k->nrealisations);

			if (pick < k->nhistories)
				k->times[pick]++;
		}
		take_moments(k, (double)k->nrealisations);
	}
	integrate(p, parts, wear);
}

/* Particles and large ones that one fragment of a class sheds in each step; count and
 * large have room for steps values. */
static void shed(const struct class *c, double *count, double *large)
{
	for (size_t i = 0; i < c->nhistories; i++)
		for (size_t k = c->history[i].first; k < c->history[i].end; k++) {
			double share = (double)c->times[i] / (double)c->nrealisations;

			count[c->cell[k].step - 1] += share * c->cell[k].count;
			large[c->cell[k].step - 1] += share * c->cell[k].large;
		}
}

/* Adds the area-weighted sum over classes and zone of what fragments shed. */
static double whole(const struct partition *p, const double *per_class, long step)
{
	double y[PARTITION_CLASSES_MAX], sum = 0;

	for (int c = 0; c < p->nclasses; c++) {
		y[c] = per_class[c * p->steps + step];
		sum += p->class[c].area * y[c];
	}
	return p->zone > 0 ? sum + p->zone * zone_mean(p, y) : sum;
}

long partition_large(struct partition *p, double probability, int cumulative)
{
	size_t n = (size_t)p->nclasses * (size_t)p->steps;
	double *count = calloc(2 * n, sizeof *count), *large;
	double all = 0, all_large = 0;
	long found = 0;

	if (!count)
		return -1;
	large = count + n;
	for (int c = 0; c < p->nclasses; c++)
		shed(&p->class[c], count + c * p->steps, large + c * p->steps);
	for (long s = 0; s < p->steps && !found; s++) {
		all = (cumulative ? all : 0) + whole(p, count, s);
		all_large = (cumulative ? all_large : 0) + whole(p, large, s);
		if (all > 0 && all_large >= probability * all)
			found = s + 1;
	}
	free(count);
	return found;
}

double partition_load(const struct partition *p)
{
	double load =
		p->zone * (p->class[0].pressure + p->class[p->nclasses - 1].pressure) / 2;

	for (int c = 0; c < p->nclasses; c++)
		load += p->class[c].area * p->class[c].pressure;
	return load;
}
