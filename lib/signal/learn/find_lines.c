/* find_lines.c - see find_lines.h */
#include "signal/learn/find_lines.h"
#include "num/robust.h"
#include "num/select.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Samples between two fits of nearly constant lines. */
enum { LONG_HOP = 4096 };

/* A record whose lines are looked for. */
struct record {
	const struct calibrate_par *par;
	double *y1, *y2;
	size_t n;
	double *work; /* the same length */
};

enum separate_status find_lines_take(
	const struct calibration *c, double *x, size_t n, struct tones_track *t)
{
	tones_track_start(t, c->tones, c->omega, 0, c->tone_hop < n ? c->tone_hop : n);
	if (tones_track_run(t, x, 0, (long long)n, 1) == NUM_MEMORY)
		return SEPARATE_MEMORY;
	return t->fits < t->knots ? SEPARATE_TONES : SEPARATE_OK;
}

/* Share of its frequency by which a line may wander: ten times what mains do. */
static const double WANDER = 0.02;

/* Takes the tones from omega, and merges those nearer to each other than gap, into which
 * a change of its frequency may have split one; returns their number, 0 if one is nearer
 * to zero. */
static int merge_tones(int tones, const double *omega, double gap, double *merged)
{
	int count = 0;

	if (tones > 0 && omega[0] < gap)
		return 0;
	for (int k = 0, next; k < tones; k = next) {
		double sum = omega[k];

		for (next = k + 1; next < tones && omega[next] - omega[next - 1] < gap;
			next++)
			sum += omega[next];
		merged[count++] = sum / (next - k);
	}
	return count;
}

/* Level of the record without these tones, which are followed from hop to hop: by the
 * median, which pulses change little, corrected for the coefficients fitted to two hops;
 * INFINITY if some hop does not resolve them. */
static enum separate_status level_without_tones(
	const struct record *rec, const struct calibration *c, double *level)
{
	double share = (2 * c->tones + 1) / (2.0 * (double)c->tone_hop), sum = 0;
	enum separate_status status = SEPARATE_OK;
	struct tones_track track;

	for (int k = 0; k < 2 && status == SEPARATE_OK; k++) {
		double scale;

		memcpy(rec->work, k ? rec->y2 : rec->y1, rec->n * sizeof *rec->work);
		status = find_lines_take(c, rec->work, rec->n, &track);
		scale = robust_scale(rec->work, rec->n);
		sum += scale * scale * (1 + share) / (1 - share);
	}
	*level = status == SEPARATE_OK ? sum : INFINITY;
	return status == SEPARATE_TONES ? SEPARATE_OK : status;
}

/* Share of the noise that lines may add: of the hops that add no more, the longest is
 * used, which pulses disturb least.  With shares of 0.002, 0.005, 0.01 and 0.02 the error
 * of the delays is 1.050, 1.052, 1.070 and 1.091 of its bound (geometric mean of 56
 * records with lines of tests/matrix/scenes.tsv, seeds 1, 2, 31 and 32), and all find the
 * same particles; with 0.005 and less a record of few pulses as long as two periods of
 * the line is doubted. */
static const double LINES = 0.01;

/* Periods of the slowest tone in the longest hop, if LONG_HOP contains fewer: at 10 kHz
 * it contains twenty of 50 Hz. */
static const double PERIODS = 16;

/* Chooses the hop by how fast the lines change.  Their frequencies wander, mains by 0.1
 * Hz and more, and a coefficient is that of two hops.  Short hops do not resolve close
 * lines, such as the parts into which a long record splits a wandering one.  *chosen: the
 * level then. */
static enum separate_status choose_hop(
	const struct record *rec, struct calibration *c, double *chosen)
{
	enum { SHORTEST = 256, HOPS = 16 };
	struct calibration trial = *c, *t = &trial;
	double least = INFINITY, level[HOPS];
	double longest = fmin(
		fmax(LONG_HOP, PERIODS * 2 * M_PI / c->omega[0]), (double)rec->n / 2);

	for (int k = 0; k < HOPS; k++) {
		double gap = 2 * M_PI / (double)(SHORTEST << k);

		level[k] = INFINITY;
		t->tone_hop = (size_t)SHORTEST << k;
		t->tones = merge_tones(c->tones, c->omega, gap, t->omega);
		if ((double)t->tone_hop > longest || t->tones == 0 ||
			rec->par->tones > t->tones)
			continue;
		if (level_without_tones(rec, t, &level[k]) == SEPARATE_MEMORY)
			return SEPARATE_MEMORY;
		least = fmin(least, level[k]);
	}
	*chosen = INFINITY;
	for (int k = HOPS - 1; k >= 0 && isfinite(least); k--) {
		if (level[k] > (1 + LINES) * least)
			continue;
		c->tone_hop = (size_t)SHORTEST << k;
		c->tones = merge_tones(
			c->tones, c->omega, 2 * M_PI / (double)c->tone_hop, c->omega);
		*chosen = level[k];
		break;
	}
	return SEPARATE_OK;
}

