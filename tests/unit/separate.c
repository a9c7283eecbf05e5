/* The separation as a whole, on scenes that sensorsim does not make: a pulse of its own
 * form, pairs at given distances, a record too full at one place */
#include "num/philox.h"
#include "signal/pulse/sensor.h"
#include "signal/separate/early.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

enum { MOST = 400 };

static const double T = 100, TRANSIT = 196, GAIN = 0.909;

struct pulse {
	double t, delay, a;
	double stretch; /* of its duration, less 1 */
};

static struct transit found[2 * MOST];

static double uniform(uint64_t i, double lo, double hi)
{
	return lo + (hi - lo) * philox_uniform(5, 0, RNG_PARTICLE, i);
}

/* Adds a sine pulse and its echo of a share, later by a third of T. */
static void add(double *x, size_t n, double t, double duration, double a, double echo)
{
	for (int k = 0; k < 2; k++) {
		double at = t + k * duration / 3, peak = k ? a * echo : a;

		for (long i = (long)(at - duration); i < (long)(at + duration); i++)
			if (i >= 0 && i < (long)n)
				x[2 * i] += peak * pulse_value(PULSE_SINE,
							   ((double)i - at) / duration);
	}
}

static const struct calibrate_par unknown = { .lag = NAN,
	.duration = NAN,
	.gain = NAN,
	.pulse = CALIBRATE_ANY_PULSE,
	.spread = NAN,
	.false_alarm = 1e-9,
	.tones = CALIBRATE_FIND_TONES };

/* A record of m pulses in noise sigma; free() it. */
static double *record_of(
	const struct pulse *p, int m, size_t n, double sigma, double echo)
{
	double *x = calloc(2 * n, sizeof *x);

	for (size_t i = 0; i < n; i++) {
		double z[2];

		philox_normal2(7, 0, RNG_NOISE, i, z);
		x[2 * i] = sigma * z[0];
		x[2 * i + 1] = sigma * z[1];
	}
	for (int i = 0; i < m; i++) {
		double duration =
			T * (1 + p[i].stretch) * (TRANSIT + p[i].delay) / TRANSIT;

		add(x, n, p[i].t, duration, p[i].a, echo);
		add(x + 1, n, p[i].t + TRANSIT + p[i].delay, duration, GAIN * p[i].a,
			echo);
	}
	return x;
}

/* Separates m pulses in noise sigma; returns how many are found. */
static int separate(const struct pulse *p, int m, size_t n, double sigma, double echo)
{
	struct separate_par par = {
		.method = SEPARATE_FIT, .learn = SEPARATE_LEARN, .known = unknown
	};
	double *x = record_of(p, m, n, sigma, echo);
	struct separate *s = separate_new(&par);
	int count = 0;

	ok(separate_push(s, x, n) == SEPARATE_OK && separate_end(s) == SEPARATE_OK,
		"%d pulses in noise %g are found", m, sigma);
	while (count < 2 * MOST && separate_next(s, &found[count]))
		count++;
	separate_free(s);
	free(x);
	return count;
}

/* How many of the m pulses are found within near samples, which is less than they are
 * apart; *rms: of the errors of their delays. */
static int matched(const struct pulse *p, int m, int count, double near, double *rms)
{
	double sum = 0;
	int good = 0;

	for (int i = 0, k = 0; i < m; i++) {
		double error;

		while (k < count && found[k].t1 < p[i].t - near)
			k++;
		if (k == count || found[k].t1 > p[i].t + near)
			continue;
		error = found[k].t2 - found[k].t1 - TRANSIT - p[i].delay;
		sum += error * error;
		good++;
		k++;
	}
	*rms = good ? sqrt(sum / good) : NAN;
	return good;
}

static int by_time(const void *a, const void *b)
{
	const struct pulse *p = a, *q = b;

	return (p->t > q->t) - (p->t < q->t);
}

static struct pulse pulse_at(double t, uint64_t i)
{
	return (struct pulse){ t, uniform(2 * i, 2, 5), uniform(2 * i + 1, 0.5, 1.5), 0 };
}

/* Each echo is a pulse 33 samples later and a fifth as large: one of its own, unless the
 * shape is learned.  Errors are those of a pulse without echo, rms 3.35 sigma / a: 0.13.
 */
static void test_own_shape(void)
{
	struct pulse p[90];
	double rms;
	uint64_t trial = 0;
	int count, good, m = 0;

	while (m < 90) {
		double t = 500 + 800 * (m / 3) + uniform(1000 + trial++, 0, 150);
		int free = 1;

		for (int k = m / 3 * 3; k < m; k++)
			free &= fabs(t - p[k].t) > 10;
		if (free) {
			p[m] = pulse_at(t, (uint64_t)m);
			m++;
		}
	}
	qsort(p, 90, sizeof *p, by_time);
	count = separate(p, m, 25000, 0.0316, 0.2);
	ok(count == m, "pulses with an echo: %d found of %d", count, m);
	good = matched(p, m, count, 5, &rms);
	ok(good == m && rms < 0.18,
		"each pulse is found once, with delays right to %.3f samples", rms);
}

