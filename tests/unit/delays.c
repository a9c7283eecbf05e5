/* Sets of delays: losses, scores, levels without data, and the thesis' training set */
#include "net/delaydata.h"
#include "net/delayloss.h"
#include "num/philox.h"
#include "tap.h"
#include <string.h>

static double uniform(long i)
{
	return philox_uniform(3, 0, RNG_NETWORK, (uint64_t)i);
}

/* Least squared difference over all 24 orders, by trying them. */
static double try_orders(const network_real *a, const network_real *b)
{
	double best = INFINITY;

	for (int k = 0; k < 256; k++) {
		int p[4] = { k & 3, k >> 2 & 3, k >> 4 & 3, k >> 6 & 3 };
		double sum = 0;

		if ((1 << p[0] | 1 << p[1] | 1 << p[2] | 1 << p[3]) != 15)
			continue;
		for (int i = 0; i < 4; i++)
			sum += pow((double)a[p[i]] - b[i], 2) / 4;
		best = fmin(best, sum);
	}
	return best;
}

static void check_orders(void)
{
	struct delayloss_par par = { 1, DELAYLOSS_SQUARED };
	double worst = 0;

	for (int s = 0; s < 200; s++) {
		network_real a[4], b[4], slope[4];
		struct delayscore score = { 0 };

		for (int i = 0; i < 4; i++) {
			a[i] = (network_real)(s % 5 ? uniform(8 * s + i) : 0.5);
			b[i] = (network_real)uniform(8 * s + 4 + i);
		}
		delayscore_add(&score, &par, 1, 4, a, b);
		delayscore_finish(&score);
		worst = tap_max(worst, fabs(score.unordered - try_orders(a, b)));
		worst = tap_max(worst, fabs(delayloss_unordered(NULL, 1, 4, a, b, slope) -
					       try_orders(a, b)));
	}
	ok(worst < 1e-15,
		"loss (3-21) by sorting equals the least over all orders to %.1g", worst);
}

/* By hand: outputs 1 2 3, labels 1 1 4: sums 6 and 6, variances 2/3 and 2. */
static void check_sums(void)
{
	network_real a[6] = { 1, 2, 3, 1, 2, 4 }, b[6] = { 1, 1, 4, 1, 1, 4 }, slope[6];
	struct delayloss_par par = { 3, DELAYLOSS_SQUARED };

	near(delayloss_sums(&par, 1, 3, a, b, slope), 3 * 16.0 / 9, 1e-12,
		"the squared loss (3-20) is right");
	par.penalty = DELAYLOSS_ABSOLUTE;
	near(delayloss_sums(&par, 1, 3, a, b, slope), 3 * 4.0 / 3, 1e-12,
		"the absolute loss (3-20) is right");
	par.lambda = 0;
	near(delayloss_sums(&par, 2, 3, a, b, slope), 0.5, 1e-12,
		"the loss is the mean over samples");
	near(slope[3], 1, 1e-6, "the gradient of the squared sum is right");
}

/* The four levels drawn, within four standard errors of 1e5 draws. */
static void check_levels(void)
{
	enum { N = 100000 };
	struct delaylevels l = delaylevels(3);
	struct delayloss_par par = { 1, DELAYLOSS_SQUARED };
	struct delayscore half = { 0 }, sorted = { 0 }, draw = { 0 };

	near(l.constant, 1 / 12.0, 1e-15, "the loss of a constant is 1/12");
	near(l.constant_sorted, 1 / 24.0, 1e-15,
		"the loss of sorted constants against sorted labels is 1/24");
	near(l.sorted_ordered, 1 / 8.0, 1e-15,
		"the loss of sorted constants against unsorted labels is 1/8");
	near(l.draw, 1 / 6.0, 1e-15, "the loss of random delays is 1/6");
	near(delaylevels(1).constant_sorted, 1 / 12.0, 1e-15,
		"with one source both orders agree");
	for (int i = 0; i < N; i++) {
		network_real label[3], any[3], mean[3] = { 0.25, 0.5, 0.75 },
					       same[3] = { 0.5, 0.5, 0.5 };

		for (int k = 0; k < 3; k++) {
			label[k] = (network_real)uniform(1000 + 6 * i + k);
			any[k] = (network_real)uniform(1003 + 6 * i + k);
		}
		delayscore_add(&half, &par, 1, 3, same, label);
		delayscore_add(&sorted, &par, 1, 3, mean, label);
		delayscore_add(&draw, &par, 1, 3, any, label);
	}
	delayscore_finish(&half);
	delayscore_finish(&sorted);
	delayscore_finish(&draw);
	near(half.ordered, l.constant, 4 * half.ordered_se,
		"the loss of the constant agrees with drawn samples");
	near(sorted.unordered, l.constant_sorted, 4 * sorted.unordered_se,
		"the loss of sorted constants agrees with drawn samples");
	near(sorted.sorted, l.constant_sorted, 4 * sorted.unordered_se,
		"the loss of sorted constants by position is the same");
	near(sorted.ordered, l.sorted_ordered, 4 * sorted.ordered_se,
		"the loss of sorted constants against unsorted labels agrees with drawn samples");
	near(draw.ordered, l.draw, 4 * draw.ordered_se,
		"the loss of random delays agrees with drawn samples");
}

