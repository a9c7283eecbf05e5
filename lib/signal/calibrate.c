/* calibrate.c - see calibrate.h */
#include "signal/calibrate.h"
#include "signal/learn.h"
#include "signal/noise.h"
#include "signal/robust.h"
#include "signal/start.h"
#include "signal/tape.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Band of a filter, over one cycle per duration of a pulse, that tells too little of it:
 * what it leaves rings on, and others fit into that. */
static const double NARROW = 0.5;

/* Chi-square that a pulse next to another must take away. */
static const double NEAR = 28;

/* The record that is learned from. */
struct record {
	const double *x[2];
	size_t n;
	struct tape tape[2]; /* whitened, in units of the noise */
	double *y[2];        /* of these, aligned */
	unsigned char *bad[2];
	size_t length;
	double *work; /* 2 n */
	struct noise noise;
	struct learning *learning;
};

double calibrate_drop(double rate, const struct shape *shape, double duration,
	double gain, double width)
{
	double lambda =
		shape_slope_energy(shape) / shape_energy(shape) / (duration * duration);
	double area = width * lambda * gain / (1 + gain * gain) / pow(2 * M_PI, 1.5);
	double edge = sqrt(lambda) / (2 * M_PI), lo = 1, hi = 40;

	while (hi - lo > 1e-6) {
		double u = (lo + hi) / 2;

		if ((area * u + edge) * exp(-u * u / 2) > rate)
			lo = u;
		else
			hi = u;
	}
	return hi * hi;
}

static int is_constant(const double *x, size_t n)
{
	for (size_t i = 1; i < n; i++)
		if (x[i] != x[0])
			return 0;
	return 1;
}

static double mean(const double *x, size_t n)
{
	double sum = 0;

	for (size_t i = 0; i < n; i++)
		sum += x[i] / (double)n;
	return sum;
}

/* Mean square beyond the noise, of all but the loudest thousandth. */
static double power(const double *y, size_t n, double *work)
{
	double limit, sum = 0;

	for (size_t i = 0; i < n; i++)
		work[i] = y[i] * y[i];
	limit = robust_quantile(work, n, 0.999);
	for (size_t i = 0; i < n; i++)
		sum += fmin(y[i] * y[i], limit);
	return sum / (double)n - 1;
}

/* --- the record made white */

/* Runs both channels through their tapes as c says. */
static int clean(struct record *r, struct calibration *c)
{
	double squares = 0, count = 0;

	for (int k = 0; k < 2; k++) {
		struct tape *t = &r->tape[k];

		tape_clear(t);
		if (!tape_append(t, r->x[k], 1, r->n) || !tape_start(t, c, k) ||
			!tape_prepare(t, c, k, 1))
			return 0;
		squares = fmax(squares, t->squares / (c->noise[k] * c->noise[k]));
		count = t->count;
	}
	c->tone_variance = count > 0 ? squares / count : INFINITY;
	return 1;
}

/* Samples at either end that are not what they should be. */
static size_t edge_of(const struct record *r, const struct calibration *c)
{
	int edge = c->whitening[0].edge > c->whitening[1].edge ? c->whitening[0].edge
							       : c->whitening[1].edge;

	return r->n > 8 * (size_t)edge ? (size_t)edge : 0;
}

/* Level that 40 % of |x| stay below. */
static double quiet_level(const double *x, size_t n, double *work)
{
	for (size_t i = 0; i < n; i++)
		work[i] = fabs(x[i]);
	return robust_quantile(work, n, 0.4);
}

/* A line that is there makes what is quiet quieter when it is taken off; one that regular
 * pulses have makes it louder. */
static int drop_false_tones(
	const double *y1, const double *y2, size_t n, struct calibration *c)
{
	double *x = malloc(3 * n * sizeof *x), *rest = x + n, *work = rest + n;
	double coefficient[2][2 * TONES_MAX + 1], none[2 * TONES_MAX + 1] = { 0 };
	int keep[TONES_MAX] = { 0 }, spoil[TONES_MAX] = { 0 }, kept = 0;

	for (int ch = 0; x && ch < 2; ch++) {
		double level;

		if (!tones_fit(ch ? y2 : y1, n, 0, c->tones, c->omega, coefficient[ch],
			    NULL, NULL))
			continue;
		memcpy(rest, ch ? y2 : y1, n * sizeof *rest);
		tones_remove(rest, n, 0, c->tones, c->omega, 0, coefficient[ch], 1,
			coefficient[ch]);
		level = quiet_level(rest, n, work);
		for (int k = 0; k < c->tones; k++) {
			double with;

			memset(none, 0, sizeof none);
			none[1 + 2 * k] = -coefficient[ch][1 + 2 * k];
			none[2 + 2 * k] = -coefficient[ch][2 + 2 * k];
			memcpy(x, rest, n * sizeof *x);
			tones_remove(x, n, 0, c->tones, c->omega, 0, none, 1, none);
			with = quiet_level(x, n, work);
			keep[k] |= with > level * 1.002;
			spoil[k] |= with < level * 0.998;
		}
	}
	for (int k = 0; x && k < c->tones; k++)
		if (keep[k] && !spoil[k])
			c->omega[kept++] = c->omega[k];
	c->tones = x ? kept : c->tones;
	free(x);
	return x != NULL;
}

