#include "count/classes.h"
#include "count/interval.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sums of one class: of the certain rows, and with the doubtful ones. */
struct class
{
	struct weighted number[2], volume[2];
	double unresolved, unresolved_volume;
};

struct classes {
	struct classes_par par;
	int n;
	double *edge; /* n + 1, the last INFINITY */
	double *most; /* upper bound of the particles above an edge in unresolved sections
		       */
	double *most_volume; /* upper bound of their volume */
	double *heavy;       /* of an undetected particle of a class, below d50 */
	struct class *class;
	int unknown; /* nothing bounds an unresolved section */
};

/* Volume of a particle of this diameter to the sensor. */
static double ball(const struct classes *c, double d)
{
	double size = c->par.size && d < INFINITY ? c->par.size(d) : d;

	return M_PI / 6 * size * size * size;
}

/* Largest volume of an undetected particle between two diameters, over the probability of
 * its detection, without the upper end: below d50 that falls faster than the volume does,
 * down to a third of d50. */
static double heaviest_below_d50(const struct classes *c, double lower, double upper)
{
	enum { STEPS = 256 }; /* off by 1e-3 at most */
	double end = fmin(upper, c->par.detection.d50), most = 0;

	for (int i = 0; i < STEPS && lower < end; i++) {
		double d = lower + i * (end - lower) / STEPS;

		most = fmax(
			most, ball(c, d) / detection_probability(&c->par.detection, d));
	}
	return most;
}

struct classes *classes_new(const double *edge, int n, const struct classes_par *par)
{
	struct classes *c = calloc(1, sizeof *c);

	if (!c)
		return NULL;
	c->par = *par;
	c->n = n;
	c->edge = calloc(4 * ((size_t)n + 1), sizeof *c->edge);
	c->class = calloc((size_t)n, sizeof *c->class);
	if (!c->edge || !c->class) {
		classes_free(c);
		return NULL;
	}
	c->most = c->edge + n + 1;
	c->most_volume = c->most + n + 1;
	c->heavy = c->most_volume + n + 1;
	memcpy(c->edge, edge, (size_t)n * sizeof *edge);
	c->edge[n] = INFINITY;
	for (int k = 0; k < n; k++)
		c->heavy[k] = heaviest_below_d50(c, edge[k], c->edge[k + 1]);
	return c;
}

void classes_free(struct classes *c)
{
	if (!c)
		return;
	free(c->edge);
	free(c->class);
	free(c);
}

void classes_clear(struct classes *c)
{
	memset(c->class, 0, (size_t)c->n * sizeof *c->class);
	memset(c->most, 0, 2 * ((size_t)c->n + 1) * sizeof *c->most);
	c->unknown = 0;
}

/* -1 below the first class.  A limit and a diameter that were converted from other units
 * may differ by rounding. */
static int class_of(const struct classes *c, double d)
{
	int k = c->n - 1;

	while (k >= 0 && d * (1 + 1e-12) < c->edge[k])
		k--;
	return k;
}

void classes_add(struct classes *c, double diameter, int sure)
{
	double w = 1 / detection_probability(&c->par.detection, diameter);
	int k = class_of(c, diameter);

	for (int i = sure ? 0 : 1; k >= 0 && i < 2; i++) {
		weighted_add(&c->class[k].number[i], w);
		weighted_add(&c->class[k].volume[i], w * ball(c, diameter));
	}
}

/* Most particles above an edge: by Markov's inequality, from the sums of d^6 and d^12. */
static double most_above(const struct stretch *s, double edge)
{
	double largest = fmin(s->most, s->high > 0 ? s->high : INFINITY);
	/* edges and diameters that were converted may differ by rounding */
	double x = pow(s->most / edge, 6) * (1 + 1e-12);

	return edge > 0 ? floor(x * fmin(1, pow(largest / edge, 6))) : INFINITY;
}

