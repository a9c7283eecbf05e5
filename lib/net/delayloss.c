/* delayloss.c - losses and scores of a set of delays whose order means nothing */
#include "net/delayloss.h"
#include <math.h>

/* Places of the values of x from the smallest to the largest; equal values keep their
 * order. */
static void rank_delays(const network_real *x, int n, int *place)
{
	for (int i = 0; i < n; i++) {
		int k = i;

		for (; k > 0 && x[place[k - 1]] > x[i]; k--)
			place[k] = place[k - 1];
		place[k] = i;
	}
}

static double mean_of(const network_real *x, int n)
{
	double sum = 0;

	for (int i = 0; i < n; i++)
		sum += x[i];
	return sum / n;
}

static double variance_of(const network_real *x, int n, double mean)
{
	double sum = 0;

	for (int i = 0; i < n; i++)
		sum += (x[i] - mean) * (x[i] - mean);
	return sum / n;
}

/* (3-20) of one sample; its gradient unless NULL. */
static double sums_loss(const struct delayloss_par *par, int n,
	const network_real *output, const network_real *label, network_real *gradient)
{
	double mean = mean_of(output, n), want = mean_of(label, n);
	double sum = n * (mean - want);
	double spread = variance_of(output, n, mean) - variance_of(label, n, want);
	double phi = par->penalty == DELAYLOSS_SQUARED ? spread * spread : fabs(spread);
	double by_spread = par->penalty == DELAYLOSS_SQUARED
				   ? 2 * spread
				   : (spread > 0) - (spread < 0);

	for (int i = 0; i < n && gradient; i++)
		gradient[i] = (network_real)(2 * sum + par->lambda * by_spread * 2 *
							       (output[i] - mean) / n);
	return sum * sum + par->lambda * phi;
}

double delayloss_sums(const void *context, int n, int width, const network_real *output,
	const network_real *target, network_real *gradient)
{
	double sum = 0;

	for (int s = 0; s < n; s++)
		sum += sums_loss(context, width, output + s * width, target + s * width,
			gradient + s * width);
	for (int i = 0; i < n * width; i++)
		gradient[i] /= (network_real)n;
	return sum / n;
}

double delayloss_unordered(const void *context, int n, int width,
	const network_real *output, const network_real *target, network_real *gradient)
{
	double sum = 0, scale = 1.0 / ((double)n * width);
	int a[DELAYS_MAX], b[DELAYS_MAX];

	(void)context;
	for (int s = 0; s < n; s++, output += width, target += width, gradient += width) {
		rank_delays(output, width, a);
		rank_delays(target, width, b);
		for (int i = 0; i < width; i++) {
			double d = (double)output[a[i]] - target[b[i]];

			sum += d * d;
			gradient[a[i]] = (network_real)(2 * scale * d);
		}
	}
	return sum * scale;
}

void delayscore_add(struct delayscore *score, const struct delayloss_par *par, int n,
	int width, const network_real *output, const network_real *label)
{
	int a[DELAYS_MAX], b[DELAYS_MAX];

	for (int s = 0; s < n; s++, output += width, label += width) {
		double ordered = 0, unordered = 0, sorted = 0;

		rank_delays(output, width, a);
		rank_delays(label, width, b);
		for (int i = 0; i < width; i++) {
			ordered += pow((double)output[i] - label[i], 2) / width;
			unordered += pow((double)output[a[i]] - label[b[i]], 2) / width;
			sorted += pow((double)output[i] - label[b[i]], 2) / width;
		}
		score->samples++;
		score->ordered += ordered;
		score->unordered += unordered;
		score->sorted += sorted;
		score->sums += sums_loss(par, width, output, label, NULL);
		score->ordered_se += ordered * ordered;
		score->unordered_se += unordered * unordered;
	}
}

/* Standard error of a mean from the sum of squares. */
static double standard_error(double squares, double mean, double n)
{
	return n > 1 ? sqrt(fmax(squares / n - mean * mean, 0) / (n - 1)) : NAN;
}

void delayscore_finish(struct delayscore *score)
{
	double n = (double)score->samples;

	score->ordered /= n;
	score->unordered /= n;
	score->sorted /= n;
	score->sums /= n;
	score->ordered_se = standard_error(score->ordered_se, score->ordered, n);
	score->unordered_se = standard_error(score->unordered_se, score->unordered, n);
}

/* The k-th of n sorted uniform numbers has mean m = k / (n + 1) and variance
 * m (1 - m) / (n + 2); against an unsorted one, 1/12 + (m - 1/2)^2. */
struct delaylevels delaylevels(int width)
{
	struct delaylevels l = { 1.0 / 12, 0, 0, 1.0 / 6 };

	for (int k = 1; k <= width; k++) {
		double m = k / (width + 1.0);

		l.constant_sorted += m * (1 - m) / (width + 2) / width;
		l.sorted_ordered += (1.0 / 12 + (m - 0.5) * (m - 0.5)) / width;
	}
	return l;
}