static int find_tones(
	const struct calibrate_par *par, struct record *r, struct calibration *c)
{
	enum { ENOUGH = 16384 };
	size_t edge = edge_of(r, c), n = r->n - 2 * edge, some = n < ENOUGH ? n : ENOUGH,
	       from = edge + (n - some) / 2;
	const double *y1 = r->tape[0].x + edge, *y2 = r->tape[1].x + edge;

	c->tone_hop = r->n < 8192 ? r->n : 4096;
	if (par->tones != CALIBRATE_FIND_TONES) {
		c->tones = par->tones;
		memcpy(c->omega, par->omega, sizeof c->omega);
		return 1;
	}
	c->tones = tones_find(y1, y2, n, TONES_MAX, c->omega);
	if (c->tones < 0)
		return 0;
	c->tones = tones_confirm(r->tape[0].x + from, r->tape[1].x + from, some,
		par->filter ? fmin(c->whitening[0].band, 1) : 1, c->tones, c->omega);
	return drop_false_tones(r->tape[0].x + from, r->tape[1].x + from, some, c);
}

/* Sets noise and, unless the filter is told, taps by the spectrum of the noise. */
static int use_noise(
	const struct calibrate_par *par, struct record *r, struct calibration *c)
{
	for (int k = 0; k < 2; k++) {
		double level = noise_level(&r->noise, k);

		if (par->filter) {
			const struct whitening *w = &c->whitening[k];
			int from = (int)(w->low * 2 * (NOISE_BINS - 1)) + 1,
			    to = (int)(w->high * 2 * (NOISE_BINS - 1));
			double work[NOISE_BINS];

			to = to < from ? from : to;
			memcpy(work, r->noise.power[k], sizeof work);
			level = sqrt(robust_median(work + from, (size_t)(to - from + 1)));
		} else {
			whitening_clear(&c->whitening[k]);
			memset(&c->whitening[k], 0, sizeof c->whitening[k]);
			if (!r->noise.white[k] &&
				!noise_whitening(&r->noise, k, &c->whitening[k]))
				return 0;
		}
		c->noise[k] = level;
	}
	return 1;
}

/* A channel without noise still needs some, a millionth of its signal. */
static void least_noise(struct record *r, struct calibration *c)
{
	for (int k = 0; k < 2; k++) {
		double sum = 0, m = mean(r->x[k], r->n), least;

		for (size_t i = 0; i < r->n; i++)
			sum += (r->x[k][i] - m) * (r->x[k][i] - m);
		least = 1e-6 * sqrt(sum / (double)r->n);
		if (!(c->noise[k] > least)) {
			c->noise[k] = least;
			for (int i = 0; i < NOISE_BINS; i++)
				r->noise.power[k][i] = least * least;
		}
	}
}

/* Gaps, tones and a first spectrum of the noise. */
static enum calibrate_status make_white(
	const struct calibrate_par *par, struct record *r, struct calibration *c)
{
	size_t edge;

	for (int k = 0; k < 2; k++) {
		gaps_learn(&c->gaps[k], r->x[k], r->n);
		c->mean[k] = mean(r->x[k], r->n);
		c->noise[k] = 1;
		if (par->filter && !whitening_of_filter(&c->whitening[k], par->filter,
					   par->filter_taps))
			return CALIBRATE_MEMORY;
	}
	if (!clean(r, c) || !find_tones(par, r, c) || (c->tones && !clean(r, c)))
		return CALIBRATE_MEMORY;
	edge = edge_of(r, c);
	if (!noise_measure(
		    &r->noise, r->tape[0].x + edge, r->tape[1].x + edge, r->n - 2 * edge))
		return CALIBRATE_MEMORY;
	if (!use_noise(par, r, c))
		return CALIBRATE_MEMORY;
	least_noise(r, c);
	return clean(r, c) ? CALIBRATE_OK : CALIBRATE_MEMORY;
}