/* The scene of section 3.3. */
static struct delaydata_par plain(void)
{
	return (struct delaydata_par){
		.points = 500,
		.sources = 3,
		.span = 4 * M_PI,
		.section = DELAYDATA_LENGTH,
		.length = { M_PI / 2, 3 * M_PI / 2 },
		.amplitude = { 0, 1 },
		.gain = { 0.909, 0.909 },
		.unit = 1,
		.order = DELAYDATA_DRAWN,
		.seed = 1,
	};
}

/* One complete source: its second channel is the first, shifted by the delay. */
static void check_shift(void)
{
	struct delaydata_par par = plain();
	network_real x[2 * 1000], delay[1];
	double worst = 0;
	int moved = 0;

	par.points = 1000;
	par.sources = 1;
	par.length[0] = par.length[1] = M_PI;
	par.unit = par.span / 10;
	for (uint32_t i = 0; i < 20; i++) {
		double c[2] = { 0 }, m[2] = { 0 };

		delaydata_sample(&par, i, x, delay);
		/* A half wave without jumps: its centre of mass moves with it. */
		for (int p = 0; p < 2000; p++) {
			c[p / 1000] += x[p] * (network_real)(p % 1000);
			m[p / 1000] += x[p];
		}
		if (m[0] < 0.5)
			continue;
		moved++;
		worst = tap_max(worst, fabs(c[1] / m[1] - c[0] / m[0] - 100 * delay[0]));
		worst = tap_max(worst, 20 * fabs(m[1] / m[0] - 0.909));
	}
	ok(moved > 10 && worst < 0.02,
		"the second channel is 0.909 of the first and later by "
		"the delay, to %.2g points",
		worst);
}

static void check_orders_of_labels(void)
{
	struct delaydata_par par = plain();
	network_real x[1000], y[1000], drawn[3], sorted[3], arrival[3];
	int same = 1, rising = 1, differs = 0;

	for (uint32_t i = 0; i < 50; i++) {
		double sum = 0;

		par.order = DELAYDATA_DRAWN;
		delaydata_sample(&par, i, x, drawn);
		par.order = DELAYDATA_SORTED;
		delaydata_sample(&par, i, y, sorted);
		par.order = DELAYDATA_ARRIVAL;
		delaydata_sample(&par, i, y, arrival);
		for (int k = 0; k < 1000; k++)
			sum = tap_max(sum, fabs((double)x[k] - y[k]));
		same = same && sum < 1e-6;
		rising = rising && sorted[0] <= sorted[1] && sorted[1] <= sorted[2];
		differs += memcmp(drawn, arrival, sizeof drawn) != 0;
	}
	ok(same, "the order of the labels does not change the signal");
	ok(rising, "sorted labels are ascending");
	ok(differs > 30, "the order of arrivals differs in %d of 50 samples", differs);
}

static void check_noise(void)
{
	struct delaydata_par par = plain();
	network_real x[1000], y[1000], delay[3];
	double sum = 0, n = 0;

	for (uint32_t i = 0; i < 40; i++) {
		par.noise = 0;
		delaydata_sample(&par, i, x, delay);
		par.noise = 0.3;
		delaydata_sample(&par, i, y, delay);
		for (int k = 0; k < 1000; k++, n++)
			sum += pow((double)y[k] - x[k], 2);
	}
	near(sqrt(sum / n), 0.3, 4 * 0.3 / sqrt(2 * n),
		"noise of the stated deviation is added");
}

int main(void)
{
	check_orders();
	check_sums();
	check_levels();
	check_shift();
	check_orders_of_labels();
	check_noise();
	return tap_done();
}