/* Pairs 5 samples apart, a twentieth of T, at 40 dB: the bound is 0.06 samples at a = 1
 * (mean over a from 0.5 to 1.5: 0.08). */
static void test_pairs(void)
{
	struct pulse p[80];
	double rms;
	int count, good;

	for (int i = 0; i < 80; i++)
		p[i] = pulse_at(500 + 400 * (i / 2) + 5 * (i % 2), (uint64_t)i);
	count = separate(p, 80, 17000, 0.01, 0);
	ok(count == 80, "%d of 80 pairs 5 samples apart are found", count);
	good = matched(p, 80, count, 2, &rms);
	ok(good == 80 && rms < 0.12,
		"both pulses of each pair are found, with delays right to %.3f samples",
		rms);
}

/* One long section of pulses some 90 samples apart; one of them lasts half as long again.
 * No pulse two durations away is doubted for that, and none is lost. */
static void test_local_doubt(void)
{
	struct pulse p[120];
	int count, good, doubted = 0, elsewhere = 0, clear = 0;
	double rms;

	for (int i = 0; i < 120; i++)
		p[i] = i < 100 ? pulse_at(500 + 90 * i +
						  uniform(2000 + (uint64_t)i, 0, 20),
					 (uint64_t)i)
			       : pulse_at(9900 + 400 * (i - 100), (uint64_t)i);
	p[49].stretch = 0.5;
	p[49].a = 1.5;
	count = separate(p, 120, 18200, 0.01, 0);
	for (int k = 0; k < count; k++) {
		int far = fabs(found[k].t1 - p[49].t) > 2 * T;

		doubted += !far && found[k].verdict == SEPARATE_MISFIT;
	}
	for (int i = 0, k = 0; i < 120; i++) {
		int far = fabs(p[i].t - p[49].t) > 2 * T;

		while (k + 1 < count && found[k].t1 < p[i].t - 2)
			k++;
		clear += far;
		elsewhere += far && found[k].verdict <= SEPARATE_OVERLAP;
	}
	good = matched(p, 120, count, 2, &rms);
	ok(good >= 117 && doubted > 0 && elsewhere == clear,
		"beside one odd pulse %d of 120 are found, %d near it are doubted, and %d of %d "
		"elsewhere are not",
		good, doubted, elsewhere, clear);
}

/* A filter that lets nothing through has no inverse; that is no lack of memory. */
static void test_dead_filter(void)
{
	enum { FRAMES = 4096, TAPS = 5 };
	double filter[TAPS] = { 0 }, *x = malloc(2 * FRAMES * sizeof *x);
	struct separate_par par = { .method = SEPARATE_FIT, .learn = FRAMES };
	struct separate *s;

	par.known = (struct calibrate_par){ .lag = TRANSIT,
		.duration = T,
		.gain = GAIN,
		.pulse = PULSE_SINE,
		.spread = 0.1,
		.false_alarm = 1e-9,
		.tones = 0,
		.filter = filter,
		.filter_taps = TAPS };
	s = separate_new(&par);
	for (size_t i = 0; i < FRAMES; i++)
		philox_normal2(7, 0, RNG_NOISE, i, x + 2 * i);
	ok(separate_push(s, x, FRAMES) == SEPARATE_NARROW,
		"a filter that lets nothing through is said to leave too narrow a band");
	separate_free(s);
	free(x);
}

/* Separates n samples of x in pieces, as a live record; returns the number of rows.
 * early[k]: rows so far after 10 000 (k + 1) samples. */
static int separate_live(const double *x, size_t n, size_t piece, int early[6])
{
	struct separate_par par = { .method = SEPARATE_FIT, .known = unknown };
	struct early *e = early_new(&par);
	int count = 0;

	for (size_t at = 0, some; at < n; at += some) {
		some = piece < n - at ? piece : n - at;
		if (early_push(e, x + 2 * at, some) != SEPARATE_OK)
			break;
		while (count < 2 * MOST && early_next(e, &found[count]))
			count++;
		for (size_t k = 0; k < 6; k++)
			if (at + some <= 10000 * (k + 1))
				early[k] = count;
	}
	early_end(e);
	while (count < 2 * MOST && early_next(e, &found[count]))
		count++;
	early_free(e);
	return count;
}

/* Pulses that stand alone, but for two at 30 000.  From 66 000 on they are twice as large
 * as the converter measures, so that samples learned from are at its limit, too. */