/* The second channel moves back; what the filters spoil at the ends is left out. */
static void align(struct record *r, const struct calibration *c)
{
	size_t edge = edge_of(r, c), shift = (size_t)c->shift;

	for (int k = 0; k < 2; k++) {
		r->y[k] = r->tape[k].x + edge + (k ? shift : 0);
		r->bad[k] = r->tape[k].bad + edge + (k ? shift : 0);
	}
	r->length = r->n - 2 * edge - shift;
}

/* --- lag and duration */

static void set_range(const struct calibrate_par *par, struct calibration *c)
{
	double share = isnan(par->spread) ? 0.1 : par->spread;
	double spread = fmax(share * (double)c->shift, 0.05 * c->duration);

	c->delta_min = -spread;
	c->delta_max = spread;
}

static enum calibrate_status find_start(
	const struct calibrate_par *par, struct record *r, struct calibration *c)
{
	size_t edge = edge_of(r, c), n = r->n - 2 * edge;
	double v1, v2;
	struct start s;

	if (!isnan(par->lag) && !(par->lag < (double)n - 16))
		return CALIBRATE_FAR;
	if (!start_find(r->tape[0].x + edge, r->tape[1].x + edge, n, par->duration,
		    par->lag, r->noise.quiets == 0, &s))
		return CALIBRATE_MEMORY;
	if (s.duration == 0 ||
		(s.score == 0 && (isnan(par->lag) || isnan(par->duration))))
		return CALIBRATE_NO_LAG;
	c->duration = s.duration;
	if (par->filter &&
		(c->whitening[0].high - c->whitening[0].low) * c->duration < NARROW)
		return CALIBRATE_NARROW;
	if (!(c->duration >= 8))
		return CALIBRATE_FAST;
	if (c->duration > 0.5 * (double)r->n)
		return CALIBRATE_SLOW;
	if (s.together)
		return CALIBRATE_TOGETHER;
	if (s.lag < 0)
		return CALIBRATE_SWAPPED;
	c->shift = s.lag;
	c->transit = c->shift > 0 ? (double)c->shift : INFINITY;
	v1 = power(r->tape[0].x + edge, n, r->work);
	v2 = power(r->tape[1].x + edge, n, r->work);
	c->gain = !isnan(par->gain)  ? par->gain
		  : v1 > 0 && v2 > 0 ? sqrt(v2 / v1) * c->noise[1] / c->noise[0]
				     : 1;
	c->gain *= s.sign;
	set_range(par, c);
	return CALIBRATE_OK;
}

/* --- rounds */

/* A line that regular pulses have was taken off in vain, and stands in what they leave.
 * Returns how many are dropped. */
static int drop_pulse_tones(
	const struct record *r, struct calibration *c, double *const rest[2], size_t n)
{
	int kept = 0, before = c->tones;
	double coefficient[2][2 * TONES_MAX + 1];

	for (int k = 0; k < 2; k++)
		if (c->tones == 0 ||
			!tones_fit(rest[k], n,
				(double)edge_of(r, c) + k * (double)c->shift, c->tones,
				c->omega, coefficient[k], NULL, NULL))
			return 0;
	for (int t = 0; t < before; t++) {
		int vain = 0;

		for (int k = 0; k < 2; k++) {
			const double *taken = r->tape[k].coefficient + 1 + 2 * t;
			const double *left = coefficient[k] + 1 + 2 * t;

			vain |= hypot(left[0], left[1]) * c->noise[k] >
				0.5 * hypot(taken[0], taken[1]);
		}
		if (!vain)
			c->omega[kept++] = c->omega[t];
	}
	c->tones = kept;
	return before - kept;
}

