#include "abrasion/particle.h"
#include <math.h>

const double abrasion_harder = 1.2;

/* (H1 + H2) c(x) as a quadratic in x, from the side on which no digits cancel. */
double abrasion_squeeze(
	double d, double gap, double hardness1, double hardness2, double *load)
{
	double sum = d - gap, big = fmax(hardness1, hardness2);
	double h1 = hardness1 / big, h2 = hardness2 / big, x, c;
	double a = h2 - h1, b = (h1 + h2) * d - 2 * h2 * sum, root;

	c = -h2 * sum * gap;
	root = sqrt(fmax(b * b - 4 * a * c, 0));
	/* a x^2 + b x + c = 0, the root that is 0 for sum = 0 */
	if (b >= 0)
		x = -2 * c / (b + root);
	else
		x = a != 0 ? (root - b) / (2 * a) : sum / 2;
	/* Beyond its radius the contact area of a sphere is its cross-section. */
	if (!(x <= d / 2) || !(sum - x <= d / 2)) {
		double soft = fmin(h1, h2), ratio = soft / fmax(h1, h2);
		/* depth in the harder body: c(y) = ratio d^2 / 4 */
		double y = d / 2 * ratio / (1 + sqrt(1 - ratio));

		x = h1 <= h2 ? sum - y : y;
		if (y > sum)
			x = h1 <= h2 ? 0 : sum;
	}
	if (load)
		*load = M_PI * hardness1 * (x < d / 2 ? x * (d - x) : d * d / 4);
	return x;
}

double abrasion_section(double d, double depth)
{
	double r = d / 2, u = depth / r;
	double half;

	if (!(u > 0))
		return 0;
	if (u < 1e-3) /* the series, whose next term is u^2 times smaller */
		return r * r * u * sqrt(2 * u) * (4.0 / 3 - u / 5 - u * u / 56);
	half = acos(1 - fmin(u, 1));
	return r * r * (half - sin(half) * cos(half));
}

double abrasion_largest(double friction, double radius, double gap)
{
	double square = friction * friction;

	return isinf(radius) ? INFINITY : gap * (1 + square) + 2 * square * radius;
}

/* Adds the groove of a particle that slides on one body, for a share of the distance. */
static void slide_on(const struct abrasion_par *par, double d, int body, double share,
	struct abrasion *a)
{
	double h[2] = { par->hardness[0], par->hardness[1] }, load, depth[2];

	h[body] /= 2;
	depth[0] = abrasion_squeeze(d, par->gap, h[0], h[1], &load);
	depth[1] = d - par->gap - depth[0];
	a->load += share * load;
	for (int k = 0; k < 2; k++)
		a->depth[k] += share * depth[k];
	a->share[body] = share;
	a->groove[body] = depth[body];
	a->section[body] = share * abrasion_section(d, depth[body]);
	if (depth[body] > d / 2)
		a->mode = ABRASION_BURIED;
}

static void groove(const struct abrasion_par *par, double d, struct abrasion *a)
{
	double soft = par->hardness[0] - par->hardness[1];

	a->mode = ABRASION_GROOVES;
	if (soft == 0) {
		slide_on(par, d, 0, 0.5, a);
		slide_on(par, d, 1, 0.5, a);
	} else {
		slide_on(par, d, soft < 0, 1, a);
	}
}

/* A particle that a body holds beyond its equator does not roll. */
static int rolls(
	const struct abrasion_par *par, double d, double aspect, const struct abrasion *a)
{
	double mu = par->friction;

	if (par->motion != ABRASION_BY_SHAPE)
		return par->motion == ABRASION_ALL_ROLL;
	/* (k - 1/k) / 2 <= mu */
	return aspect <= mu + sqrt(1 + mu * mu) &&
	       fmax(a->depth[0], a->depth[1]) <= d / 2;
}

/* A particle that is too soft for one of the bodies does not indent it. */
static void press_into(
	const struct abrasion_par *par, double d, int body, struct abrasion *a)
{
	double depth = d - par->gap;

	a->mode = ABRASION_EMBEDS;
	a->depth[body] = depth;
	a->load = M_PI * par->hardness[body] *
		  (depth < d / 2 ? depth * (d - depth) : d * d / 4);
}

