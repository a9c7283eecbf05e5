/* calibrate.c - see calibration.h */
#include "num/dot.h"
#include "signal/learn/bubbles.h"
#include "signal/learn/calibration.h"
#include "signal/learn/crosstalk.h"
#include "signal/learn/find_lines.h"
#include "signal/learn/learn.h"
#include "signal/learn/measure.h"
#include "signal/learn/velocities.h"
#include "signal/noise/colour.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int is_constant(const double *x, size_t n)
{
	for (size_t i = 1; i < n; i++)
		if (x[i] != x[0])
			return 0;
	return 1;
}

/* Another look at the same record. */
static struct look look_with(const struct look *look, const struct calibrate_par *par)
{
	return (struct look){ .par = par,
		.x = { look->x[0], look->x[1] },
		.n = look->n,
		.effort = look->effort };
}

/* 1 if the pulses describe the record one by one. */
static int describes_each(const struct calibration *c)
{
	return calibration_describes(c) && !c->dense;
}

/* Keeps other in place of c if it was learned and its pulses describe the record, and
 * better. */
static int keep_better(
	struct calibration *c, struct calibration *other, enum separate_status status)
{
	int better = status == SEPARATE_OK && other->penalised < c->penalised &&
		     describes_each(other);

	calibration_clear(better ? c : other);
	if (better)
		*c = *other;
	return better;
}

/* One attempt, on the record whitened by w if w has taps.  c takes over w. */
static enum separate_status attempt(
	struct look *look, const struct whitening *w, struct calibration *c)
{
	size_t n = look->n, edge = n > 8 * (size_t)w->edge ? (size_t)w->edge : 0;
	double *work = malloc((3 * n + 1) * sizeof *work);
	enum separate_status status = work ? SEPARATE_OK : SEPARATE_MEMORY;

	memset(c, 0, sizeof *c);
	c->whitening = *w;
	c->work = look->effort->work;
	c->estimated = look->settled;
	c->presumed_white =
		look->coloured && !look->settled && !(w->tap && look->noise.drift > 0);
	for (int k = 0; work && k < 2; k++) {
		double *y = work + (size_t)k * n;

		memcpy(y, look->x[k], n * sizeof *work);
		if (!w->tap)
			continue;
		c->mean[k] = mean_of(y, n);
		for (size_t i = 0; i < n; i++)
			y[i] -= c->mean[k];
		if (whitening_apply(w, y, n) != NUM_OK)
			status = SEPARATE_MEMORY;
	}
	if (status == SEPARATE_OK)
		status = measure(look, look->x[0] + edge, work + edge, work + n + edge,
			n - 2 * edge, work + 2 * n, c);
	free(work);
	look->effort->work = c->work;
	if (status != SEPARATE_OK)
		calibration_clear(c);
	return status;
}

/* Noise or a filter without power at any frequency leaves no band. */
static enum separate_status of_whitening(enum num_status status)
{
	return status == NUM_OK       ? SEPARATE_OK
	       : status == NUM_MEMORY ? SEPARATE_MEMORY
				      : SEPARATE_NARROW;
}

static enum separate_status attempt_kind(
	struct look *look, enum whiten_kind kind, struct calibration *c)
{
	struct whitening w;
	enum separate_status status = of_whitening(whitening_of_noise(
		&w, look->noise.power, look->noise.drift, COLOUR_BINS, kind));

	look->kind = kind;
	return status == SEPARATE_OK ? attempt(look, &w, c) : status;
}

/* Tries both explanations of noise that is not white: it was filtered with the pulses, or
 * coloured before they were added.  The better one is used once more, with its pulse
 * corrected. */
static enum separate_status look_again(struct look *look, struct calibration *c)
{
	static const enum whiten_kind kinds[] = { WHITEN_FILTERED, WHITEN_COLOURED };
	enum whiten_kind found = WHITEN_FILTERED;
	double best = c->penalised;
	int better = 0;

	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
		struct calibration other;
		enum separate_status status = attempt_kind(look, kinds[k], &other);

