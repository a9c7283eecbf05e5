/* heights.c - heights of given skewness and kurtosis */
#include "surface/heights.h"
#include "num/deviates.h"
#include "num/status.h"
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* ---- Johnson's system ---- */

enum family { LOGNORMAL, UNBOUNDED, BOUNDED };

/* Normal deviates y with weights that sum to 1, for the moments. */
struct normals {
	size_t n;
	double *y, *weight; /* weight NULL: all alike */
};

struct johnson {
	enum family family;
	double rate;  /* 1 / delta */
	double shift; /* gamma / delta */
};

static double johnson_height(const struct johnson *j, double y)
{
	double u = y * j->rate + j->shift;

	switch (j->family) {
	case UNBOUNDED:
		return sinh(u);
	case BOUNDED:
		/* The logistic function, without loss where it is near 0. */
		return u < 0 ? exp(u) / (1 + exp(u)) : 1 / (1 + exp(-u));
	default:
		return expm1(u);
	}
}

struct moments {
	double mean, sd, skewness, kurtosis;
};

static struct moments take_moments(const struct johnson *j, const struct normals *set)
{
	struct moments m = { 0, 0, 0, 0 };
	double m2 = 0, m3 = 0, m4 = 0;

	for (size_t i = 0; i < set->n; i++) {
		double w = set->weight ? set->weight[i] : 1.0 / (double)set->n;

		m.mean += w * johnson_height(j, set->y[i]);
	}
	for (size_t i = 0; i < set->n; i++) {
		double w = set->weight ? set->weight[i] : 1.0 / (double)set->n;
		double d = johnson_height(j, set->y[i]) - m.mean;

		m2 += w * d * d;
		m3 += w * d * d * d;
		m4 += w * d * d * d * d;
	}
	m.sd = sqrt(m2);
	m.skewness = m3 / (m2 * m.sd);
	m.kurtosis = m4 / (m2 * m2);
	return m;
}

/* ---- fitting ---- */

/* All searches bisect: the moments of truncated sets are monotone, but Newton's method
 * need not converge far from the solution. */
/* 2^-60 of the interval is less than the rounding of its middle. */
enum { BISECTIONS = 60 };

/* Shift that gives the family of this rate the skewness; the lognormal limit of both
 * families is reached, to rounding, at a shift of 20: sinh there is an
 * exponential to e^-40. */
static void fit_shift(struct johnson *j, double skewness, const struct normals *set)
{
	double low = 0, high = 20;

	if (j->family == BOUNDED)
		high += 10 * j->rate; /* past the largest |y| */
	for (int i = 0; i < BISECTIONS; i++) {
		double middle = (low + high) / 2;

		j->shift = j->family == BOUNDED ? -middle : middle;
		if (take_moments(j, set).skewness < skewness)
			low = middle;
		else
			high = middle;
	}
}

/* A lognormal distribution of rate w has kurtosis 3 + 16 w^2 where w is small: at the
 * least rate that of the normal distribution, to less than refine() accepts; the shift
 * gives the skewness.  At the most, the largest of a million quantiles, 0.2 beyond the
 * next, exceeds it e^12 times: the moments are those of a single height, the most that a
 * set can have. */
static const double LEAST_RATE = 1e-4, MOST_RATE = 60;

/* Rate of the lognormal distribution of this skewness. */
static double fit_lognormal(double skewness, const struct normals *set)
{
	double low = LEAST_RATE, high = MOST_RATE;

	for (int i = 0; i < BISECTIONS; i++) {
		struct johnson j = { LOGNORMAL, sqrt(low * high), 0 };

		if (take_moments(&j, set).skewness < skewness)
			low = j.rate;
		else
			high = j.rate;
	}
	return low;
}

/* Member of Johnson's system with these moments, skewness >= 0, on a coarse set. */
static struct johnson fit_coarse(
	double skewness, double kurtosis, const struct normals *set)
{
	double low = fit_lognormal(skewness, set), high = MOST_RATE;
	struct johnson j = { LOGNORMAL, low, 0 };
	double turn = take_moments(&j, set).kurtosis;

	j.family = kurtosis > turn ? UNBOUNDED : BOUNDED;
	for (int i = 0; i < BISECTIONS; i++) {
		j.rate = sqrt(low * high);
		fit_shift(&j, skewness, set);
		if ((take_moments(&j, set).kurtosis < kurtosis) ==
			(j.family == UNBOUNDED))
			low = j.rate;
		else
			high = j.rate;
	}
	return j;
}

/* Newton's method on the full set from the coarse fit; 1 when within tolerance. */
static int refine(
	struct johnson *j, double skewness, double kurtosis, const struct normals *set)
{
	/* accept: as the header says; done: the rounding of sums of fourth powers.
	 * Forward differences of a step of 1e-5 are wrong by about as much, so that each
	 * iteration gains five digits; the choice has no part in the result. */
	const double accept = 1e-6, done = 1e-12, nudge = 1e-5;
	/* Fits that succeed take at most 8: 660 of skewness 0 to 2 and kurtosis to 30,
	 * for 4 to 65536 heights. */
	enum { ITERATIONS = 20 };
	double error = INFINITY;