/* Spectrum of what the pulses leave: what it is not white by is put right. */
static int measure_rest(
	const struct calibrate_par *par, struct record *r, struct calibration *c)
{
	size_t n = r->length;
	const struct learning *l = r->learning;
	double *rest[2] = { r->work, r->work + r->n };
	struct noise noise;

	for (int k = 0; k < 2; k++)
		memcpy(rest[k], r->y[k], n * sizeof(double));
	for (int i = 0; i < l->count; i++)
		for (int k = 0; k < l->stretch[i].m && !l->stretch[i].foreign; k++) {
			struct joint_pulse p = l->stretch[i].pulse[k];

			p.t += (double)l->stretch[i].from;
			joint_add(&l->scene, &p, -1, rest[0], rest[1], n);
		}
	for (int k = 0; k < 2; k++)
		for (size_t i = 0; i < n; i++)
			if (r->bad[k][i])
				rest[k][i] = 0;
	if (drop_pulse_tones(r, c, rest, n))
		return 1;
	if (!noise_measure(&noise, rest[0], rest[1], n))
		return 0;
	if (noise.quiets == 0 && r->noise.quiets > 0)
		return 1;
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < NOISE_BINS; i++) {
			double before = c->whitening[k].tap && !par->filter
						? r->noise.power[k][i]
						: c->noise[k] * c->noise[k];

			r->noise.power[k][i] = before * noise.power[k][i];
		}
	r->noise.quiets = noise.quiets;
	for (int k = 0; k < 2; k++)
		r->noise.white[k] = noise.white[k] && !c->whitening[k].tap;
	return use_noise(par, r, c);
}

/* Pulses that have passed what coloured the noise are given back their height, at the
 * frequency that passed best. */
static void undo_colour(struct record *r, struct calibration *c)
{
	for (int k = 0; c->through && k < 2; k++) {
		struct whitening *w = &c->whitening[k];
		double most = 0, factor;

		for (int i = 0; i < NOISE_BINS; i++)
			most = fmax(most, r->noise.power[k][i]);
		factor = w->tap ? sqrt(most) / c->noise[k] : 1;
		c->noise[k] *= factor;
		for (int i = 0; w->tap && i <= 2 * w->half; i++)
			w->tap[i] *= factor;
	}
}

static void set_thresholds(const struct calibrate_par *par, struct calibration *c)
{
	double gain = fabs(c->gain) * c->noise[0] / c->noise[1];

	c->drop = calibrate_drop(par->false_alarm, c->shape[0], c->duration, gain,
		c->delta_max - c->delta_min);
	/* Next to a pulse the search is over some 40 cells: 28 means 2e-4 false ones. */
	c->drop_near = c->drop < NEAR ? c->drop : NEAR;
}

static enum calibrate_status settle(
	const struct calibrate_par *par, struct record *r, struct calibration *c)
{
	static const double minus = -1;
	double before = c->gain * c->noise[0] / c->noise[1];

	if (c->events == 0 && isnan(par->duration))
		return CALIBRATE_HOPELESS;
	undo_colour(r, c);
	c->gain = before * c->noise[1] / c->noise[0];
	for (int k = 0; k < 2; k++)
		c->noise[k] *= sqrt(fmin(fmax(c->level, 0.5), 2));
	if (c->reversed) {
		struct shape *plain = shape_filter(c->plain, 256, &minus, 0, 0);

		shape_free(c->plain);
		c->plain = plain;
		if (!plain || !calibration_set_shapes(c))
			return CALIBRATE_MEMORY;
	}
	set_thresholds(par, c);
	return CALIBRATE_OK;
}

/* Does what makes the noise white make pulses ring on and on?  Then they passed a filter
 * that must be told. */
static int rings(struct calibration *c, int *ok)
{
	static const double LONGEST = 12; /* durations */
	double reach;

	shape_free(c->plain);
	c->plain = shape_new(PULSE_SINE);
	*ok = c->plain && calibration_set_shapes(c);
	reach = *ok ? fmax(shape_reach_above(c->shape[0], 0.01),
			      shape_reach_above(c->shape[1], 0.01))
		    : 0;
	return reach > LONGEST;
}

/* Pulses everywhere, and none of them to learn from: as much as shot noise needs
 * (campbell.h), by a sine pulse. */
static enum calibrate_status settle_crowd(
	const struct calibrate_par *par, double duration, struct calibration *c)
{
	shape_free(c->plain);
	c->plain = shape_new(par->pulse == CALIBRATE_ANY_PULSE ? PULSE_SINE : par->pulse);
	c->pulse = par->pulse == CALIBRATE_ANY_PULSE ? PULSE_SINE : par->pulse;
	c->duration = duration;
	c->through = c->events = 0;
	c->error = INFINITY;
	c->error_least = c->error_floor = 0;
	c->level = 1;
	c->dense = 1;
	if (!c->plain || !calibration_set_shapes(c))
		return CALIBRATE_MEMORY;
	set_range(par, c);
	set_thresholds(par, c);
	return CALIBRATE_OK;
}