		if (status == SEPARATE_MEMORY)
			return status;
		if (status != SEPARATE_OK)
			continue;
		if (other.penalised < best && !other.dense) {
			best = other.penalised;
			found = kinds[k];
			better = 1;
		}
		calibration_clear(&other);
	}
	if (!better)
		return SEPARATE_OK;
	look->settled = 1;
	calibration_clear(c);
	return attempt_kind(look, found, c);
}

/* 1 if the noise is white after all.  If little of the record is quiet, the pulses make
 * it look coloured; they then fit as well as in white noise, or tolerably, and the noise
 * is white above their band. */
static int is_white(const struct calibration *c, const struct look *look)
{
	return calibration_describes(c) ||
	       (c->chi2 < CALIBRATE_TOLERABLE && measure_white_above(look, c->duration));
}

/* Power of a tone, in units of noise^2, below which it may be due to the tails of pulses;
 * and the share of its power by which a line changes from hop to hop. */
static const double TAILS = 4, STEADY = 0.3;

/* Work of learning with fewer lines, over that done before: where they are taken, 0.27 to
 * 3.4 in 9 regular trains of 50 to 300 pulses of four shapes, and where they are not, up
 * to 660 in the scenes hum of tests/matrix/scenes.tsv. */
static const double LINES_WORK = 7;

/* A regular train of pulses has lines, too, which the robust fit may find: weak ones of
 * their tails, or lines that last only as long as the train.  Uses fewer lines if with
 * them the pulses describe the record, and better; two attempts of which neither does say
 * nothing of the lines. */
static enum separate_status try_fewer_tones(struct look *look, struct calibration *c)
{
	const struct calibrate_par *par = look->par;
	struct calibrate_par fewer = *par;
	struct whitening w = { .tap = NULL };
	struct look other_look = look_with(look, &fewer);
	struct calibration other;
	enum separate_status status;

	fewer.tones = 0;
	for (int k = 0; k < c->tones; k++)
		if (c->tone_power[k] > fmax(TAILS, look->wander / STEADY))
			fewer.omega[fewer.tones++] = c->omega[k];
	if (fewer.tones == c->tones)
		return SEPARATE_OK;
	fewer.most = fmin(par->most, (1 + LINES_WORK) * look->effort->work);
	other_look.seen = 1;
	other_look.wide = look->wide;
	other_look.events = look->found.events;
	status = attempt(&other_look, &w, &other);
	other_look.par = par;
	if (keep_better(c, &other, status))
		*look = other_look;
	return status == SEPARATE_MEMORY ? status : SEPARATE_OK;
}

/* Share of its energy in which a whitened pulse may differ from a known one, beside the
 * error of its shape; half and twice of it give the same rows in the records of BAD_FIT
 * in measure.c. */
static const double KNOWN = 0.01;

/* *lacks: 1 if whitening has made the pulse a known one but a filter has taken its low
 * frequencies; a pulse taken from the record then lacks them. */
static enum separate_status lacks_low(
	const struct look *look, const struct calibration *c, int *lacks)
{
	struct template white = { .shape = c->shape, .duration = c->duration };
	struct whitening w;
	enum num_status status;
	double left = 1;

	*lacks = 0;
	/* at the lowest frequencies less than half of the largest power */
	if (!(look->noise.power[0] < 0.5 * largest_of(look->noise.power, COLOUR_BINS)))
		return SEPARATE_OK;
	status = whitening_of_noise(
		&w, look->noise.power, look->noise.drift, COLOUR_BINS, WHITEN_FILTERED);
	if (status != NUM_OK)
		return of_whitening(status);
	status = template_known(&white, w.seen, w.seen_half, &left);
	*lacks = left <= KNOWN + c->misfit;
	whitening_clear(&w);
	return status == NUM_OK ? SEPARATE_OK : SEPARATE_MEMORY;
}

/* Whitens the noise and takes the pulse from that record; COLOURED if the pulse does not
 * describe it. */
static enum separate_status attempt_white(struct look *look, struct calibration *c)
{
	struct look smooth = *look;
	enum separate_status status;

