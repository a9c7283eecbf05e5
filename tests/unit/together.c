/* Rows that may be two particles, or none: by how often pulses follow closely, by their
 * sizes, and no more of them than have to be */
#include "signal/separate/together.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>
#include <stdlib.h>

enum { ROWS = 256 };

static struct evidence row[ROWS];

/* Groups of two rows, apart durations from one another; amplitudes spread by a factor of
 * exp(spread), and odds. */
static void make_rows(double apart, double spread, double odds)
{
	for (int i = 0; i < ROWS; i++) {
		double z[2];

		philox_normal2(1, 0, RNG_PARTICLE, (uint64_t)i, z);
		row[i] = (struct evidence){ .group = 1 + i / 2,
			.time = 10 * (i / 2) + apart * (i % 2),
			.amplitude = 20 * exp(spread * z[0]) };
		for (int k = 0; k < JOINT_SHARES; k++)
			row[i].odds[k] = odds;
	}
}

static int tested(void)
{
	struct together *t = together_new();
	int count = 0;

	if (!t)
		return -1;
	together_test(t, 2, row, ROWS);
	for (int i = 0; i < ROWS; i++)
		count += row[i].doubted;
	together_free(t);
	return count;
}

/* Of one half of the rows followed by one pulse within half a duration: one per duration.
 * Odds of 0.01 for that, times the density of sizes, are below one in a hundred. */
static void test_how_often(void)
{
	make_rows(2, 0.5, 1e6);
	near(tested(), 0, 0, "where no pulse follows another closely none is doubted");
	make_rows(0.3, 0.5, 1e6);
	/* But perhaps the smallest ones, which are no sums of others. */
	near(tested(), 0.98 * ROWS, 0.021 * ROWS,
		"where pulses do and all are like pairs, nearly all are doubted");
	make_rows(0.3, 0.5, 1e-4);
	near(tested(), 0, 0, "where none is like a pair none is doubted");
}

/* Single pulses, every fourth of which was fitted by two at one gap. */
static void make_halves(double sign)
{
	make_rows(5, 0.3, 0);
	for (int i = 0; i < ROWS; i += 8) {
		row[i + 1].time = row[i].time + 0.02;
		row[i + 1].amplitude = sign * row[i].amplitude;
	}
}

/* Groups of two rows, which follow each other after any gap up to 0.6; one in eight does
 * after another one if there are halves. */
static void make_followers(int halves)
{
	make_rows(0, 0.3, 0);
	for (int i = 0; i < ROWS; i += 2)
		row[i + 1].time += halves && i % 16 == 0 ? 0.003 : 0.6 * (i + 1) / ROWS;
}

static void test_halves(void)
{
	int halves = 0, count;

	make_halves(1);
	near(tested(), ROWS / 4, 0, "pulses that two at one gap were fitted to");
	for (int i = 0; i < ROWS; i++)
		halves += row[i].doubted && i % 8 < 2;
	near(halves, ROWS / 4, 0, "are doubted, and no others");
	make_halves(-1);
	near(tested(), 0, 0, "none is if the two differ in sign");
	make_followers(0);
	near(tested(), 0, 0, "or if all gaps are equally frequent");
	make_followers(1);
	count = tested();
	halves = 0;
	for (int i = 0; i < ROWS; i++)
		halves += row[i].doubted && i % 16 < 2;
	near(halves, ROWS / 8, 0, "halves are doubted among pulses that follow others");
	near(count - halves, 0, 4, "and few others");
}

/* One in eight looks like a pair, with odds from 1 to 1000: these are doubted, from the
 * most likely on, until hardly any is left. */
static void test_fewest(void)
{
	double least = INFINITY, most = 0;
	int doubted;

	make_rows(0.3, 0.01, 1e-3);
	for (int i = 0; i < ROWS; i += 8)
		for (int k = 0; k < JOINT_SHARES; k++)
			row[i].odds[k] = pow(10, 3.0 * i / ROWS);
	/* All sizes are the same, and a half of one does not occur. */
	near(tested(), 0, 0, "pulses of one size are no sums of two");
	make_rows(0.3, 1.5, 1e-3);
	for (int i = 0; i < ROWS; i++) {
		row[i].amplitude = i % 2 ? 20 : i % 4 ? 12.5 : 7.5;
		for (int k = 0; k < JOINT_SHARES && i % 8 == 1; k++)
			row[i].odds[k] = pow(10, 6.0 * i / ROWS - 3);
	}
	doubted = tested();
	for (int i = 0; i < ROWS; i++) {
		if (row[i].doubted)
			least = fmin(least, row[i].odds[0]);
		else
			most = fmax(most, row[i].odds[0]);
	}
	ok(doubted > 8 && doubted < ROWS / 8, "some of those like pairs are doubted: %d",
		doubted);
	ok(least > most, "they are the most likely ones");
}

