/* Normal numbers by the ziggurat: moments, tails, distribution, independence, address. */
#include "num/normals.h"
#include "tap.h"
#include <stdlib.h>

enum { PAIRS = 2000000, BINS = 200 };

/* Deviation of a count from n p in standard deviations. */
static double sigmas(double count, double n, double p)
{
	return (count - n * p) / sqrt(n * p * (1 - p));
}

/* Many at once: enough for every layer and the tail, and over a carry of the index. */
static void test_many(const struct normals *n)
{
	enum { MANY = 100003 };
	static double pairs[2 * MANY];
	const uint64_t first = ((uint64_t)1 << 32) - 5000;
	int differ = 0;

	normals_pairs(n, first, MANY, pairs);
	for (uint64_t i = 0; i < MANY; i++) {
		double z[2];

		normals_pair(n, first + i, z);
		differ += z[0] != pairs[2 * i] || z[1] != pairs[2 * i + 1];
	}
	ok(differ == 0, "many deviates at once equal those drawn one by one");
}

int main(void)
{
	struct normals *n = normals_new(11, 3, RNG_NOISE);
	static double bin[BINS];
	static const double far[] = { 2, 3, 3.442619855899, 4, 4.5 };
	double sum[5] = { 0 }, product = 0, chi2 = 0, beyond[5] = { 0 }, high = 0, a[2],
	       b[2];
	double total = 2.0 * PAIRS;

	for (uint64_t i = 0; i < PAIRS; i++) {
		double z[2];

		normals_pair(n, i, z);
		product += z[0] * z[1];
		for (int c = 0; c < 2; c++) {
			double power = 1, p = 0.5 * erfc(-z[c] / sqrt(2));

			for (int k = 0; k < 5; k++)
				sum[k] += power *= z[c];
			for (int k = 0; k < 5; k++)
				beyond[k] += fabs(z[c]) > far[k];
			high += z[c] > 3.442619855899;
			bin[(int)fmin(BINS - 1, p * BINS)]++;
		}
	}
	/* standard deviations of the mean powers: sqrt(1, 2, 15, 96, 945) / sqrt(total)
	 */
	near(sum[0] / total, 0, 4 * sqrt(1 / total), "the mean is 0");
	near(sum[1] / total, 1, 4 * sqrt(2 / total), "the second moment is 1");
	near(sum[2] / total, 0, 4 * sqrt(15 / total), "the third moment is 0");
	near(sum[3] / total, 3, 4 * sqrt(96 / total), "the fourth moment is 3");
	near(product / PAIRS, 0, 4 / sqrt(PAIRS),
		"the two deviates of a pair are independent");
	for (int k = 0; k < 5; k++) {
		double s = sigmas(beyond[k], total, erfc(far[k] / sqrt(2)));

		ok(fabs(s) < 4, "the share beyond %.2f is right within %.1f sigma",
			far[k], s);
	}
	ok(fabs(sigmas(high, beyond[2], 0.5)) < 4, "both tails have the same share");
	for (int k = 0; k < BINS; k++)
		chi2 += pow(bin[k] - total / BINS, 2) / (total / BINS);
	/* 199 degrees of freedom: mean 199, standard deviation 20 */
	ok(chi2 > 119 && chi2 < 279, "the chi-square of %d equal bins is %.0f", BINS,
		chi2);
	normals_pair(n, 123456789, a);
	normals_pair(n, 5, b);
	normals_pair(n, 123456789, b);
	ok(a[0] == b[0] && a[1] == b[1], "a pair depends on its index alone");
	test_many(n);
	normals_free(n);
	n = normals_new(11, 4, RNG_NOISE);
	normals_pair(n, 123456789, b);
	ok(a[0] != b[0], "realisations differ");
	normals_free(n);
	return tap_done();
}