	if (colour_smooth(&smooth.noise) != NUM_OK)
		return SEPARATE_MEMORY;
	status = attempt_kind(&smooth, WHITEN_COLOURED, c);
	if (status == SEPARATE_MEMORY)
		return status;
	/* No filter makes noise that drifts. */
	if (status == SEPARATE_OK && look->noise.drift > 0 && !c->dense &&
		calibration_describes(c))
		return status;
	if (status == SEPARATE_OK && c->measured && !c->dense && calibration_stands(c)) {
		int lacks = 0;

		status = lacks_low(look, c, &lacks);
		if (status == SEPARATE_OK && !lacks)
			return status;
		if (status == SEPARATE_MEMORY) {
			calibration_clear(c);
			return status;
		}
	}
	calibration_clear(c);
	return SEPARATE_COLOURED;
}

static enum separate_status find(struct look *look, struct calibration *c)
{
	const struct calibrate_par *par = look->par;
	enum separate_status status = SEPARATE_OK;
	struct whitening w = { .tap = NULL };

	if (is_constant(look->x[0], look->n))
		return SEPARATE_SILENT_1;
	if (is_constant(look->x[1], look->n))
		return SEPARATE_SILENT_2;
	if (par->filter)
		status = of_whitening(
			whitening_of_filter(&w, par->filter, par->filter_taps));
	if (status != SEPARATE_OK)
		return status;
	look->first = !par->filter;
	status = attempt(look, &w, c);
	if (status == SEPARATE_COLOURED) {
		status = attempt_white(look, c);
		if (status != SEPARATE_COLOURED)
			return status;
		look->first = 0;
		status = attempt(look, &w, c);
	}
	look->first = 0;
	if (status == SEPARATE_OK && par->tones == CALIBRATE_FIND_TONES && !w.tap)
		status = try_fewer_tones(look, c);
	if (status == SEPARATE_OK && look->coloured && !c->dense && !is_white(c, look))
		status = look_again(look, c);
	return status;
}

/* Pulses near the limits of the range of delays from which on it is widened. */
enum { SOME = 2 };

/* Factor by which velocities may exceed those seen at either end: a row within a tenth of
 * the logarithm of the range, EDGE of validate.c, is doubted, and the widest range is
 * nine times its least.  It is the widest in which a fit that goes JOINT_BEYOND does not
 * reach pulses that last no time. */
static const double WIDER = 1.3, WIDEST = 0.8;

/* Share of the work that may be done with them; the rest is for nearly equal ones. */
static const double HALF = 0.5;

/* Work of learning with another range, over that with the first: the right range takes
 * 0.5 to 1.3 in 20 records of turbulent flow, and a range that lets pulses describe
 * bubbles 2.3 to 7 in 6 (scenes turbulent and group-turbulent of
 * tests/matrix/scenes.tsv, also with bubbles, and group-bubbles). */
static const double MORE_WORK = 2;

/* Learns the instrument with the range of velocities v, whose delays are those around the
 * middle of the range, with at most so much work.  HARD if the pulses do not describe the
 * record. */
static enum separate_status try_velocities(
	struct look *look, const struct velocities *v, double most, struct calibration *c)
{
	struct calibrate_par limited = *look->par;
	double lo = v->fastest / WIDER, hi = v->slowest * WIDER, low;
	struct look wide = look_with(look, &limited);
	enum separate_status status;

	limited.lag = v->ratio * 0.5 * (lo + hi);
	limited.spread = fmin((hi - lo) / (hi + lo), WIDEST);
	limited.most = most;
	if (known_shape_duration(PULSE_SINE, 1, &low) != NUM_OK)
		return SEPARATE_MEMORY;
	wide.seen = 1;
	wide.lowest = 0.5 * (lo + hi) / low;
	status = find(&wide, c);
	if (status == SEPARATE_OK && !describes_each(c)) {
		calibration_clear(c);
		status = SEPARATE_HARD;
	}
	return status;
}

/* Learns the instrument with the range of delays of plug (0) or of turbulent flow (1),
 * with at most so much work. */
static enum separate_status find_within(
	struct look *look, int wide, double most, struct calibration *c)
{
	struct calibrate_par limited = *look->par;
	struct look again = look_with(look, &limited);

	limited.most = fmin(limited.most, most);
	again.wide = wide;
	return find(&again, c);
}

