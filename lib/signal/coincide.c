/* coincide.c - see coincide.h */
#include "signal/coincide.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	LATELY = 1024, /* rows that the present is judged by */
	BINS = 160,    /* of amplitudes from 1 to exp(16) */
	STEPS = 51     /* of distances up to half a duration */
};

/* Width of a bin: an amplitude by a tenth, a diameter by a thirtieth. */
static const double BIN = 0.1;

/* Expected share of sums among the rows that are taken for single, or half a row. */
static const double SHARE = 0.005;

/* Shape of the gamma distribution of mean one of the factor by which sums are more than
 * expected.  With 2, 4 and 10, 6, 4 and 3 sums stay believed of the 397 particles of
 * tests/matrix/run, dense-100, seed 4; in scene group, seeds 1 and 4, where arrivals keep
 * a distance, 0, 3 and 10 rows of 200 are taken for sums. */
static const double SURE = 4;

/* Rows in a bin: none, and still with a logarithm. */
static const double LEAST = 1e-9;

struct row {
	double place, height, reach;
};

struct coincide {
	double left[STEPS]; /* of the energy of two equal pulses by one in their place */
	struct row row[LATELY];
	size_t rows; /* taken in so far */
	size_t next; /* of these, when to learn again */
	double odds[BINS], limit;
};

struct coincide *coincide_new(void)
{
	return calloc(1, sizeof(struct coincide));
}

void coincide_free(struct coincide *c)
{
	free(c);
}

/* --- what a fit cannot tell */

enum num_status coincide_shape(struct coincide *c, const struct shape *shape)
{
	enum { T = 2 * (STEPS - 1) }; /* a step is one sample, and so is half of two */
	size_t n = (size_t)(2 * shape_reach(shape) * T) + 2;
	double *p = calloc(n + T, sizeof *p), r[STEPS] = { 0 };

	if (!p)
		return NUM_MEMORY;
	shape_sample(shape, shape_reach(shape) * T, T, 0, n, p, NULL, NULL);
	for (size_t k = 0; k < STEPS; k++)
		for (size_t i = 0; i < n; i++)
			r[k] += p[i] * p[i + k];
	for (size_t k = 0; k < STEPS; k++) {
		double half = 0.5 * (r[k / 2] + r[(k + 1) / 2]) / r[0];

		c->left[k] = 0.5 + 0.5 * r[k] / r[0] - half * half;
	}
	free(p);
	return NUM_OK;
}

double coincide_reach(const struct coincide *c, double energy, double need)
{
	double share = need / energy;
	int k = 2; /* half a step is not a whole sample */

	while (k < STEPS - 2 && c->left[k] < share)
		k += 2;
	return fmin(k * pow(share / c->left[k], 0.25), STEPS - 1) / (2 * (STEPS - 1));
}

/* --- what has been seen */

void coincide_take(struct coincide *c, double place, double height, double reach)
{
	c->row[c->rows++ % LATELY] = (struct row){ place, height, reach };
}

static size_t held(const struct coincide *c)
{
	return c->rows < LATELY ? c->rows : LATELY;
}

static int bin(double height)
{
	double k = floor(log(height) / BIN);

	return k > 0 ? k < BINS ? (int)k : BINS - 1 : 0;
}

/* Pulses per duration behind another, by half a duration of distances that are told
 * apart for certain. */
static double density(const struct coincide *c)
{
	size_t n = held(c);
	double pairs = 0;

	for (size_t i = 0; i < n; i++) {
		const struct row *a = &c->row[(c->rows - n + i) % LATELY];

		for (size_t k = i + 1; k < n; k++) {
			double d = c->row[(c->rows - n + k) % LATELY].place - a->place -
				   2 * a->reach;

			if (d > 0.5)
				break;
			pairs += d > 0;
		}
	}
	return pairs / (0.5 * (double)n);
}

/* Share of pairs within reach on one sensor, their distance being anything, that are so
 * on the other, too. */
static double together(double reach, double spread)
{
	double z = M_SQRT2 * reach / spread;

	return spread > 0 && reach > 0
		       ? erf(z / M_SQRT2) - sqrt(2 / M_PI) * (1 - exp(-z * z / 2)) / z
		       : 1;
}

static void smooth(const double *x, const double *kernel, double *y)
{
	for (int k = 0; k < BINS; k++) {
		y[k] = 0;
		for (int i = 0; i < BINS; i++)
			if (x[i] > 0)
				y[k] += x[i] * kernel[abs(k - i)];
	}
}

static void make_kernel(double width, double *kernel)
{
	double norm = 0;

	for (int k = 0; k < BINS; k++) {
		kernel[k] = k < 5 * width ? exp(-0.5 * k * k / (width * width)) : 0;
		norm += kernel[k] * (k ? 2 : 1);
	}
	for (int k = 0; k < BINS; k++)
		kernel[k] /= norm;
}

