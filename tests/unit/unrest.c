/* unrest - what the means of rows tell of rates that change and of noise that lasts */
#include "life/trend/unrest.h"
#include "num/draw.h"
#include "tap.h"
#include <math.h>

enum { ROWS = 400, SERIES = 40 };

static const double NOISE = 0.01;

/* The damage of row k of ROWS; *common is kept from row to row. */
typedef double course(struct draw *dice, int k, double *common);

static double straight(struct draw *dice, int k, double *common)
{
	(void)common;
	return (double)k / ROWS + NOISE * draw_normal(dice);
}

static double turning(struct draw *dice, int k, double *common)
{
	return straight(dice, k, common) + fmax(0, 4. * k / ROWS - 2.4);
}

static double jumping(struct draw *dice, int k, double *common)
{
	return straight(dice, k, common) + (k > ROWS / 3 ? 0.3 : 0);
}

/* The rate swings between 0.1 and 1.9 of its mean, so many times. */
static double swings(struct draw *dice, int k, double *common, int times)
{
	double phase = 2 * M_PI * times;

	return straight(dice, k, common) - 0.9 * cos(phase * k / ROWS) / phase;
}

static double swinging_once(struct draw *dice, int k, double *common)
{
	return swings(dice, k, common, 1);
}

static double swinging(struct draw *dice, int k, double *common)
{
	return swings(dice, k, common, 3);
}

static double in_bursts(struct draw *dice, int k, double *common)
{
	if (k % 20 == 0)
		*common = 0.1 * draw_normal(dice);
	return straight(dice, k, common) + *common;
}

static double wandering(struct draw *dice, int k, double *common)
{
	*common += 0.01 * draw_normal(dice);
	return straight(dice, k, common) + *common;
}

/* Means over SERIES records: of the swing at four means of eight rows and beyond the
 * longest distance, and of the variance of a common noise. */
static void learn(
	struct draw *dice, course *f, double *swing, double *beyond, double *common)
{
	*swing = *beyond = *common = 0;
	for (int i = 0; i < SERIES; i++) {
		struct plateau p = { 0 };
		double kept = 0;
		struct unrest u;

		for (int k = 0; k < ROWS; k++)
			plateau_add(&p, 3 * k, 5 - 2 * f(dice, k, &kept));
		u = unrest_of(&p, -2);
		*swing += unrest_swing(&u, 3 * 64, NOISE * NOISE) / SERIES;
		*beyond += unrest_swing(&u, 3 * 1000, NOISE * NOISE) / SERIES;
		*common += unrest_common(&u, NOISE * NOISE) / SERIES;
	}
}

int main(void)
{
	static const struct {
		const char *name;
		course *course;
		double least, most;      /* swing: variance of a logarithm */
		double noise, tolerance; /* common: standard deviation */
	} of[] = {
		{ "straight wear", straight, 0, 0.005, 0, 0.002 },
		{ "a rate that turns once", turning, 0, 0.05, 0, 0.004 },
		{ "a jump", jumping, 0, 0.1, 0, 0.002 },
		{ "a rate that swings once", swinging_once, 0.2, 0.3, 0, 0.006 },
		{ "a rate that swings, and is back within the longest distance", swinging,
			0, 0.005, 0.1, 0.03 },
		{ "noise common to 20 rows", in_bursts, 0, INFINITY, 0.1, 0.04 },
		{ "a random walk", wandering, 0, INFINITY, 0, 0.05 },
	};
	struct draw *dice = draw_new(7, 0, 0);
	struct plateau few = { 0 };
	double swing, beyond, common;
	struct unrest u;

	for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
		learn(dice, of[i].course, &swing, &beyond, &common);
		ok(swing >= of[i].least && swing <= of[i].most,
			"%s: the rate changes by a factor of e^%.3f", of[i].name,
			sqrt(swing));
		ok(beyond == 0, "%s: nothing is known of longer times", of[i].name);
		near(sqrt(common), of[i].noise, of[i].tolerance, of[i].name);
	}
	for (int k = 0; k < 10; k++)
		plateau_add(&few, k, k % 3);
	u = unrest_of(&few, 10);
	ok(unrest_swing(&u, 5, 0) == 0 && unrest_common(&u, 0) == 0,
		"ten rows tell nothing");
	for (int k = 10; k < 60; k++)
		plateau_add(&few, k, k / 2 % 2 ? 1e308 : -1e308);
	u = unrest_of(&few, 1e-3);
	ok(unrest_swing(&u, 5, 0) == 0 && unrest_common(&u, 0) == 0,
		"nor do values that overflow");
	draw_free(dice);
	return tap_done();
}