/* Share of the work that may be done with nearly equal velocities where the pulses seem
 * to differ: with 0.02, 0.1 and 0.4, 2525, 2533 and 2503 of 2721 particles are found
 * rightly in 78 records of random instruments, where a broad range may take three times
 * the work of a narrow one. */
static const double NARROW = 0.1;

/* Work of a broad range over that with a narrow one that describes the record: laminar
 * flow of which it describes a part takes 4 (laminar-gauss of tests/matrix/scenes.tsv),
 * plug flow in coloured noise would take 20 to 170. */
static const double BROAD_WORK = 5;

/* Learns the instrument where the durations of pulses seem to differ as in laminar flow:
 * noise that is not white, filters and echoes make those of plug flow seem so, of which a
 * narrow range needs a hundredth of the work.  The broad one is kept if the pulses then
 * describe the record, and better.  If they do with neither, what work is left is for
 * nearly equal velocities. */
static enum separate_status find_broad(
	struct look *look, const struct velocities *v, struct calibration *c)
{
	const double all = look->par->most;
	enum separate_status status = find_within(look, 0, NARROW * all, c), broad;
	const int known = status == SEPARATE_OK && describes_each(c);
	struct calibration other = { 0 };

	if (status == SEPARATE_MEMORY)
		return status;
	broad = try_velocities(look, v,
		known ? fmin(all, BROAD_WORK * look->effort->work) : HALF * all, &other);
	if (known && broad != SEPARATE_MEMORY) {
		keep_better(c, &other, broad);
		return SEPARATE_OK;
	}
	calibration_clear(c);
	if (broad != SEPARATE_OK && broad != SEPARATE_MEMORY)
		return find(look, c);
	*c = other;
	return broad;
}

/* Learns the instrument again with the range of delays of turbulent flow, which is kept
 * if the pulses describe the record, and better: a pulse beyond a range that is too
 * narrow takes two within it, and in one that is too wide two particles may look like
 * one. */
static enum separate_status try_wide(struct look *look, struct calibration *c)
{
	struct calibration other = { 0 };
	enum separate_status status =
		find_within(look, 1, (1 + MORE_WORK) * look->effort->work, &other);

	keep_better(c, &other, status);
	return status == SEPARATE_MEMORY ? status : SEPARATE_OK;
}

/* Makes *clean a look at the channels without this crosstalk, whose copies are in *x, to
 * be freed. */
static enum separate_status unmix(const struct look *look, const double crosstalk[2],
	double **x, struct look *clean)
{
	const size_t n = look->n;

	*clean = look_with(look, look->par);
	if (!*x)
		*x = malloc(2 * n * sizeof **x);
	if (!*x)
		return SEPARATE_MEMORY;
	for (int k = 0; k < 2; k++) {
		memcpy(*x + (size_t)k * n, look->x[k], n * sizeof **x);
		clean->x[k] = *x + (size_t)k * n;
	}
	calibration_unmix(crosstalk, *x, *x + n, n);
	return SEPARATE_OK;
}

static int is_mixed(const double crosstalk[2])
{
	return crosstalk[0] != 0 || crosstalk[1] != 0;
}

/* Learns again without the crosstalk found beside what is removed, until there is no
 * more. */
static enum separate_status without_crosstalk(
	const struct look *look, double removed[2], double **x, struct calibration *c)
{
	enum { ROUNDS = 4 };
	enum separate_status status = SEPARATE_OK;

	for (int k = 0; k < ROUNDS && is_mixed(c->crosstalk); k++) {
		struct look clean;
		struct calibration other = { 0 };
		double more[2] = { removed[0] + c->crosstalk[0],
			removed[1] + c->crosstalk[1] };

		status = unmix(look, more, x, &clean);
		if (status == SEPARATE_OK)
			status = find(&clean, &other);
		if (status != SEPARATE_OK) {
			calibration_clear(&other);
			break;
		}
		memcpy(removed, more, 2 * sizeof *removed);
		calibration_clear(c);
		*c = other;
	}
	memcpy(c->crosstalk, removed, 2 * sizeof *removed);
	return status == SEPARATE_MEMORY ? status : SEPARATE_OK;
}

