/* A unit whose gap opens evenly: lives in closed form; pair and slope. */
#include "life/pair/forecast.h"
#include "life/score/metrics.h"
#include "num/rng.h"
#include "num/running.h"
#include "tap.h"
#include <gsl/gsl_randist.h>

static struct pair make_pair(void)
{
	struct pair p = { .leakage = leakage_thesis(),
		.area = 2e-3,
		.gap_new = 10e-6,
		.threshold_gap = NAN,
		.threshold_leakage = NAN,
		.threshold_volume = NAN };

	return p;
}

static void test_pair(void)
{
	struct pair p = make_pair();

	ok(isinf(pair_limit(&p)), "without a threshold there is no limit");
	p.threshold_gap = 15e-6;
	p.threshold_volume = 8e-9;
	near(pair_limit(&p), 14e-6, 1e-18, "the threshold that is reached first counts");
	near(pair_gap(&p, PAIR_VOLUME, 4e-9), 12e-6, 1e-18,
		"the gap follows from the worn volume");
	for (enum pair_quantity q = PAIR_LEAKAGE; q <= PAIR_DEBRIS; q++)
		near(pair_gap(&p, q, pair_value(&p, q, 13e-6)), 13e-6, 1e-17,
			"volume and gap are inverse functions");
}

static void test_slope(void)
{
	struct regression s = { 0 };

	regression_add(&s, 1, 2);
	ok(!isfinite(regression_slope(&s)), "one point gives no slope");
	regression_add(&s, 2, 5);
	regression_add(&s, 4, 11);
	near(regression_slope(&s), 3, 1e-14, "points on a line have its slope");
	regression_add(&s, 5, 10);
	/* sum (t - 3) (y - 7) / sum (t - 3)^2 = (10 + 2 + 4 + 6) / 10 */
	near(regression_slope(&s), 2.2, 1e-14,
		"points near a line have the least-squares slope");
}

static void test_forecast(void)
{
	struct forecast_par par = { .seed = 1,
		.count = 8,
		.step_time = NAN,
		.critical = NAN,
		.pair = make_pair(),
		.quantity = PAIR_GAP,
		.horizon = NAN };
	struct forecast_row row;
	struct forecast *f;

	par.pair.threshold_gap = 15e-6;
	f = forecast_new(&par, NULL);
	ok(f != NULL, "a forecast is made");
	ok(forecast_add(f, 0, 10e-6, 10e-6, 0, NULL) == NUM_OK &&
			forecast_at(f, 0).n == 0,
		"one row gives no rate");
	ok(forecast_add(f, 100, 11e-6, 11e-6, 0, NULL) == NUM_OK &&
			forecast_at(f, 100).n == 1,
		"two rows give the same rate for all paths");
	row = forecast_at(f, 100);
	near(row.life[0], 400, 1e-9, "4 um at 1 um per 100 s last 400 s");
	ok(isinf(row.limit) && isnan(row.grey),
		"without a horizon the grey model is unlimited");
	ok(forecast_add(f, 150, NAN, NAN, 0, NULL) == NUM_OK &&
			forecast_at(f, 150).n == 1,
		"a missing value does not change the rate");
	near(forecast_at(f, 150).life[0], 350, 1e-9, "the elapsed time is subtracted");
	near(forecast_at(f, 600).life[0], 0, 0, "the life is never below 0");
	forecast_free(f);

	par.skip = 50;
	f = forecast_new(&par, NULL);
	forecast_add(f, 0, 5e-6, 5e-6, 0, NULL);
	forecast_add(f, 100, 10e-6, 10e-6, 0, NULL);
	forecast_add(f, 200, 11e-6, 11e-6, 0, NULL);
	near(forecast_at(f, 200).life[0], 400, 1e-9,
		"run-in does not count for the rate");
	forecast_free(f);

	par.skip = 0;
	par.from_new = 1;
	f = forecast_new(&par, NULL);
	ok(forecast_add(f, 100, 12e-6, 12e-6, 0, NULL) == NUM_OK &&
			forecast_at(f, 100).n == 1,
		"a new pair at time 0 is a row");
	near(forecast_at(f, 100).life[0], 150, 1e-9, "the new pair gives a rate");
	forecast_free(f);
}