static enum calibrate_status learn_record(
	const struct calibrate_par *par, struct record *r, struct calibration *c)
{
	enum { ROUNDS = 2 };
	enum calibrate_status status = make_white(par, r, c);
	int rounds = ROUNDS, ok = 1;
	double duration;

	if (status == CALIBRATE_OK)
		status = find_start(par, r, c);
	duration = c->duration;
	if (status == CALIBRATE_OK && !par->filter && rings(c, &ok))
		status = CALIBRATE_NARROW;
	if (status == CALIBRATE_OK && !ok)
		status = CALIBRATE_MEMORY;
	for (int round = 0; status == CALIBRATE_OK && round < rounds; round++) {
		double gain = c->gain * c->noise[0] / c->noise[1];
		int tones = c->tones;

		if (round && (!measure_rest(par, r, c) || !clean(r, c)))
			return CALIBRATE_MEMORY;
		rounds += c->tones < tones;
		c->gain = round ? c->gain : gain * c->noise[1] / c->noise[0];
		align(r, c);
		if (r->length < 16)
			return CALIBRATE_FAR;
		c->drop = c->drop_near = NEAR;
		set_range(par, c);
		status = learn_pulse(par, r->y, r->bad, r->length, round, r->learning, c);
	}
	if (status == CALIBRATE_HOPELESS && r->noise.quiets == 0)
		return settle_crowd(par, duration, c);
	return status == CALIBRATE_OK ? settle(par, r, c) : status;
}

enum calibrate_status calibrate(const struct calibrate_par *par, const double *x1,
	const double *x2, size_t n, struct calibration *c)
{
	enum calibrate_status status = CALIBRATE_MEMORY;
	struct record r = { .x = { x1, x2 }, .n = n };

	memset(c, 0, sizeof *c);
	if (is_constant(x1, n))
		return CALIBRATE_SILENT_1;
	if (is_constant(x2, n))
		return CALIBRATE_SILENT_2;
	if (isnan(par->lag) && memcmp(x1, x2, n * sizeof *x1) == 0)
		return CALIBRATE_TOGETHER;
	r.work = malloc(2 * n * sizeof *r.work);
	r.learning = calloc(1, sizeof *r.learning);
	if (r.learning)
		r.learning->joint = joint_new();
	if (r.work && r.learning && r.learning->joint)
		status = learn_record(par, &r, c);
	for (int k = 0; k < 2; k++)
		tape_clear(&r.tape[k]);
	if (r.learning)
		joint_free(r.learning->joint);
	free(r.learning);
	free(r.work);
	if (status != CALIBRATE_OK)
		calibration_clear(c);
	return status;
}

void calibration_clear(struct calibration *c)
{
	shape_free(c->plain);
	c->plain = NULL;
	for (int k = 0; k < 2; k++) {
		shape_free(c->shape[k]);
		c->shape[k] = NULL;
		whitening_clear(&c->whitening[k]);
	}
}

int calibration_set_shapes(struct calibration *c)
{
	for (int k = 0; k < 2; k++) {
		const struct whitening *w = &c->whitening[k];

		shape_free(c->shape[k]);
		c->shape[k] = shape_filter(c->plain, fmax(c->duration, 8),
			c->through ? NULL : w->seen, w->seen_half, 2e-3);
		if (!c->shape[k])
			return 0;
	}
	return 1;
}

void calibration_scene(const struct calibration *c, struct joint_scene *scene)
{
	*scene = (struct joint_scene){ .shape = { c->shape[0], c->shape[1] },
		.duration = c->duration,
		.transit = c->transit,
		.gain = c->gain * c->noise[0] / c->noise[1],
		.delta_min = c->delta_min,
		.delta_max = c->delta_max,
		.drop = c->drop,
		.drop_near = c->drop_near,
		.misfit = 3 * fmax(c->error * c->error - c->error_least * c->error_least,
				      c->error_floor * c->error_floor),
		.negative = c->negatives ? 0
			    : c->dense   ? INFINITY
					 : 14,
		.offset = 1,
		.tone_variance = c->tone_variance,
		.low = c->whitening[0].low,
		.lost = c->whitening[0].tap ? 1 - fmin(c->whitening[0].band, 1) : 0 };
	for (int k = 0; k < c->tones; k++)
		if (c->omega[k] * c->duration < 8 * M_PI || isinf(c->tone_variance))
			scene->omega[scene->tones++] = c->omega[k];
}