/* Standard deviation of a step of the random walk of the baselines of y and y + n; 0:
 * they do not drift. */
static enum num_status find_step(const double *y, size_t n, double *step)
{
	struct colour noise = { .drift = 0 };
	enum num_status status = colour_power(y, y + n, n, &noise);

	*step = status == NUM_OK ? sqrt(noise.drift * noise.power[0]) : 0;
	return status == NUM_MEMORY ? status : NUM_OK;
}

/* The range of velocities and the crosstalk, from the channels without their lines, which
 * look like pulses, and into seen, unless NULL, both channels without bubbles. */
static enum separate_status survey(
	const struct look *look, struct velocities *v, double crosstalk[2], double *seen)
{
	const size_t n = look->n;
	double *y = malloc((4 * n + 1) * sizeof *y);
	const double *x[2] = { NULL, NULL };
	struct marks m[2] = { { .count = 0 }, { .count = 0 } };
	struct calibration c = { .tones = 0 };
	struct lines lines;
	double step = 0;
	enum separate_status status = SEPARATE_MEMORY;

	if (y) {
		x[0] = memcpy(y, look->x[0], n * sizeof *y);
		x[1] = memcpy(y + n, look->x[1], n * sizeof *y);
		status = find_lines(look->par, y, y + n, n, y + 2 * n, &c, &lines);
	}
	if (status == SEPARATE_OK && find_step(y, n, &step) != NUM_OK)
		status = SEPARATE_MEMORY;
	if (status == SEPARATE_OK &&
		(marks_find(y, n, step, y + 2 * n, &m[0]) != NUM_OK ||
			marks_find(y + n, n, step, y + 2 * n, &m[1]) != NUM_OK ||
			velocities_find(m, n, v) != NUM_OK ||
			crosstalk_find(x, look->par->hidden, n, m, crosstalk) != NUM_OK))
		status = SEPARATE_MEMORY;
	if (seen) {
		memcpy(seen, look->x[0], n * sizeof *seen);
		memcpy(seen + n, look->x[1], n * sizeof *seen);
	}
	if (seen && status == SEPARATE_OK &&
		bubbles_remove(v, WIDER, m, y, n, y + 2 * n, seen) != NUM_OK)
		status = SEPARATE_MEMORY;
	marks_clear(&m[0]);
	marks_clear(&m[1]);
	free(y);
	return status == SEPARATE_MEMORY ? status : SEPARATE_OK;
}

/* Ratio of the durations between which four fifths of the pulses are, above which the
 * flow is laminar.  In records of random instruments it was at most 1.31 in all 130 of
 * plug flow in which it was found, at most 1.46 in 40 of 42 of turbulent flow, and at
 * least 1.54 in all 41 of laminar flow. */
static const double LAMINAR = 1.5;

/* Learns the instrument, if its pulses have velocities as those of the survey. */
static enum separate_status find_flow(
	struct look *look, const struct velocities *v, struct calibration *c)
{
	const int broad = v->slow > LAMINAR * v->fast;
	enum separate_status status = broad ? find_broad(look, v, c) : find(look, c);

	if (status == SEPARATE_NO_LAG && v->ratio > 0 && !broad)
		status = try_velocities(look, v, HALF * look->par->most, c);
	if (status == SEPARATE_OK && c->far >= SOME && isnan(look->par->spread) &&
		c->delta_max <= calibration_plug(c))
		status = try_wide(look, c);
	return status;
}

/* Learns from channels of equal polarity; OPPOSITE if they seem to differ, or, with equal
 * set, only if they have nothing in common. */