/* Bins on either side that a line has to exceed which shows only without others: what a
 * drifting baseline leaves falls steeply from bin to bin. */
enum { NEAR_SIDE = 12 };

/* Times the usual sample to which pulses are clipped; less where lines were found, which
 * leave none to which clipping would give harmonics.  With 1 and 1.5 regular pulses
 * behind a filter that is not known have lines (tests/long/duet.t), with 3 pulses hide
 * the fifth harmonic of hum (hum-hides-fifth of tests/matrix/scenes.tsv). */
static const double CLIP = 3, CLIP_AGAIN = 2;

/* Finds lines of y1, y2[0 .. n), at most TONES_MAX with those of c, that are none of
 * these.  again: 1 where lines were found before. */
static enum num_status add_tones(const double *y1, const double *y2, size_t n, int again,
	struct calibration *c, int *added)
{
	enum { ENOUGH = 16384 };
	size_t some = n < ENOUGH ? n : ENOUGH, from = (n - some) / 2;
	double omega[TONES_MAX];
	int found, count = 0;
	enum num_status status = tones_find(y1, y2, n, again ? NEAR_SIDE : TONES_SIDE,
		again ? CLIP_AGAIN : CLIP, TONES_MAX - c->tones, omega, &found);

	for (int k = 0; k < found; k++) {
		int known = 0;

		for (int i = 0; i < c->tones; i++)
			known |= fabs(omega[k] - c->omega[i]) < WANDER * c->omega[i];
		if (!known)
			omega[count++] = omega[k];
	}
	if (status == NUM_OK)
		status = tones_confirm(y1 + from, y2 + from, some,
			1 - calibration_lost(c), &count, omega);
	memcpy(c->omega + c->tones, omega, (size_t)count * sizeof *omega);
	c->tones += count;
	*added = count;
	sort_numbers(c->omega, (size_t)c->tones);
	return status;
}

/* Frequencies at the beginning of y[0 .. n) of tones that have frequencies omega at its
 * end. */
static enum num_status track_back(
	const double *y, size_t n, size_t hop, int tones, double *omega)
{
	double *reversed = malloc(n * sizeof *reversed);
	struct tones_track track;
	enum num_status status = reversed ? NUM_OK : NUM_MEMORY;

	for (size_t i = 0; reversed && i < n; i++)
		reversed[i] = y[n - 1 - i];
	tones_track_start(&track, tones, omega, 0, hop);
	if (reversed &&
		tones_track_run(&track, reversed, 0, (long long)n, 1) == NUM_MEMORY)
		status = NUM_MEMORY;
	memcpy(omega, track.omega, (size_t)tones * sizeof *omega);
	free(reversed);
	return status;
}

/* Finds a tone of y1, y2[0 .. n) whose frequency changes so fast that it is no line of
 * the whole: it is the strongest line of most pieces. */
static enum num_status add_sweep(
	const double *y1, const double *y2, size_t n, struct calibration *c, int *added)
{
	enum { SHORTEST = 1024 };
	enum num_status status = NUM_OK;

	*added = 0;
	for (size_t m = n / 4; m >= SHORTEST && !*added && c->tones < TONES_MAX; m /= 2) {
		double omega = 0;
		size_t with = 0, pieces = n / m, first = 0;

		for (size_t k = 0; k < pieces && status == NUM_OK; k++) {
			double line;
			int found;

			status = tones_find(y1 + k * m, y2 + k * m, m, NEAR_SIDE, CLIP, 1,
				&line, &found);
			if (status == NUM_OK)
				status = tones_confirm(y1 + k * m, y2 + k * m, m,
					1 - calibration_lost(c), &found, &line);
			if (status == NUM_OK && found && with++ == 0) {
				omega = line;
				first = k;
			}
		}
		if (status != NUM_OK)
			return status;
		if (2 * with <= pieces)
			continue;
		status = track_back(y1, first * m + m / 2, m / 4, 1, &omega);
		c->omega[c->tones++] = omega;
		sort_numbers(c->omega, (size_t)c->tones);
		*added = 1;
	}
	return status;
}

/* The line of a sweep has its mean frequency, not that at the beginning of the record:
 * follows the tones to the end and back, and keeps these frequencies if the level is
 * lower. */