void classes_add_stretch(struct classes *c, const struct stretch *s)
{
	int k = class_of(c, s->diameter);

	if (k >= 0 && s->number >= 0 && s->diameter > 0) {
		c->class[k].unresolved += s->number;
		c->class[k].unresolved_volume += s->number * ball(c, s->diameter);
	}
	c->unknown |= !(s->most >= 0);
	for (k = 0; k < c->n && s->most >= 0; k++) {
		double most = most_above(s, c->edge[k]);

		c->most[k] += most;
		/* that of as many equal ones, as their volume is a concave function of
		 * d^6 */
		if (isinf(most))
			c->most_volume[k] = INFINITY;
		else if (most > 0)
			c->most_volume[k] += most * ball(c, s->most / pow(most, 1. / 6));
	}
}

static void merge(struct weighted *to, const struct weighted *from)
{
	to->n += from->n;
	to->sum += from->sum;
	to->squares += from->squares;
	to->largest = fmax(to->largest, from->largest);
}

void classes_add_possible(struct classes *c, const struct classes *from)
{
	for (int k = 0; k < c->n; k++) {
		merge(&c->class[k].number[1], &from->class[k].number[1]);
		merge(&c->class[k].volume[1], &from->class[k].volume[1]);
		c->most[k] += from->most[k];
		c->most_volume[k] += from->most_volume[k];
	}
	c->unknown |= from->unknown;
}

double classes_detection(const struct classes *c, int k)
{
	return detection_probability(&c->par.detection, c->edge[k]);
}

/* Adds up the classes from first to last. */
static void count(const struct classes *c, int first, int last, struct class_count *out)
{
	struct weighted number[2] = { { 0 } }, volume[2] = { { 0 } };
	double lower = c->edge[first], upper = c->edge[last + 1], low, high, squares = 0;
	/* The diameter that is least likely to be detected, and the largest one. */
	double weight = 1 / detection_probability(&c->par.detection, lower);
	double heavy = ball(c, upper) / detection_probability(&c->par.detection, upper);
	double below = 0;

	*out = (struct class_count){ 0 };
	for (int k = first; k <= last; k++) {
		for (int i = 0; i < 2; i++) {
			merge(&number[i], &c->class[k].number[i]);
			merge(&volume[i], &c->class[k].volume[i]);
		}
		out->unresolved += c->class[k].unresolved;
		out->volume.value += c->class[k].unresolved_volume;
		if (c->class[k].unresolved > 0) /* equal particles */
			squares += pow(c->class[k].unresolved_volume, 2) /
				   c->class[k].unresolved;
		below = fmax(below, c->heavy[k]);
	}
	heavy = fmax(below, heavy);
	out->sure = number[0].n;
	out->doubtful = number[1].n - number[0].n;
	out->number.value = number[0].sum + out->unresolved;
	out->volume.value += volume[0].sum;
	weighted_interval(&number[0], 0, c->par.confidence, &out->number.low, &high);
	weighted_interval(&volume[0], 0, c->par.confidence, &out->volume.low, &high);
	weighted_interval(&number[1], weight, c->par.confidence, &low, &out->number.high);
	out->number.possible = weight;
	out->volume.possible = heavy;
	if (number[1].n > 0 &&
		isinf(upper)) /* the largest observed particle limits an open class */
		heavy = fmax(below, volume[1].largest);
	weighted_interval(&volume[1], heavy, c->par.confidence, &low, &out->volume.high);
	out->number.largest = number[1].largest;
	out->volume.largest = volume[1].largest;
	out->number.squares = number[0].squares + out->unresolved;
	out->volume.squares = volume[0].squares + squares;
	out->number.high += c->unknown ? INFINITY : c->most[first];
	out->volume.high += c->unknown ? INFINITY : c->most_volume[first];
}

void classes_count(const struct classes *c, int k, struct class_count *out)
{
	count(c, k, k, out);
}

void classes_count_above(const struct classes *c, int k, struct class_count *out)
{
	count(c, k, c->n - 1, out);
}