enum truth { LINEAR_LEAKAGE, LINEAR_GAP, GAMMA_GAP };

/* True gap of a pump after row k of about rows; 10 to 12.3 um, as leakage 1.5 to 2.8
 * L/min. */
static double next_gap(const struct leakage *pump, enum truth truth, int k, int rows,
	double before, gsl_rng *rng)
{
	double low = leakage_gap(pump, 1.5e-3 / 60),
	       high = leakage_gap(pump, 2.8e-3 / 60);
	double shape = 60; /* of the gamma process over its life: 13 % scatter */

	if (truth == LINEAR_LEAKAGE)
		return leakage_gap(pump, (1.5 + 1.3 * k / rows) * 1e-3 / 60);
	if (truth == LINEAR_GAP)
		return low + (high - low) * k / rows;
	return k == 0 ? low
		      : before + gsl_ran_gamma(rng, shape / rows, (high - low) / shape);
}

/* Follows one unit up to 60 % of its life, observed with 2 % of noise; 1 if the interval
 * of 90 % holds its end, *error: of the median over the life. */
static int follow_unit(enum truth truth, int by_gap, uint32_t number, double *error)
{
	enum { ROWS = 100, MOST = 400, COUNT = 200 };
	struct pair pair = make_pair();
	struct forecast_par par = { .seed = 1,
		.count = COUNT,
		.rule = RATE_FILTER,
		.step_time = NAN,
		.critical = NAN,
		.quantity = by_gap ? PAIR_GAP : PAIR_LEAKAGE,
		.horizon = NAN };
	gsl_rng *rng = rng_new(11, number, RNG_LIFE);
	double gap[MOST], limit, low, high, median, left;
	struct forecast *f;
	struct forecast_row row;
	int end = 0, now;

	pair.gap_new = NAN;
	pair.threshold_leakage = 2.8e-3 / 60;
	par.pair = pair;
	limit = pair_limit(&pair);
	for (double before = 0; end < MOST; before = gap[end++]) {
		gap[end] = next_gap(&pair.leakage, truth, end, ROWS, before, rng);
		if (gap[end] >= limit)
			break;
	}
	f = forecast_new(&par, NULL);
	now = (int)(0.6 * end);
	for (int k = 0; k <= now; k++) {
		double span = by_gap ? limit - gap[0] : 1.3e-3 / 60;
		double value = by_gap ? gap[k] : leakage_flow(&pair.leakage, gap[k]);

		value += 0.02 * span * gsl_ran_ugaussian(rng);
		forecast_add(f, k, value, pair_gap(&pair, par.quantity, value), 0, NULL);
	}
	row = forecast_at(f, now);
	metric_cut(row.life, (size_t)row.n, INFINITY);
	left = end - now;
	low = row.life[(int)(0.05 * COUNT)];
	high = row.life[(int)(0.95 * COUNT)];
	median = row.life[COUNT / 2];
	*error = fabs(median - left) / end;
	gsl_rng_free(rng);
	forecast_free(f);
	return low <= left && left <= high;
}

/* Coverage of 100 units each at 60 % of their lives; the future is open to changes of the
 * rate, so that steady units are held by nearly all intervals. */
static void test_coverage(void)
{
	static const char *const names[] = { "linear leakage", "linear gap",
		"gamma process of the gap" };

	for (enum truth truth = LINEAR_LEAKAGE; truth <= GAMMA_GAP; truth++)
		for (int by_gap = 0; by_gap < 2; by_gap++) {
			double error = 0, one;
			int held = 0;

			for (uint32_t i = 0; i < 100; i++) {
				held += follow_unit(truth, by_gap, i, &one);
				error += one / 100;
			}
			ok(held >= 85,
				"%s, observed as %s: 90 %% intervals contain %d of 100 ends of life",
				names[truth], by_gap ? "gap" : "leakage", held);
			ok(error < (truth == GAMMA_GAP ? 0.13 : 0.08),
				"the mean error of the median is %.1f %% of the life",
				100 * error);
		}
}

int main(void)
{
	test_pair();
	test_slope();
	test_forecast();
	test_coverage();
	return tap_done();
}