	for (int i = 0; i < ITERATIONS; i++) {
		struct moments m = take_moments(j, set), ms, mr;
		struct johnson s = *j, r = *j;
		double ds = nudge * (1 + fabs(j->shift)), dr = nudge * j->rate;
		double e1 = skewness - m.skewness, e2 = kurtosis - m.kurtosis, det;

		error = fabs(e1) + fabs(e2);
		if (!(error > done))
			break;
		s.shift += ds;
		r.rate += dr;
		ms = take_moments(&s, set);
		mr = take_moments(&r, set);
		ms.skewness = (ms.skewness - m.skewness) / ds;
		ms.kurtosis = (ms.kurtosis - m.kurtosis) / ds;
		mr.skewness = (mr.skewness - m.skewness) / dr;
		mr.kurtosis = (mr.kurtosis - m.kurtosis) / dr;
		det = ms.skewness * mr.kurtosis - mr.skewness * ms.kurtosis;
		if (det == 0 || !isfinite(det))
			break;
		j->shift += (e1 * mr.kurtosis - e2 * mr.skewness) / det;
		j->rate += (e2 * ms.skewness - e1 * ms.kurtosis) / det;
		if (!(j->rate > 0) || !isfinite(j->rate) || !isfinite(j->shift))
			return 0;
	}
	return error <= accept;
}

/* Trapezoidal nodes over the range of n quantiles, weighted by the normal density.  A
 * step of 2 / 75, over the +-5.3 of ten million quantiles, integrates exp(s y) times that
 * density to rounding; what differs, sums of n quantiles, is refine()'s. */
static enum num_status coarse_set(struct normals *set, size_t n)
{
	enum { NODES = 401 };
	double edge = normal_quantile(1 - 0.5 / (double)n), sum = 0;

	set->n = NODES;
	set->y = malloc(NODES * sizeof *set->y);
	set->weight = malloc(NODES * sizeof *set->weight);
	if (!set->y || !set->weight)
		return NUM_MEMORY;
	for (int i = 0; i < NODES; i++) {
		set->y[i] = edge * (2.0 * i / (NODES - 1) - 1);
		set->weight[i] = exp(-set->y[i] * set->y[i] / 2);
		sum += set->weight[i];
	}
	for (int i = 0; i < NODES; i++)
		set->weight[i] /= sum;
	return NUM_OK;
}

static void free_set(struct normals *set)
{
	free(set->y);
	free(set->weight);
}

static void fill_sorted(
	const struct johnson *j, const struct normals *set, int mirror, double *sorted)
{
	struct moments m = take_moments(j, set);

	for (size_t i = 0; i < set->n; i++) {
		double z = (johnson_height(j, set->y[i]) - m.mean) / m.sd;

		sorted[mirror ? set->n - 1 - i : i] = mirror ? -z : z;
	}
}

enum heights_status heights_sorted(
	size_t n, double skewness, double kurtosis, double *sorted)
{
	struct normals set = { n, NULL, NULL }, coarse = { 0, NULL, NULL };
	enum heights_status status = HEIGHTS_MEMORY;
	struct johnson j;

	if (!(kurtosis > skewness * skewness + 1))
		return HEIGHTS_IMPOSSIBLE;
	set.y = malloc(n * sizeof *set.y);
	if (set.y && coarse_set(&coarse, n) == NUM_OK) {
		for (size_t i = 0; i < n; i++)
			set.y[i] = normal_quantile(((double)i + 0.5) / (double)n);
		j = fit_coarse(fabs(skewness), kurtosis, &coarse);
		status = HEIGHTS_TOO_FEW;
		if (refine(&j, fabs(skewness), kurtosis, &set)) {
			fill_sorted(&j, &set, skewness < 0, sorted);
			status = HEIGHTS_OK;
		}
	}
	free_set(&set);
	free_set(&coarse);
	return status;
}

/* ---- ordering ---- */

struct item {
	uint64_t key;
	size_t place;
};

struct ranking {
	size_t n;
	struct item *items, *other;
};

struct ranking *ranking_new(size_t n)
{
	struct ranking *r = calloc(1, sizeof *r);

	if (!r)
		return NULL;
	r->n = n;
	r->items = malloc(n * sizeof *r->items);
	r->other = malloc(n * sizeof *r->other);
	if (r->items && r->other)
		return r;
	ranking_free(r);
	return NULL;
}

void ranking_free(struct ranking *r)
{
	if (!r)
		return;
	free(r->items);
	free(r->other);
	free(r);
}

/* Unsigned integer in the order of the numbers. */
static uint64_t order_key(double x)
{
	uint64_t bits;

	memcpy(&bits, &x, sizeof bits);
	return bits >> 63 ? ~bits : bits | (uint64_t)1 << 63;
}

/* One stable pass of a radix sort over DIGIT bits; items and other change roles. */
static void sort_pass(struct ranking *r, int shift)
{
	enum { DIGIT = 11, SLOTS = 1 << DIGIT };
	size_t start[SLOTS + 1] = { 0 };
	struct item *t;

	for (size_t i = 0; i < r->n; i++)
		start[(r->items[i].key >> shift & (SLOTS - 1)) + 1]++;
	for (int d = 0; d < SLOTS; d++)
		start[d + 1] += start[d];
	for (size_t i = 0; i < r->n; i++)
		r->other[start[r->items[i].key >> shift & (SLOTS - 1)]++] = r->items[i];
	t = r->items;
	r->items = r->other;
	r->other = t;
}

void ranking_impose(struct ranking *r, const double *sorted, double *z)
{
	for (size_t i = 0; i < r->n; i++)
		r->items[i] = (struct item){ order_key(z[i]), i };
	for (int shift = 0; shift < 64; shift += 11)
		sort_pass(r, shift);
	for (size_t k = 0; k < r->n; k++)
		z[r->items[k].place] = sorted[k];
}
