/* together.c - see together.h */
#include "signal/separate/together.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rows that the present is judged by: they know a share of 1 % to 0.6 %. */
enum { LATELY = 256 };

/* Share of pairs among the rows that are not doubted. */
static const double SHARE = 0.01;

/* Durations by which one pulse follows another that count for how often one does: nearer
 * ones may have been fitted as one. */
static const double NEAR = 0.1, FAR = 0.6;

struct together {
	double size[LATELY];   /* logarithms of amplitudes */
	int followers[LATELY]; /* pulses between NEAR and FAR behind each */
	double pair[LATELY];   /* probabilities */
	size_t rows, all;      /* taken in so far: not doubted, and all */
	double density, width; /* followers per duration; of the kernel of sizes */
	double limit;          /* probability beyond which rows are doubted */
};

struct together *together_new(void)
{
	struct together *t = calloc(1, sizeof *t);

	return t;
}

void together_free(struct together *t)
{
	free(t);
}

static size_t held(size_t count)
{
	return count < LATELY ? count : LATELY;
}

static int count_followers(const struct arrival *a, size_t i, size_t n)
{
	int count = 0;

	for (size_t k = i + 1; k < n && a[k].group == a[i].group; k++) {
		double apart = a[k].time - a[i].time;

		if (apart > FAR)
			break;
		count += apart > NEAR;
	}
	return count;
}

/* How often pulses follow, and the width of a Gaussian kernel for their sizes (Silverman,
 * Density Estimation, 1986, eq. 3.28). */
static void learn(struct together *t)
{
	double n = (double)held(t->rows), sum = 0, mean = 0, square = 0;

	for (size_t i = 0; i < held(t->all); i++)
		sum += t->followers[i];
	for (size_t i = 0; i < held(t->rows); i++)
		mean += t->size[i] / n;
	for (size_t i = 0; i < held(t->rows); i++)
		square += pow(t->size[i] - mean, 2);
	t->density = sum / (double)held(t->all) / (FAR - NEAR);
	t->width = fmax(1.06 * sqrt(square / n) * pow(n, -0.2), 0.01);
}

/* Probability density of the logarithm of the amplitude of one particle: rows count as
 * far as they are no pairs, but for the one that is asked for. */
static double size_density(const struct together *t, double x, size_t self)
{
	double sum = 0, all = 0;

	for (size_t i = 0; i < held(t->rows); i++) {
		double z = (x - t->size[i]) / t->width, one = 1 - t->pair[i];

		one = i == self ? 1 : one;
		sum += one * exp(-0.5 * z * z);
		all += one;
	}
	return sum / (sqrt(2 * M_PI) * t->width * all);
}

/* Probability that a row is a pair.  With f the density of amplitudes, pairs of sum A and
 * share w of the smaller one are A f(wA) f((1 - w)A) / f(A) times as frequent as one of
 * A, per follower. */
static double pair_probability(
	const struct together *t, const struct arrival *a, size_t self)
{
	double x = log(fabs(a->amplitude)), odds = 0, one;

	if (t->density == 0)
		return 0;
	one = size_density(t, x, self);
	for (int k = 0; k < JOINT_SHARES; k++) {
		double w = joint_share(k);

		odds += a->odds[k] * JOINT_SHARE_STEP *
			size_density(t, x + log(w), self) *
			size_density(t, x + log(1 - w), self) / (w * (1 - w) * one);
	}
	odds *= t->density;
	return odds / (1 + odds);
}

static int by_size(const void *x, const void *y)
{
	double a = *(const double *)x, b = *(const double *)y;

	return (a > b) - (a < b);
}

/* The largest probability up to which no more than SHARE of the rows are pairs. */
static double find_limit(const struct together *t)
{
	double sorted[LATELY], sum = 0;
	size_t n = held(t->rows), k = 0;

	memcpy(sorted, t->pair, n * sizeof *sorted);
	qsort(sorted, n, sizeof *sorted, by_size);
	while (k < n && sum + sorted[k] <= SHARE * (double)(k + 1))
		sum += sorted[k++];
	return k == n ? 1 : k ? sorted[k - 1] : 0;
}

/* Passes over rows that are judged together, whose probabilities depend on one another.
 */
enum { PASSES = 4 };

/* The probabilities of the rows from first on. */
static void tell_pairs(struct together *t, size_t first, struct arrival *a, size_t n)
{
	for (size_t i = 0; i < n; i++)
		if (!a[i].doubted) {
			size_t self = first++ % LATELY;

			a[i].pair = t->pair[self] = pair_probability(t, &a[i], self);
		}
}

void together_judge(struct together *t, struct arrival *a, size_t n)
{
	size_t first = t->rows;

	for (size_t i = 0; i < n; i++) {
		t->followers[t->all++ % LATELY] = count_followers(a, i, n);
		if (!a[i].doubted) {
			t->pair[t->rows % LATELY] = 0;
			t->size[t->rows++ % LATELY] = log(fabs(a[i].amplitude));
		}
	}
	if (t->rows == first)
		return;
	learn(t);
	for (int pass = 0; pass < PASSES; pass++)
		tell_pairs(t, first, a, n);
	t->limit = find_limit(t);
	for (size_t i = 0; i < n; i++)
		a[i].doubted |= a[i].pair > t->limit;
}
