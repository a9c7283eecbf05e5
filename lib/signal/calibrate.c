/* calibrate.c - see calibrate.h */
#include "signal/calibrate.h"
#include "signal/align.h"
#include "signal/colour.h"
#include "signal/learn.h"
#include "signal/robust.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

double calibrate_drop(double rate, const struct shape *shape, double duration,
	double gain, double width)
{
	double lambda =
		shape_slope_energy(shape) / shape_energy(shape) / (duration * duration);
	double area = width * lambda * gain / (1 + gain * gain) / pow(2 * acos(-1), 1.5);
	double edge = sqrt(lambda) / (2 * acos(-1)), lo = 1, hi = 40;

	while (hi - lo > 1e-6) {
		double u = (lo + hi) / 2;

		if ((area * u + edge) * exp(-u * u / 2) > rate)
			lo = u;
		else
			hi = u;
	}
	return hi * hi;
}

int calibrate_clean(const struct calibration *c, double *x, size_t n, double *change,
	double power[TONES_MAX])
{
	double before[2 * TONES_MAX + 1], after[2 * TONES_MAX + 1], at = 0;
	size_t hop = c->tone_hop < n ? c->tone_hop : n;
	double squares = 0, count = 0, hops = 0;

	memset(power, 0, sizeof(double) * TONES_MAX);
	for (size_t middle = hop / 2, done = 0; done < n; middle += hop) {
		size_t from = middle > hop ? middle - hop : 0;
		size_t to = middle + hop < n ? middle + hop : n, until;

		if (from + hop > n) /* the last stretch keeps its length */
			from = n - hop;
		if (!tones_fit(x + (from > done ? from : done),
			    to - (from > done ? from : done),
			    (double)(from > done ? from : done), c->tones, c->omega,
			    after, NULL, NULL))
			return 0;
		if (done == 0)
			memcpy(before, after, sizeof before);
		for (int k = 1; k <= 2 * c->tones; k++)
			power[(k - 1) / 2] += after[k] * after[k] / 2;
		hops++;
		for (int k = 1; done > 0 && k <= 2 * c->tones; k++) {
			squares += (after[k] - before[k]) * (after[k] - before[k]);
			count++;
		}
		until = middle < n ? middle : n;
		if (middle + hop / 2 >= n)
			until = n;
		tones_remove(x + done, until - done, (double)done, c->tones, c->omega, at,
			before, (double)middle, after);
		memcpy(before, after, sizeof before);
		at = (double)middle;
		done = until;
	}
	*change = count > 0 ? squares / count : INFINITY;
	for (int k = 0; k < c->tones; k++)
		power[k] /= hops;
	return 1;
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

static double variance(const double *x, size_t n)
{
	double middle = mean(x, n), sum = 0;

	for (size_t i = 0; i < n; i++)
		sum += (x[i] - middle) * (x[i] - middle);
	return sum / (double)n;
}

/* Range of the delays as far as it is known. */
static void set_range(const struct calibrate_par *par, struct calibration *c)
{
	double share = isnan(par->spread) ? 0.1 : par->spread;
	double spread = fmax(share * (double)c->shift, 0.05 * c->duration);

	c->delta_min = -spread;
	c->delta_max = spread;
}

static void set_thresholds(const struct calibrate_par *par, struct calibration *c)
{
	double gain = c->gain * c->noise[0] / c->noise[1];

	c->drop = calibrate_drop(par->false_alarm, c->shape, c->duration, gain,
		c->delta_max - c->delta_min);
	/* Next to a pulse the search is over some 40 cells: 23 means 2e-3 false ones. */
	c->drop_near = c->drop < 23 ? c->drop : 23;
}

/* Matched filter of y[0 .. n) at every eighth of a duration; returns the number of
 * points, 0 when out of memory. */
static size_t filter_points(
	const struct calibration *c, const double *y, size_t n, double *out)
{
	double T = c->duration;
	size_t len, count = 0, stride = (size_t)(T / 8);
	long first = shape_support(c->shape, 0, T, &len);
	double *p = malloc(len * sizeof *p);

	if (p && n > len) {
		shape_sample(c->shape, 0, T, first, len, p, NULL, NULL);
		for (size_t at = 0; at + len <= n; at += stride, count++) {
			out[count] = 0;
			for (size_t i = 0; i < len; i++)
				out[count] += p[i] * y[at + i];
		}
	}
	free(p);
	return count;
}

/* Correlation of the filtered channels over the quietest tenth of the record: noise has
 * none, pulses that are always there have much.  *level is the root mean square there, 1
 * for white noise.  r holds n. */
static double quiet_coherence(const struct calibration *c, const double *y1,
	const double *y2, size_t n, double *r, double *level)
{
	enum { BLOCK = 16 }; /* points: two durations */
	double *z = malloc((n + 2) * sizeof *z), xy = 0, xx = 0, yy = 0, limit, count = 0;
	size_t points, blocks;

	if (!z)
		return 0;
	points = filter_points(c, y1, n, z);
	/* A point per eighth of a duration of at least 8 samples: two channels fit in n.
	 */
	points = points < n / 2 && filter_points(c, y2, n, z + n / 2) == points ? points
										: 0;
	blocks = points / BLOCK;
	for (size_t b = 0; b < blocks; b++) {
		r[b] = 0;
		for (size_t i = b * BLOCK; i < (b + 1) * BLOCK; i++)
			r[b] += z[i] * z[i] + z[n / 2 + i] * z[n / 2 + i];
		r[blocks + b] = r[b];
	}
	limit = robust_quantile(r, blocks, 0.1);
	for (size_t b = 0; b < blocks; b++)
		for (size_t i = b * BLOCK; r[blocks + b] <= limit && i < (b + 1) * BLOCK;
			i++) {
			xy += z[i] * z[n / 2 + i];
			xx += z[i] * z[i];
			yy += z[n / 2 + i] * z[n / 2 + i];
			count += 2;
		}
	*level =
		count > 0
			? sqrt((xx + yy) / count / (c->duration * shape_energy(c->shape)))
			: 0;
	free(z);
	return xx > 0 && yy > 0 ? xy / sqrt(xx * yy) : 0;
}

/* Standard deviation of white noise that would have the same effect on the matched
 * filter as the noise there is; for records that have been filtered before. */
static double filtered_noise(
	const struct calibration *c, const double *y, size_t n, double *work)
{
	size_t count = filter_points(c, y, n, work);

	for (size_t i = 0; i < count; i++)
		work[i] = fabs(work[i]);
	return count ? 1.482602218505602 * robust_median(work, count) /
			       sqrt(c->duration * shape_energy(c->shape))
		     : 1;
}

static void normalise(const struct calibration *c, double *y1, double *y2, size_t n)
{
	for (size_t i = 0; i < n; i++) {
		y1[i] /= c->noise[0];
		y2[i] /= c->noise[1];
	}
}

/* Correlation coefficient of y1 with y2 lag samples later. */
static double correlation_at(const double *y1, const double *y2, size_t n, size_t lag)
{
	double xy = 0, xx = 0, yy = 0;

	for (size_t i = 0; i + lag < n; i++) {
		xy += y1[i] * y2[i + lag];
		xx += y1[i] * y1[i];
		yy += y2[i + lag] * y2[i + lag];
	}
	return xx > 0 && yy > 0 ? xy / sqrt(xx * yy) : 0;
}

/* A correlation that channels with nothing in common do not reach: six of its standard
 * deviations, by Bartlett's formula from the autocorrelation r at n / 4 lags; half where
 * the record is too short to tell. */
static double chance_correlation(const double *r, size_t n)
{
	double sum = 1;
	size_t lags = n / 4 < 4096 ? n / 4 : 4096;

	for (size_t k = 1; k <= lags; k++)
		sum += 2 * (r[k] / r[0]) * (r[k] / r[0]);
	return fmin(6 * sqrt(sum / (double)n), 0.5);
}

/* Too much noise was assumed where the pulses leave less than that. */
static int scale_noise(struct calibration *c, double *y1, double *y2, size_t n)
{
	int wrong = c->events > 0 && (c->rest[0] < 0.75 || c->rest[1] < 0.75);

	for (int k = 0; wrong && k < 2; k++) {
		double *y = k ? y2 : y1, scale = sqrt(c->rest[k]);

		c->noise[k] *= scale;
		for (size_t i = 0; i < n; i++)
			y[i] /= scale;
	}
	return wrong;
}

/* Share of the noise that filter and whitening have taken. */
static double lost(const struct calibration *c)
{
	return c->whitening.tap ? 1 - fmin(c->whitening.band, 1) : 0;
}

static int measure_noise(
	struct calibration *c, const double *y1, const double *y2, size_t n, double *work)
{
	size_t shift = (size_t)c->shift;

	if (c->whitening.tap &&
		!colour_level(y1, y2 + shift, n - shift, &c->whitening, c->noise))
		return 0;
	for (int k = 0; k < 2; k++) {
		const double *y = k ? y2 : y1;
		double least = 1e-6 * sqrt(variance(y, n));

		if (!c->whitening.tap)
			c->noise[k] = robust_noise(y, n, 4, work);
		if (!(c->noise[k] > least))
			c->noise[k] = least;
	}
	return 1;
}

/* What a first look at the record tells about its noise. */
struct look {
	int attempts;
	int coloured;
	enum whiten_kind kind; /* tried now */
	int settled;           /* 1: for the last time */
	double low;            /* lag of the lowest autocorrelation */
	double power[COLOUR_BINS];
};

static int has_colour(const double *y1, const double *y2, size_t n, struct look *look)
{
	static const double one[2] = { 1, 1 };

	look->coloured = colour_power(y1, y2, n, one, look->power) == 1 &&
			 !colour_is_white(look->power, 0);
	return look->coloured;
}

static enum calibrate_status measure(const struct calibrate_par *par, double *y1,
	double *y2, size_t n, struct calibration *c, double *r, struct look *look)
{
	size_t max_lag = n / 2, rest;
	double lag = par->lag, low, change[2], power[2][TONES_MAX], coherence, level = 0;

	if (par->tones == CALIBRATE_FIND_TONES) {
		c->tones = tones_find(y1, y2, n, TONES_MAX, c->omega);
		if (c->tones < 0)
			return CALIBRATE_MEMORY;
		rest = n < 16384 ? n : 16384;
		c->tones = tones_confirm(y1 + (n - rest) / 2, y2 + (n - rest) / 2, rest,
			1 - lost(c), c->tones, c->omega);
	} else {
		c->tones = par->tones;
		memcpy(c->omega, par->omega, sizeof c->omega);
	}
	c->tone_hop = n < 8192 ? n : 4096;
	if (!calibrate_clean(c, y1, n, &change[0], power[0]) ||
		!calibrate_clean(c, y2, n, &change[1], power[1]))
		return CALIBRATE_MEMORY;
	if (isnan(lag))
		lag = align_lag(y1, y2, n, max_lag, &c->correlation);
	else if (lag < (double)n - 16)
		c->correlation = correlation_at(y1, y2, n, (size_t)(lag + 0.5));
	if (lag < 0)
		return lag == -1 ? CALIBRATE_MEMORY : CALIBRATE_NO_LAG;
	c->shift = (long)floor(lag + 0.5);
	if (c->shift >= (long)n - 16)
		return CALIBRATE_NO_LAG;
	if (!measure_noise(c, y1, y2, n, r))
		return CALIBRATE_MEMORY;
	if (isnan(par->duration) || isnan(par->lag)) {
		if (n > 4096 && c->correlation < 6 / sqrt((double)n))
			return CALIBRATE_NO_LAG; /* whatever the autocorrelation */
		if (!align_autocorrelation(y1, y2, n, n / 4, r))
			return CALIBRATE_MEMORY;
		if (c->correlation < chance_correlation(r, n))
			return CALIBRATE_NO_LAG;
	}
	c->transit = c->shift > 0 ? (double)c->shift : INFINITY;
	rest = n - (size_t)c->shift;
	y2 += c->shift;
	if (!align_autocorrelation(y1, y2, rest, rest / 4, r))
		return CALIBRATE_MEMORY;
	low = learn_lowest_lag(r, rest / 4);
	if (!c->whitening.tap)
		look->low = low;
	else if (look->coloured && look->kind == WHITEN_COLOURED)
		low = look->low; /* whitening has changed the pulses */
	c->pulse = par->pulse == CALIBRATE_ANY_PULSE ? PULSE_SINE : par->pulse;
	c->duration =
		isnan(par->duration) ? learn_duration(c->pulse, low) : par->duration;
	if (!learn_set_shape(c, c->pulse))
		return CALIBRATE_MEMORY;
	if (!(c->duration >= 8))
		return CALIBRATE_FAST;
	if (8 * c->duration > (double)n && c->duration > 0.5 * (double)n)
		return CALIBRATE_SLOW;
	c->gain = par->gain;
	if (isnan(c->gain)) {
		double v1 = variance(y1, rest) - c->noise[0] * c->noise[0];
		double v2 = variance(y2, rest) - c->noise[1] * c->noise[1];

		c->gain = v1 > 0 && v2 > 0 ? sqrt(v2 / v1) : 1;
	}
	for (int k = 0; k < c->tones; k++)
		c->tone_power[k] = power[0][k] / (c->noise[0] * c->noise[0]);
	c->tone_variance = fmax(change[0] / (c->noise[0] * c->noise[0]),
		change[1] / (c->noise[1] * c->noise[1]));
	normalise(c, y1, y2, rest);
	set_range(par, c);
	set_thresholds(par, c);
	c->misfit = 3e-4;
	if (!c->whitening.tap)
		c->suspect = has_colour(y1, y2, rest, look);
	if (learn_pulse(par, y1, y2, rest, low, c) != CALIBRATE_OK)
		return CALIBRATE_MEMORY;
	for (int k = 0; c->whitening.tap && k < 4 && scale_noise(c, y1, y2, rest); k++) {
		set_range(par, c);
		set_thresholds(par, c);
		if (learn_pulse(par, y1, y2, rest, low, c) != CALIBRATE_OK)
			return CALIBRATE_MEMORY;
	}
	if (c->events == 0 && isnan(par->duration))
		return CALIBRATE_NO_LAG;
	coherence = c->chi2 > 4 ? quiet_coherence(c, y1, y2, rest, r, &level) : 0;

	if (c->chi2 > 4 && (coherence > 0.6 || (level < 1.5 && !c->whitening.tap))) {
		/* Even where it is most quiet, both sensors see the same, or the noise is
		 * what it should be there: too many pulses. */
		c->dense = 1;
		c->misfit = 0.01;
		set_range(par, c);
	} else if (c->suspect) {
		return CALIBRATE_OK; /* to be looked at again */
	} else if (c->chi2 > 4 && !c->whitening.tap) {
		/* Neither the shape nor white noise will do: the record was filtered.
		 * What counts then is the noise that passes the matched filter. */
		double n1 = filtered_noise(c, y1, rest, r),
		       n2 = filtered_noise(c, y2, rest, r);

		c->noise[0] *= n1;
		c->noise[1] *= n2;
		for (size_t i = 0; i < rest; i++) {
			y1[i] /= n1;
			y2[i] /= n2;
		}
		c->misfit = 0.15;
		set_range(par, c);
		set_thresholds(par, c);
		if (learn_pulse(par, y1, y2, rest, low, c) != CALIBRATE_OK)
			return CALIBRATE_MEMORY;
	}
	set_thresholds(par, c);
	return CALIBRATE_OK;
}

/* One attempt, on a record made white if w has taps, which it gives to *c. */
static enum calibrate_status attempt(const struct calibrate_par *par, const double *x1,
	const double *x2, size_t n, const struct whitening *w, struct calibration *c,
	struct look *look)
{
	double *work = malloc(3 * n * sizeof *work);
	enum calibrate_status status = work ? CALIBRATE_OK : CALIBRATE_MEMORY;
	size_t edge = n > 8 * (size_t)w->edge ? (size_t)w->edge : 0;

	memset(c, 0, sizeof *c);
	look->attempts++;
	c->whitening = *w;
	c->guessed = look->settled;
	c->suspect = look->coloured && !look->settled;
	for (int k = 0; work && k < 2; k++) {
		double *y = work + (size_t)k * n;

		memcpy(y, k ? x2 : x1, n * sizeof *work);
		if (!w->tap)
			continue;
		c->mean[k] = mean(y, n);
		for (size_t i = 0; i < n; i++)
			y[i] -= c->mean[k];
		if (!whitening_apply(w, y, n))
			status = CALIBRATE_MEMORY;
	}
	if (status == CALIBRATE_OK)
		status = measure(par, work + edge, work + n + edge, n - 2 * edge, c,
			work + 2 * n, look);
	free(work);
	if (status != CALIBRATE_OK)
		calibration_clear(c);
	return status;
}

static enum calibrate_status attempt_kind(const struct calibrate_par *par,
	const double *x1, const double *x2, size_t n, enum whiten_kind kind,
	struct look *look, struct calibration *c)
{
	struct whitening w;

	look->kind = kind;
	if (!whitening_of_noise(&w, look->power, COLOUR_BINS, kind))
		return CALIBRATE_MEMORY;
	return attempt(par, x1, x2, n, &w, c, look);
}

/* Looks again at a record whose noise is not white: filtered, or coloured from the start?
 * What fits best by itself is done once more, with its pulse corrected. */
static enum calibrate_status look_again(const struct calibrate_par *par, const double *x1,
	const double *x2, size_t n, struct look *look, struct calibration *c)
{
	double best = c->price;
	int found = -1;

	for (int kind = WHITEN_FILTERED; kind <= WHITEN_COLOURED; kind++) {
		struct calibration other;
		enum calibrate_status status =
			attempt_kind(par, x1, x2, n, kind, look, &other);

		if (status == CALIBRATE_MEMORY)
			return status;
		if (status != CALIBRATE_OK)
			continue;
		if (other.price < best) {
			best = other.price;
			found = kind;
		}
		calibration_clear(&other);
	}
	if (found < 0)
		return CALIBRATE_OK;
	look->settled = 1;
	calibration_clear(c);
	return attempt_kind(par, x1, x2, n, found, look, c);
}

/* Durations of a pulse times the frequency above which it has hardly any power. */
static const double PULSE_BAND = 10;

/* Is the noise white after all?  Where hardly anything is quiet, pulses stand for colour.
 * Then they fit as well as in white noise, or tolerably, and noise is white above their
 * band. */
static int is_white(const struct calibration *c, const struct look *look)
{
	return c->chi2 < 1.2 ||
	       (c->chi2 < 4 && colour_is_white(look->power,
				       fmin(PULSE_BAND / c->duration, 0.25)));
}

/* Power of a tone, in units of noise^2, that tails of pulses may be taken for. */
static const double TAILS = 4;

/* The tails of a regular train of pulses have lines, too, which a robust fit may see.  Is
 * the record better described without the weak ones that were found? */
static enum calibrate_status try_fewer_tones(const struct calibrate_par *par,
	const double *x1, const double *x2, size_t n, struct look *look,
	struct calibration *c)
{
	struct calibrate_par fewer = *par;
	struct whitening w = { .tap = NULL };
	struct look other_look = { .attempts = look->attempts };
	struct calibration other;
	enum calibrate_status status;

	fewer.tones = 0;
	for (int k = 0; k < c->tones; k++)
		if (c->tone_power[k] > TAILS)
			fewer.omega[fewer.tones++] = c->omega[k];
	if (fewer.tones == c->tones)
		return CALIBRATE_OK;
	status = attempt(&fewer, x1, x2, n, &w, &other, &other_look);
	look->attempts = other_look.attempts;
	if (status != CALIBRATE_OK)
		return status == CALIBRATE_MEMORY ? status : CALIBRATE_OK;
	if (other.price < c->price) {
		calibration_clear(c);
		*c = other;
		*look = other_look;
	} else {
		calibration_clear(&other);
	}
	return CALIBRATE_OK;
}

enum calibrate_status calibrate(const struct calibrate_par *par, const double *x1,
	const double *x2, size_t n, struct calibration *c)
{
	enum calibrate_status status;
	struct whitening w = { .tap = NULL };
	struct look look = { 0 };

	memset(c, 0, sizeof *c);
	if (is_constant(x1, n))
		return CALIBRATE_SILENT_1;
	if (is_constant(x2, n))
		return CALIBRATE_SILENT_2;
	if (par->filter && !whitening_of_filter(&w, par->filter, par->filter_taps))
		return CALIBRATE_MEMORY;
	status = attempt(par, x1, x2, n, &w, c, &look);
	if (status == CALIBRATE_OK && par->tones == CALIBRATE_FIND_TONES && !w.tap &&
		!c->dense)
		status = try_fewer_tones(par, x1, x2, n, &look, c);
	if (status == CALIBRATE_OK && look.coloured && !c->dense && !is_white(c, &look))
		status = look_again(par, x1, x2, n, &look, c);
	c->attempts = look.attempts;
	return status;
}

void calibration_clear(struct calibration *c)
{
	shape_free(c->shape);
	c->shape = NULL;
	whitening_clear(&c->whitening);
}

void calibration_scene(const struct calibration *c, struct joint_scene *scene)
{
	*scene = (struct joint_scene){ .shape = c->shape,
		.duration = c->duration,
		.transit = c->transit,
		.gain = c->gain * c->noise[0] / c->noise[1],
		.delta_min = c->delta_min,
		.delta_max = c->delta_max,
		.drop = c->drop,
		.drop_near = c->drop_near,
		.misfit = c->misfit,
		.offset = 1,
		.tone_variance = c->tone_variance,
		.low = c->whitening.low,
		.lost = lost(c) };
	for (int k = 0; k < c->tones; k++)
		if (c->omega[k] * c->duration < 8 * acos(-1) || isinf(c->tone_variance))
			scene->omega[scene->tones++] = c->omega[k];
}