static enum separate_status settle_tones(
	const struct record *rec, struct calibration *c, double *level)
{
	struct calibration settled = *c;
	struct tones_track track;
	enum separate_status status;
	double lower;

	memcpy(rec->work, rec->y1, rec->n * sizeof *rec->work);
	status = find_lines_take(c, rec->work, rec->n, &track);
	if (status != SEPARATE_OK)
		return status;
	memcpy(settled.omega, track.omega, sizeof settled.omega);
	if (track_back(rec->y1, rec->n, c->tone_hop, c->tones, settled.omega) != NUM_OK)
		return SEPARATE_MEMORY;
	status = level_without_tones(rec, &settled, &lower);
	if (status == SEPARATE_OK && lower < *level) {
		*c = settled;
		*level = lower;
	}
	return status;
}

/* Finds lines in rest, 2 n samples, of the record without the tones of c.  Lines that
 * merge with those known are none, unless the level falls: they would be found again. */
static enum separate_status search_lines(const struct record *rec, const double *rest,
	int again, struct calibration *c, double *level, int *added)
{
	const struct calibration before = *c;
	double lower;
	enum separate_status status = SEPARATE_MEMORY;

	if (add_tones(rest, rest + rec->n, rec->n, again, c, added) == NUM_OK)
		status = *added ? choose_hop(rec, c, &lower) : SEPARATE_OK;
	if (status == SEPARATE_OK && *added)
		status = settle_tones(rec, c, &lower);
	if (status != SEPARATE_OK || !*added)
		return status;
	*added = c->tones > before.tones || (1 + LINES) * lower < *level;
	*level = *added ? lower : *level;
	*c = *added ? *c : before;
	return status;
}

/* The same of a sweep, which is kept if the level is lower than that at the same hop
 * without it. */
static enum separate_status search_sweep(const struct record *rec, const double *rest,
	struct calibration *c, double *level, int *added)
{
	const struct calibration before = *c;
	struct calibration without = *c;
	double lower, other;
	enum separate_status status = SEPARATE_MEMORY;

	if (add_sweep(rest, rest + rec->n, rec->n, c, added) == NUM_OK)
		status = *added ? choose_hop(rec, c, &lower) : SEPARATE_OK;
	if (status != SEPARATE_OK || !*added)
		return status;
	without.tone_hop = c->tone_hop;
	status = level_without_tones(rec, &without, &other);
	*added = (1 + LINES) * lower < other;
	*c = *added ? *c : before;
	if (status == SEPARATE_OK && *added) {
		*level = lower;
		status = settle_tones(rec, c, level);
	}
	return status;
}

/* Finds lines, and again in what they leave, then sweeps. */
static enum separate_status search_tones(const struct record *rec, struct calibration *c)
{
	size_t n = rec->n;
	double *rest = malloc(2 * n * sizeof *rest), level = INFINITY;
	int added = 1, again = 0;
	enum separate_status status = rest ? SEPARATE_OK : SEPARATE_MEMORY;

	while (status == SEPARATE_OK && added > 0) {
		struct tones_track track;

		for (int k = 0; k < 2 && status == SEPARATE_OK; k++) {
			memcpy(rest + (size_t)k * n, k ? rec->y2 : rec->y1,
				n * sizeof *rest);
			if (c->tones > 0)
				status = find_lines_take(
					c, rest + (size_t)k * n, n, &track);
		}
		if (status == SEPARATE_OK)
			status = search_lines(rec, rest, again, c, &level, &added);
		if (status == SEPARATE_OK && !added)
			status = search_sweep(rec, rest, c, &level, &added);
		again = 1;
	}
	free(rest);
	return status;
}

enum separate_status find_lines(const struct calibrate_par *par, double *y1, double *y2,
	size_t n, double *work, struct calibration *c, struct lines *out)
{
	const struct record rec = {
		.par = par, .y1 = y1, .y2 = y2, .n = n, .work = work
	};
	size_t hop = n < 2 * LONG_HOP ? n : LONG_HOP;
	struct tones_track track;
	struct calibration t;
	double level;
	enum separate_status status = SEPARATE_OK;

	c->tone_hop = hop;
	if (par->tones != CALIBRATE_FIND_TONES) {
		c->tones = par->tones;
		memcpy(c->omega, par->omega, sizeof c->omega);
		sort_numbers(c->omega, (size_t)c->tones);
		if (c->tones > 0)
			status = choose_hop(&rec, c, &level);
	} else {
		status = search_tones(&rec, c);
	}
	if (status != SEPARATE_OK)
		return status;
	out->drift = 0;
	if (c->tones > 0) {
		memcpy(work, y1, n * sizeof *work);
		t = *c;
		t.tone_hop = hop;
		status = find_lines_take(&t, work, n, &track);
		out->drift = tones_track_change(&track);
		for (int k = 0; k < c->tones; k++)
			c->tone_power[k] = track.power[k] / track.knots;
	}
	for (int k = 0; k < 2 && status == SEPARATE_OK; k++) {
		status = find_lines_take(c, k ? y2 : y1, n, &track);
		out->left[k] = tones_track_left(&track);
	}
	return status;
}
