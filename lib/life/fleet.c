/* fleet.c - see fleet.h */
#include "life/fleet.h"
#include "life/draw.h"
#include <math.h>
#include <stdlib.h>

enum { SMOOTHED = 20 }; /* rows from which medians of three are taken */

/* Rising steps of one unit: age at which each level was first reached. */
struct path {
	struct climb climb;
	int n, room;
	double *age, *level; /* level times direction */
	double life;         /* age at the threshold; NAN if it was not reached */
};

struct fleet {
	double threshold;
	int direction;
	int units;
	struct path *path;
};

struct fleet *fleet_new(double threshold, int direction)
{
	struct fleet *f = calloc(1, sizeof *f);

	if (!f)
		return NULL;
	f->threshold = threshold;
	f->direction = direction;
	return f;
}

void fleet_free(struct fleet *f)
{
	if (!f)
		return;
	for (int i = 0; i < f->units; i++) {
		free(f->path[i].age);
		free(f->path[i].level);
	}
	free(f->path);
	free(f);
}

int fleet_units(const struct fleet *f)
{
	return f->units;
}

static double median3(double a, double b, double c)
{
	return fmax(fmin(a, b), fmin(fmax(a, b), c));
}

void climb_add(struct climb *c, double t, double y)
{
	double level = y, when = t;

	if (c->rows == 0)
		c->first = t;
	for (int k = 2; k > 0; k--) {
		c->t[k] = c->t[k - 1];
		c->y[k] = c->y[k - 1];
	}
	c->t[0] = t;
	c->y[0] = y;
	if (++c->rows >= SMOOTHED) {
		level = median3(c->y[0], c->y[1], c->y[2]);
		when = c->t[1];
	}
	if (c->rows == 1 || c->direction * (level - c->level) > 0) {
		c->level = level;
		c->age = when - c->first;
	}
}

static int grow(struct path *p)
{
	int room = p->room ? 2 * p->room : 64;
	double *age = realloc(p->age, (size_t)room * sizeof *age), *level;

	if (age)
		p->age = age;
	level = age ? realloc(p->level, (size_t)room * sizeof *level) : NULL;
	if (level)
		p->level = level;
	if (!level)
		return 0;
	p->room = room;
	return 1;
}

/* Adds a step where it leads higher; 0: no memory. */
static int rise(struct path *p, double age, double level)
{
	if (p->n > 0 && level <= p->level[p->n - 1])
		return 1;
	if (p->n == p->room && !grow(p))
		return 0;
	p->age[p->n] = age;
	p->level[p->n++] = level;
	return 1;
}

int fleet_add(struct fleet *f, int unit, double t, double y)
{
	struct path *p;

	if (unit >= f->units) {
		p = realloc(f->path, ((size_t)unit + 1) * sizeof *p);
		if (!p)
			return 0;
		f->path = p;
		while (f->units <= unit)
			f->path[f->units++] =
				(struct path){ .climb = { .direction = f->direction } };
	}
	p = &f->path[unit];
	climb_add(&p->climb, t, y);
	return rise(p, p->climb.age, f->direction * p->climb.level);
}

/* Age at which a level was first reached; NAN where it was not. */
static double passage(const struct path *p, double level)
{
	int low = 0, high = p->n - 1;

	if (p->n == 0 || level > p->level[high])
		return NAN;
	if (level <= p->level[0])
		return 0;
	while (high - low > 1) {
		int mid = (low + high) / 2;

		if (p->level[mid] < level)
			low = mid;
		else
			high = mid;
	}
	return p->age[low] + (p->age[high] - p->age[low]) * (level - p->level[low]) /
				     (p->level[high] - p->level[low]);
}

int fleet_build(struct fleet *f)
{
	int failed = 0;

	for (int i = 0; i < f->units; i++) {
		struct path *p = &f->path[i];

		/* No median waits for rows that will not come. */
		if (!rise(p, p->climb.t[0] - p->climb.first,
			    f->direction * p->climb.y[0]))
			return -1;
		p->life = passage(p, f->direction * f->threshold);
		failed += p->life > 0;
	}
	return failed;
}

/* Sums of a regression of y on x. */
struct sums {
	int n;
	double x, y, xx, xy, yy; /* means and centred sums */
};

static void sum_pair(struct sums *s, double x, double y)
{
	double dx = x - s->x, dy = y - s->y, rest;

	s->n++;
	rest = 1 - 1.0 / s->n;
	s->x += dx / s->n;
	s->y += dy / s->n;
	s->xx += rest * dx * dx;
	s->xy += rest * dx * dy;
	s->yy += rest * dy * dy;
}

/* Pairs of log age at the level and log time left from there. */
static struct sums compare_units(const struct fleet *f, double level, double age)
{
	struct sums s = { 0 };

	for (int i = 0; i < f->units; i++) {
		const struct path *p = &f->path[i];
		double then = age > 0 ? passage(p, f->direction * level) : 0;

		if (p->life > then && (then > 0 || !(age > 0)))
			sum_pair(&s, age > 0 ? log(then) : 0, log(p->life - then));
	}
	return s;
}

int fleet_life(const struct fleet *f, double level, double age, const double *z,
	double *life, int n)
{
	struct sums s = compare_units(f, level, age);
	double slope = 0, away = 0, centre, variance, freedom;

	if (s.n < FLEET_MIN)
		return 0;
	if (age > 0) {
		/* About a slope of 1, with the variance of the ratio as ridge. */
		double ratio = fmax(0, s.yy - 2 * s.xy + s.xx) / (s.n - 1);

		slope = s.xx + ratio > 0 ? 1 + (s.xy - s.xx) / (s.xx + ratio) : 1;
		away = log(age) - s.x;
	}
	freedom = s.n > FLEET_MIN ? s.n - (age > 0 ? 2 : 1) : s.n - 1;
	variance = fmax(0, s.yy - 2 * slope * s.xy + slope * slope * s.xx) / freedom;
	centre = s.y + slope * away;
	variance *= 1 + 1.0 / s.n + (s.xx > 0 && age > 0 ? away * away / s.xx : 0);
	for (int i = 0; i < n; i++) {
		double chi = chi2_from_normal(freedom, z[2 * i]) / freedom;

		life[i] = exp(fmin(700, centre + sqrt(variance / chi) * z[2 * i + 1]));
	}
	return 1;
}