/* The kernel that makes each amplitude most likely by the others, and what it makes of
 * them. */
static void choose_kernel(const double *count, double *kernel, double *all)
{
	double best = -INFINITY, chosen = 0.5;

	for (double width = 0.5; width < 16; width *= M_SQRT2) {
		double sum = 0;

		make_kernel(width, kernel);
		smooth(count, kernel, all);
		for (int k = 0; k < BINS; k++)
			if (count[k] > 0)
				sum += count[k] * log(fmax(all[k] - kernel[0], LEAST));
		if (sum > best) {
			best = sum;
			chosen = width;
		}
	}
	make_kernel(chosen, kernel);
	smooth(count, kernel, all);
}

/* Distribution of the sums of one of either. */
static void add_up(const double *x, const double *y, double *sum)
{
	double more[BINS]; /* bins from the larger of two to their sum */

	for (int k = 0; k < BINS; k++) {
		more[k] = log1p(exp(-BIN * k)) / BIN;
		sum[k] = 0;
	}
	for (int i = 0; i < BINS; i++)
		for (int k = 0; k < BINS && x[i] > 0; k++) {
			double at = (i > k ? i : k) + more[abs(i - k)];
			int below = (int)at;

			if (y[k] > 0 && below + 1 < BINS) {
				sum[below] += x[i] * y[k] * (below + 1 - at);
				sum[below + 1] += x[i] * y[k] * (at - below);
			}
		}
}

/* Rows by amplitude, and their mean reach, which holds up to the next that are any. */
static void count_rows(const struct coincide *c, double *count, double *reach)
{
	memset(count, 0, BINS * sizeof *count);
	memset(reach, 0, BINS * sizeof *reach);
	for (size_t i = 0; i < held(c); i++) {
		count[bin(c->row[i].height)]++;
		reach[bin(c->row[i].height)] += c->row[i].reach;
	}
	for (int k = 0; k < BINS; k++)
		if (count[k] > 0)
			reach[k] /= count[k];
		else if (k > 0)
			reach[k] = reach[k - 1];
}

/* Odds, per unit of reach, of each amplitude to be a sum of two.  How many sums there are
 * is expected from the density, but for a factor that is gamma-distributed before the
 * rows tell more. */
static void learn_odds(struct coincide *c, double per_row)
{
	enum { ROUNDS = 40 };
	double n = (double)held(c), factor = 1, count[BINS], reach[BINS], all[BINS],
	       single[BINS], kernel[BINS], sum[BINS], weighed[BINS];

	count_rows(c, count, reach);
	choose_kernel(count, kernel, all);
	for (int round = 0; round < ROUNDS; round++) {
		double left = 0, expected = 0;

		for (int k = 0; k < BINS; k++) {
			weighed[k] = count[k] / (1 + c->odds[k] * reach[k]);
			left += weighed[k];
		}
		smooth(weighed, kernel, single);
		add_up(single, all, sum);
		for (int k = 0; k < BINS; k++) {
			sum[k] *= per_row / left;
			expected += sum[k] * reach[k];
		}
		if (!(expected > 0))
			return;
		if (round > 0)
			factor = (SURE + n - left) / (SURE + expected);
		for (int k = 0; k < BINS; k++) {
			double own = count[k] > 0 ? kernel[0] * weighed[k] / count[k] : 0;

			c->odds[k] = factor * sum[k] / fmax(single[k] - own, LEAST);
		}
	}
}

static double probability(const struct coincide *c, double height, double reach)
{
	double odds = c->odds[bin(height)] * reach;

	return odds / (1 + odds);
}

static int ascending(const void *x, const void *y)
{
	const double *a = x, *b = y;

	return (*a > *b) - (*a < *b);
}

void coincide_learn(struct coincide *c, double spread)
{
	double p[LATELY], sum = 0, mean = 0;
	double per_row = density(c);
	size_t n = held(c), k = 0;

	if (c->rows < c->next)
		return;
	c->next = c->rows + n / 8 + 1;
	c->limit = 1;
	memset(c->odds, 0, sizeof c->odds);
	if (!(per_row > 0))
		return;
	for (size_t i = 0; i < n; i++)
		mean += c->row[i].reach / (double)n;
	learn_odds(c, per_row * together(mean, spread));
	for (size_t i = 0; i < n; i++)
		p[i] = probability(c, c->row[i].height, c->row[i].reach);
	qsort(p, n, sizeof *p, ascending);
	while (k < n && sum + p[k] <= fmax(SHARE * (double)(k + 1), 0.5))
		sum += p[k++];
	if (k < n)
		c->limit = p[k];
}

int coincide_is_sum(const struct coincide *c, double height, double reach)
{
	return probability(c, height, reach) >= c->limit;
}