static void test_early(void)
{
	enum { PULSES = 200, PAIR = 75, LENGTH = 90000 };
	static const size_t pieces[] = { 100, 777, LENGTH };
	static struct transit first[2 * MOST];
	struct pulse p[PULSES];
	double *x, rms, limit = 1.2;
	int early[6] = { 0 }, count, good;

	for (int i = 0; i < PULSES; i++)
		p[i] = pulse_at(500 + 400 * i + (i == PAIR + 1 ? -330 : 0), (uint64_t)i);
	for (int i = 0; i < PULSES; i++)
		p[i].a = p[i].t < 66000 ? fmin(p[i].a, 1.25) : 2.4;
	x = record_of(p, PULSES, LENGTH, 0.03, 0);
	for (size_t i = 0; i < 2 * LENGTH; i++)
		x[i] = fmin(x[i], limit);
	for (int k = 0; k < 3; k++) {
		count = separate_live(x, LENGTH, pieces[k], early);
		if (k == 0) {
			memcpy(first, found, sizeof first);
			good = matched(p, PULSES, count, 20, &rms);
			ok(good == PULSES && count == PULSES,
				"live: %d of %d pulses are found in %d rows", good,
				PULSES, count);
			ok(early[0] > 20, "rows come after 10 000 samples (%d)",
				early[0]);
			ok(early[1] > 45, "and as the samples do (%d)", early[1]);
			ok(early[5] == PAIR, "up to the first two that overlap (%d)",
				early[5]);
		}
		ok(memcmp(first, found, (size_t)count * sizeof *found) == 0,
			"pieces of %zu samples give the same rows", pieces[k]);
	}
	free(x);
}

/* The flow becomes slower by 43 % at pulse slower of PULSES; *changes: how often the
 * instrument was learned again. */
static int separate_slower(int slower, size_t piece, struct pulse *p, int m, size_t n,
	long long change[2], size_t *changes)
{
	struct separate_par par = { .method = SEPARATE_FIT, .known = unknown };
	struct renewal *r = renewal_new(&par);
	double *x;
	int count = 0;

	for (int i = 0; i < m; i++) {
		p[i] = pulse_at(500 + 700 * i, (uint64_t)i);
		p[i].delay += i < slower ? 0 : 150;
	}
	x = record_of(p, m, n, 0.02, 0);
	for (size_t at = 0; at < n; at += piece)
		if (renewal_push(r, x + 2 * at, piece < n - at ? piece : n - at) !=
			SEPARATE_OK)
			break;
	ok(renewal_end(r) == SEPARATE_OK, "a flow that changes at pulse %d is learned",
		slower);
	while (count < 2 * MOST && renewal_next(r, &found[count]))
		count++;
	renewal_changes(r, changes);
	for (size_t i = 0; i < *changes && i < 2; i++)
		change[i] = renewal_changes(r, changes)[i];
	ok(separate_counters(renewal_now(r))->rows == count &&
			separate_doubtful(renewal_now(r)) == SEPARATE_BELIEVED,
		"its %d rows are counted once, and believed", count);
	renewal_free(r);
	free(x);
	return count;
}

/* Within what is learned from, where one range of velocities describes both flows, behind
 * it, and never. */
static void test_changes(void)
{
	enum { PULSES = 150, LENGTH = 106000 };
	static const int slower[] = { 45, 125, PULSES };
	static struct transit first[2 * MOST];
	static struct pulse p[PULSES];

	for (int k = 0; k < 3; k++) {
		long long change[2] = { 0 };
		size_t changes = 0, again = 0;
		double rms, at = 500 + 700 * slower[k];
		int count = separate_slower(
			    slower[k], LENGTH, p, PULSES, LENGTH, change, &changes),
		    good = matched(p, PULSES, count, 20, &rms);

		memcpy(first, found, sizeof first);
		/* Amplitudes of 30 standard deviations and more: 1 is five errors. */
		ok(good == PULSES && count == PULSES && rms < 1,
			"%d of %d pulses in %d rows, rms error of delay %.2f", good,
			PULSES, count, rms);
		ok(k == 1 ? changes == 1 && fabs((double)change[0] - at) < 700
			  : changes == 0,
			"%zu changes, at %lld", changes, change[0]);
		if (slower[k] == PULSES)
			continue;
		separate_slower(slower[k], 777, p, PULSES, LENGTH, change, &again);
		ok(again == changes &&
				memcmp(first, found, (size_t)count * sizeof *found) == 0,
			"pieces of 777 samples give the same rows");
	}
}

int main(void)
{
	test_changes();
	test_dead_filter();
	test_own_shape();
	test_pairs();
	test_local_doubt();
	test_early();
	return tap_done();
}
