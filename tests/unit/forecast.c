/* A unit whose gap opens evenly: lives in closed form; the pair and the slope it rests
 * on. */
#include "life/forecast.h"
#include "life/slope.h"
#include "tap.h"

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

	ok(isinf(pair_limit(&p)), "no threshold, no limit");
	p.threshold_gap = 15e-6;
	p.threshold_volume = 8e-9;
	near(pair_limit(&p), 14e-6, 1e-18, "the first threshold reached counts");
	near(pair_gap(&p, PAIR_VOLUME, 4e-9), 12e-6, 1e-18, "gap from the volume worn");
	for (int q = PAIR_LEAKAGE; q <= PAIR_DEBRIS; q++)
		near(pair_gap(&p, q, pair_value(&p, q, 13e-6)), 13e-6, 1e-17,
			"there and back");
}

static void test_slope(void)
{
	struct slope s = { 0 };

	slope_add(&s, 1, 2);
	ok(!isfinite(slope_get(&s)), "one point has no slope");
	slope_add(&s, 2, 5);
	slope_add(&s, 4, 11);
	near(slope_get(&s), 3, 1e-14, "points on a line");
	slope_add(&s, 5, 10);
	/* sum (t - 3) (y - 7) / sum (t - 3)^2 = (10 + 2 + 4 + 6) / 10 */
	near(slope_get(&s), 2.2, 1e-14, "points beside it");
}

static void test_forecast(void)
{
	struct paths_par paths = {
		.seed = 1, .count = 8, .step_time = NAN, .area = 2e-3, .critical = NAN
	};
	struct forecast_par par = {
		.pair = make_pair(), .quantity = PAIR_GAP, .count = 8, .horizon = NAN
	};
	struct paths *e = paths_new(&paths, NULL);
	struct forecast_row row;
	struct forecast *f;

	par.pair.threshold_gap = 15e-6;
	f = forecast_new(e, &par);
	ok(f != NULL, "a forecast");
	ok(forecast_add(f, 0, 10e-6, 10e-6, 0) == 0, "one row tells no rate");
	ok(forecast_add(f, 100, 11e-6, 11e-6, 0) == 1, "two do, the same for all paths");
	row = forecast_at(f, 100);
	near(row.life[0], 400, 1e-9, "4 um left at 1 um per 100 s");
	ok(isinf(row.limit) && isnan(row.grey), "no horizon, no grey model");
	ok(forecast_add(f, 150, NAN, NAN, 0) == -1, "a missing value tells nothing");
	near(forecast_at(f, 150).life[0], 350, 1e-9, "but the time has gone");
	near(forecast_at(f, 600).life[0], 0, 0, "and never below 0");
	forecast_free(f);

	par.skip = 50;
	f = forecast_new(e, &par);
	forecast_add(f, 0, 5e-6, 5e-6, 0);
	forecast_add(f, 100, 10e-6, 10e-6, 0);
	forecast_add(f, 200, 11e-6, 11e-6, 0);
	near(forecast_at(f, 200).life[0], 400, 1e-9, "run-in left out of the rate");
	forecast_free(f);

	par.skip = 0;
	par.from_new = 1;
	f = forecast_new(e, &par);
	ok(forecast_add(f, 100, 12e-6, 12e-6, 0) == 1, "a new pair at time 0 is a row");
	near(forecast_at(f, 100).life[0], 150, 1e-9, "and gives a rate");
	forecast_free(f);
	paths_free(e);
}

int main(void)
{
	test_pair();
	test_slope();
	test_forecast();
	return tap_done();
}