static enum separate_status calibrate_as(const struct calibrate_par *par, int equal,
	const double *x1, const double *x2, size_t n, struct calibration *c)
{
	struct effort effort = { 0 };
	struct look look = { .par = par, .x = { x1, x2 }, .n = n, .effort = &effort };
	struct look clean;
	struct velocities v = { 0 };
	double crosstalk[2] = { 0 }, *x = NULL;
	/* A filter that is to be undone has given the pulses lobes, which look like
	 * slower pulses. */
	const int known = par->filter || !isnan(par->lag) || !isnan(par->spread) ||
			  !isnan(par->duration);
	double *seen = known ? NULL : malloc((2 * n + 1) * sizeof *seen);
	enum separate_status status = SEPARATE_MEMORY;

	memset(c, 0, sizeof *c);
	if (known || seen)
		status = survey(&look, &v, crosstalk, seen);
	if (known) {
		v = (struct velocities){ 0 };
	} else {
		look.x[0] = seen;
		look.x[1] = seen + n;
	}
	clean = look;
	if (status == SEPARATE_OK && v.opposite && !equal)
		status = SEPARATE_OPPOSITE;
	if (status == SEPARATE_OK && is_mixed(crosstalk))
		status = unmix(&look, crosstalk, &x, &clean);
	if (status == SEPARATE_OK)
		status = find_flow(&clean, &v, c);
	if (status == SEPARATE_OK)
		status = without_crosstalk(&look, crosstalk, &x, c);
	free(seen);
	free(x);
	c->attempts = effort.attempts;
	c->work = effort.work;
	return status;
}

/* Noise that drifts may look as if the sensors differed in polarity: pulses have to
 * describe the record, or it is learned as if they did not. */
static enum separate_status calibrate_opposite(const struct calibrate_par *par,
	const double *x1, const double *x2, size_t n, struct calibration *c)
{
	struct calibrate_par rest = *par;
	double *y2 = malloc(n * sizeof *y2), work;
	enum separate_status status;

	if (!y2)
		return SEPARATE_MEMORY;
	memcpy(y2, x2, n * sizeof *y2);
	negate(y2, n);
	status = calibrate_as(par, 1, x1, y2, n, c);
	free(y2);
	c->gain = -c->gain;
	if (status == SEPARATE_MEMORY ||
		(status == SEPARATE_OK && calibration_describes(c)))
		return status;
	if (status == SEPARATE_OK)
		calibration_clear(c);
	work = c->work;
	rest.most -= work;
	status = calibrate_as(&rest, 1, x1, x2, n, c);
	c->work += work;
	return status == SEPARATE_OPPOSITE ? SEPARATE_NO_LAG : status;
}

/* Range of the delays, in durations. */
static double delays_of(const struct calibration *c)
{
	return (c->delta_max - c->delta_min) / c->duration;
}

/* SWAPPED if pulses describe the record with its channels exchanged, unless they describe
 * it as it is with a narrower range of delays: among few pulses two particles may look
 * like one that passes sensor 2 first, and where any delay is allowed there are always
 * two.  Otherwise learns as if none did. */
static enum separate_status calibrate_swapped(const struct calibrate_par *par,
	const double *x1, const double *x2, size_t n, struct calibration *c)
{
	struct calibrate_par known = *par;
	struct calibration exchanged;
	enum separate_status status;
	int describes;

	known.in_order = 1;
	known.gain = 1 / par->gain;
	known.hidden[0] = par->hidden[1];
	known.hidden[1] = par->hidden[0];
	status = calibrate_as(&known, 1, x2, x1, n, &exchanged);
	if (status == SEPARATE_MEMORY)
		return status;
	describes = status == SEPARATE_OK && calibration_describes(&exchanged);
	known = *par;
	known.in_order = 1;
	known.most -= exchanged.work;
	status = calibrate(&known, x1, x2, n, c);
	c->work += exchanged.work;
	if (describes && status != SEPARATE_MEMORY &&
		!(status == SEPARATE_OK && calibration_describes(c) &&
			delays_of(c) < delays_of(&exchanged))) {
		if (status == SEPARATE_OK)
			calibration_clear(c);
		status = SEPARATE_SWAPPED;
	}
	calibration_clear(&exchanged);
	return status;
}

enum separate_status calibrate(const struct calibrate_par *par, const double *x1,
	const double *x2, size_t n, struct calibration *c)
{
	enum separate_status status = calibrate_as(par, 0, x1, x2, n, c);

	return status == SEPARATE_OPPOSITE  ? calibrate_opposite(par, x1, x2, n, c)
	       : status == SEPARATE_SWAPPED ? calibrate_swapped(par, x1, x2, n, c)
					    : status;
}