void abrasion_particle(
	const struct abrasion_par *par, double d, double aspect, struct abrasion *a)
{
	struct abrasion still = { .mode = ABRASION_ROLLS };
	int marks[2];

	*a = (struct abrasion){ .mode = ABRASION_FREE };
	if (!(d > par->gap))
		return;
	if (d > abrasion_largest(par->friction, par->inlet, par->gap)) {
		a->mode = ABRASION_REJECTED;
		return;
	}
	for (int k = 0; k < 2; k++)
		marks[k] = par->abrasive >= abrasion_harder * par->hardness[k];
	still.depth[0] = abrasion_squeeze(
		d, par->gap, par->hardness[0], par->hardness[1], &still.load);
	still.depth[1] = d - par->gap - still.depth[0];
	if (!marks[0] && !marks[1])
		a->mode = ABRASION_YIELDS;
	else if (!marks[0] || !marks[1])
		press_into(par, d, marks[1], a);
	else if (rolls(par, d, aspect, &still))
		*a = still;
	else
		groove(par, d, a);
	if (a->mode == ABRASION_YIELDS)
		a->load = a->depth[0] = a->depth[1] = NAN;
	if (a->mode == ABRASION_YIELDS || a->mode == ABRASION_BURIED)
		a->section[0] = a->section[1] = NAN;
}

double abrasion_widest(double (*carry)(void *, double), double (*admits)(void *, double),
	void *all, double largest, double load, double *carried)
{
	const double step = 0.98;
	double low = largest, high = largest, here = 0;

	*carried = 0;
	for (; high > 1e-12 * largest; high = low) {
		low = fmax(high * step, admits ? admits(all, high) : 0);
		here = carry(all, low);
		*carried = fmax(*carried, here);
		if (here >= load)
			break;
	}
	if (*carried < load)
		return NAN;
	*carried = here;
	/* Each step halves an interval of 2 % of the gap: to rounding. */
	for (int k = 0; k < 48 && *carried != load; k++) {
		double middle = 0.5 * (low + high);

		here = carry(all, middle);
		if (here >= load) {
			low = middle;
			*carried = here;
		} else {
			high = middle;
		}
	}
	return low;
}

struct sample {
	struct abrasion_par par;
	const double *diameter, *aspect;
	long n;
	double evaluations;
};

/* Load that all carry; that of particles that yield is not known and left out. */
static double carry(void *all, double gap)
{
	struct sample *s = all;
	double sum = 0;

	s->par.gap = gap;
	for (long i = 0; i < s->n; i++) {
		struct abrasion a;

		if (!(s->diameter[i] > gap))
			continue;
		abrasion_particle(
			&s->par, s->diameter[i], s->aspect ? s->aspect[i] : 1, &a);
		s->evaluations++;
		if (a.load > 0)
			sum += a.load;
	}
	return sum;
}

/* The widest of the gaps below high that are the narrowest to admit a particle: there its
 * load is largest. */
static double admits(void *all, double high)
{
	const struct sample *s = all;
	double square = s->par.friction * s->par.friction, widest = 0;

	if (isinf(s->par.inlet))
		return 0;
	for (long i = 0; i < s->n; i++) {
		double gap = (s->diameter[i] - 2 * square * s->par.inlet) / (1 + square);

		gap *= 1 + 1e-14; /* rounding */
		if (gap < high && gap > widest)
			widest = gap;
	}
	return widest;
}

double abrasion_gap(const struct abrasion_par *par, const double *diameter,
	const double *aspect, long n, double load, double *carried, double *evaluations)
{
	struct sample s = { *par, diameter, aspect, n, 0 };
	double largest = 0, gap;

	for (long i = 0; i < n; i++)
		largest = fmax(largest, diameter[i]);
	gap = abrasion_widest(carry, admits, &s, largest, load, carried);
	*evaluations += s.evaluations;
	return gap;
}