/* Half of the rare size is the usual one, but half of the usual one does not occur. */
static void test_sizes(void)
{
	int rare = 0, usual = 0;

	make_rows(0.3, 0.1, 0);
	for (int i = 0; i < ROWS; i++) {
		row[i].amplitude *= i % 16 ? 1 : 2;
		for (int k = 0; k < JOINT_SHARES; k++)
			row[i].odds[k] = 0.5 + 0.001 * i;
	}
	tested();
	for (int i = 0; i < ROWS; i++) {
		rare += i % 16 == 0 && row[i].doubted;
		usual += i % 16 && row[i].doubted;
	}
	ok(rare > 10, "pulses of twice the usual size may be pairs: %d of 16", rare);
	near(usual, 0, 0, "pulses of the usual size are not");
}

/* Sizes have an edge.  What lies beyond is more likely two usual particles than one
 * unlike all others. */
static void test_edge(void)
{
	int beyond = 0;

	make_rows(0.3, 0, 0.03);
	for (int i = 0; i < ROWS; i++)
		row[i].amplitude = i % 64 ? 10 + 7 * fmod(0.618 * i, 1) : 21 + i / 32.0;
	near(tested(), 4, 0, "pulses larger than all others are doubted");
	for (int i = 0; i < ROWS; i += 64)
		beyond += row[i].doubted;
	near(beyond, 4, 0, "and no others");
}

static void test_weak(void)
{
	double time = 0;
	int weak = 0;

	/* One row in eight has a fiftieth of the size, and follows another. */
	make_rows(0.3, 0.2, 0);
	for (int i = 0; i < ROWS; i++) {
		int beside = i % 8 == 7;

		row[i].group = beside ? row[i - 1].group : 1 + i;
		row[i].time = beside ? row[i - 1].time + 1.2 : 10 * i;
		row[i].amplitude *= beside ? 0.02 : 1;
	}
	near(tested(), ROWS / 8, 0, "weak rows that only occur beside larger ones are");
	for (int i = 7; i < ROWS; i += 8)
		weak += row[i].doubted && row[i].shape > 0.9;
	near(weak, ROWS / 8, 0, "doubted as errors of the shape of these");

	/* The same in groups, each of five large rows and a small one, where of 64 rows
	 * that stand alone one is smaller. */
	make_rows(0.3, 0.2, 0);
	for (int i = 0; i < ROWS; i++) {
		row[i].group = i % 8 < 6 ? 1 + i / 8 : 100 + i;
		row[i].time = i % 8 % 6 ? row[i - 1].time + 0.15 : 10 * i;
		row[i].amplitude *= i % 8 == 5 ? 0.02 : i == 7 ? 0.01 : 1;
	}
	tested();
	weak = 0;
	for (int i = 5; i < ROWS; i += 8)
		weak += row[i].doubted && row[i].shape > 0.5;
	/* But those of nearly its size, which may be particles as well. */
	near(weak, ROWS / 8, 3,
		"in groups, too, if only one of those that stand alone is small");

	/* Arrivals at random, one per two durations, one in four as small; of two within
	 * a hundredth of a duration only one pulse is found. */
	make_rows(0.3, 0.2, 0);
	for (int i = 0; i < ROWS; i++) {
		time += 0.01 - 2 * log(philox_uniform(2, 0, RNG_PARTICLE, (uint64_t)i));
		row[i].group = 1;
		row[i].time = time;
		if (philox_uniform(3, 0, RNG_PARTICLE, (uint64_t)i) < 0.25)
			row[i].amplitude *= 0.02;
	}
	near(tested(), 0, 0.01 * ROWS,
		"where small ones arrive at random none is doubted");
}

/* Odds of having the arrival of another pulse. */
static void test_exchange(void)
{
	make_rows(2, 0.5, 0);
	for (int i = 0; i < ROWS; i++)
		row[i].exchange = i % 16 ? 1e-4 : 10;
	near(tested(), ROWS / 16, 0,
		"pulses that may have exchanged arrivals are doubted");
}

int main(void)
{
	test_how_often();
	test_halves();
	test_fewest();
	test_sizes();
	test_edge();
	test_weak();
	test_exchange();
	return tap_done();
}
