/* measure.c - see measure.h */
#include "signal/learn/measure.h"
#include "num/dot.h"
#include "num/lesser.h"
#include "num/robust.h"
#include "num/sigmas.h"
#include "signal/detect/align.h"
#include "signal/learn/find_lines.h"
#include "signal/learn/learn.h"
#include "signal/learn/matched.h"
#include "signal/noise/following.h"
#include "signal/noise/robust.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Share of the energy of a pulse that its shape may leave, see joint.h: if no lag
 * determines the duration, and if the shape is that before a filter. */
static const double UNKNOWN_MISFIT = 3e-4, FILTERED_MISFIT = 0.15;

/* Chi-square per degree of freedom above which pulses are not described.  1.5 and 3 give
 * the same rows in 26 records of 1499 particles (scenes of tests/matrix/scenes.tsv with
 * other shapes, filters, lines, coloured noise and groups, seed 11). */
static const double BAD_FIT = 2;

/* Least bandwidth of a filter, in cycles per duration of a pulse: with less, pulses ring
 * and other pulses are fitted to the ringing, and the correlation of the channels repeats
 * like that of a line. */
static const double NARROW = 0.5;

/* Share of its energy in which a pulse may differ from one of sensor.h and still be
 * corrected, rather than taken from the record.  In the records above 0.001 gives the
 * same rows, 0.01 17 more wrong ones. */
static const double NEAR = 0.003;

/* The same of the mean of few events, up to twice the least: their noise makes it differ.
 * With 0.003, of 100 sine pulses a second at 20 dB 91 % are found in two records of five,
 * and 94 % with this. */
static const double NEAR_OF_FEW = 0.01;

/* Parts of the record whose noise may differ. */
enum { LEVELS = 16 };

/* The record while it is measured: aligned from some point on, then in units of the
 * noise. */
struct record {
	const struct calibrate_par *par;
	double *y1, *y2;
	size_t n;
	double *work; /* the same length */
	double low;   /* lag of the lowest autocorrelation */
	int wide;     /* see measure.h */
	struct lines lines;
	double level[LEVELS]; /* noise of each part over its mean */
	size_t levelled;      /* samples of all parts */
};

/* 1 if the noise changes from part to part, by more than the standard error n samples
 * leave and more than neighbouring parts differ.  level[k] is that of part k. */
static int find_levels(struct record *rec, const unsigned char *const hidden[2])
{
	const size_t part = rec->levelled / LEVELS, n = lesser(part, FOLLOWING_BLOCK);
	double step[LEVELS], most = 0, error, mean;

	for (size_t k = 0; k < LEVELS; k++) {
		size_t from = k * part + (part - n) / 2;
		double a = following_measure(
			rec->y1 + from, hidden[0] ? hidden[0] + from : NULL, n);
		double b = following_measure(
			rec->y2 + from, hidden[1] ? hidden[1] + from : NULL, n);

		rec->level[k] = sqrt(a * b);
		if (!(rec->level[k] > 0))
			return 0;
	}
	mean = mean_of(rec->level, LEVELS);
	for (size_t k = 0; k < LEVELS; k++) {
		rec->level[k] /= mean;
		most = fmax(most, fabs(log(rec->level[k])));
		if (k > 0)
			step[k - 1] = fabs(log(rec->level[k] / rec->level[k - 1]));
	}
	/* of normal deviates the median modulus is 0.674 */
	error = robust_median(step, LEVELS - 1) / (0.674 * M_SQRT2);
	return most > SIGMAS_RARELY * fmax(error, following_error(2 * n));
}

/* Divides y[0 .. n) by the level, as of straight lines between the parts. */
static void divide_by_level(const struct record *rec, double *y, size_t n)
{
	for (size_t i = 0; i < n; i++) {
		double place = (double)(i * LEVELS) / (double)rec->levelled - 0.5;
		size_t k;

		place = fmin(fmax(place, 0), LEVELS - 1);
		k = (size_t)fmin(floor(place), LEVELS - 2);
		y[i] /= rec->level[k] +
			(place - (double)k) * (rec->level[k + 1] - rec->level[k]);
	}
}

/* Gives the noise one level: its spectrum and standard deviation are learned from all of
 * the record, not only from where it is low.  Not behind a known filter, where the fourth
 * difference does not tell the noise in its band. */
static void level_noise(struct record *rec, const struct calibration *c)
{
	const unsigned char *hidden[2] = { c->whitening.tap ? NULL : rec->par->hidden[0],
		c->whitening.tap ? NULL : rec->par->hidden[1] };

	rec->levelled = rec->n;
	if (!rec->par->filter && find_levels(rec, hidden)) {
		divide_by_level(rec, rec->y1, rec->n);
		divide_by_level(rec, rec->y2, rec->n);
	} else {
		for (int k = 0; k < LEVELS; k++)
			rec->level[k] = 1;
	}
}

static double variance(const double *x, size_t n)
{
	double mean = mean_of(x, n), sum = 0;

	for (size_t i = 0; i < n; i++)
		sum += (x[i] - mean) * (x[i] - mean);
	return sum / (double)n;
}

/* Range of the delays as far as it is known: that of plug flow, or a wider one if that is
 * asked for or events that are alike do not keep within it. */
static void set_range(const struct record *rec, const struct template *found, int wide,
	struct calibration *c)
{
	const struct calibrate_par *par = rec->par;
	double shift = (double)c->shift;
	double spread = isnan(par->spread)
				? calibration_plug(c)
				: calibration_reach(par->spread, shift, c->duration);
	double lo = 0, hi = 0;

	c->delta_min = -spread;
	c->delta_max = spread;
	if (!isnan(par->spread))
		return;
	for (int i = 0; found && i < found->events; i++) {
		lo = fmin(lo, found->t2[i] - found->t1[i]);
		hi = fmax(hi, found->t2[i] - found->t1[i]);
	}
	calibration_widen(c->duration, &lo, &hi);
	if (!wide && lo >= -spread && hi <= spread)
		return;
	spread = calibration_reach(CALIBRATE_WIDE, shift, c->duration);
	c->delta_min = fmin(-spread, lo);
	c->delta_max = fmax(spread, hi);
}

static void set_thresholds(const struct record *rec, struct calibration *c)
{
	double gain = c->gain * c->noise[0] / c->noise[1];

	c->threshold = calibrate_threshold(rec->par->false_alarm, c->shape, c->duration,
		gain, c->delta_max - c->delta_min);
	/* Next to a pulse the search covers some 40 cells: 23 gives 2e-3 false pulses. */
	c->threshold_near = c->threshold < 23 ? c->threshold : 23;
}

/* Correlation coefficient of y1 with y2 lag samples later. */
static double correlation_at(const double *y1, const double *y2, size_t n, size_t lag)
{
	double xy = dot(y1, y2 + lag, n - lag), xx = dot(y1, y1, n - lag),
	       yy = dot(y2 + lag, y2 + lag, n - lag);

	return xx > 0 && yy > 0 ? xy / sqrt(xx * yy) : 0;
}

static enum num_status measure_noise(const struct record *rec, struct calibration *c)
{
	const size_t n = rec->n, shift = (size_t)c->shift;

	if (c->whitening.tap && colour_level(rec->y1, rec->y2 + shift, n - shift,
					&c->whitening, c->noise) != NUM_OK)
		return NUM_MEMORY;
	for (int k = 0; k < 2; k++) {
		const double *y = k ? rec->y2 : rec->y1;
		double least = 1e-6 * sqrt(variance(y, n));

		if (!c->whitening.tap)
			c->noise[k] = robust_noise(y, rec->par->hidden[k], n, rec->work);
		if (!(c->noise[k] > least))
			c->noise[k] = least;
	}
	return NUM_OK;
}

static enum separate_status look_for_colour(const struct record *rec, struct look *look)
{
	enum num_status status = colour_power(rec->y1, rec->y2, rec->n, &look->noise);

	look->coloured = status == NUM_OK && !colour_is_white(&look->noise, 0);
	return status == NUM_MEMORY ? SEPARATE_MEMORY : SEPARATE_OK;
}

static enum separate_status find_lag(const struct record *rec, struct calibration *c)
{
	double lag = rec->par->lag, last = (double)rec->n - 16;
	enum num_status status;

	if (isnan(lag)) {
		status = align_lag(
			rec->y1, rec->y2, rec->n, rec->n / 2, &lag, &c->correlation);
		if (status != NUM_OK)
			return status == NUM_MEMORY ? SEPARATE_MEMORY : SEPARATE_NO_LAG;
	} else if (lag < last) {
		c->correlation =
			correlation_at(rec->y1, rec->y2, rec->n, (size_t)(lag + 0.5));
	}
	if (lag < 0)
		return SEPARATE_NO_LAG;
	if (!(lag < last))
		return isnan(rec->par->lag) ? SEPARATE_NO_LAG : SEPARATE_FAR;
	c->lag = lag;
	c->shift = (long)floor(lag + 0.5);
	c->transit = c->shift > 0 ? (double)c->shift : INFINITY;
	return SEPARATE_OK;
}

/* By how much the correlation at the transit time exceeds that at other lags.  In 150
 * records of noise without particles, coloured or with lines that wander, the ratio was
 * at most 1.44; in those of tests/matrix/scenes.tsv with particles, seeds 51001 to 51104,
 * at least 2.1. */
static const double ALONE = 1.7;

/* Range of the lags at which a line in the noise repeats its correlation, in lags of the
 * lowest autocorrelation, which are half periods of the line; a pulse is shorter. */
static const double NEAREST = 1.5, FARTHEST = 4;

/* Share of the transit time by which the fastest and the slowest particle may differ. */
static const double VARIES = 0.3;

/* *low: the lag at which the autocorrelation of both channels is lowest. */
static enum separate_status find_low(
	const struct record *rec, const double *y1, const double *y2, double *low)
{
	if (align_autocorrelation(y1, y2, rec->n, rec->n / 4, rec->work) != NUM_OK)
		return SEPARATE_MEMORY;
	*low = lowest_lag(rec->work, rec->n / 4);
	return SEPARATE_OK;
}

/* NARROW if a filter has left too little of the pulses, which are about twice as long as
 * the lag of their lowest autocorrelation. */
static enum separate_status check_band(
	const struct record *rec, const struct calibration *c)
{
	double low;
	enum separate_status status = SEPARATE_OK;

	if (!c->whitening.tap)
		return SEPARATE_OK;
	if (isnan(rec->par->duration))
		status = find_low(rec, rec->y1, rec->y2, &low);
	else
		low = 0.5 * rec->par->duration;
	if (status != SEPARATE_OK)
		return status;
	return (c->whitening.high - c->whitening.low) * 2 * low < NARROW ? SEPARATE_NARROW
									 : SEPARATE_OK;
}

/* NO_LAG if y1 correlates with a later y2 no more than channels of noise do, whatever its
 * spectrum: compared with other lags.  Regular trains of pulses, which repeat their
 * correlation farther away, have at least half of their power in common, as has noise at
 * few lags only if it has lines. */
static enum separate_status check_lag(const struct record *rec, const double *y1,
	const double *y2, const struct calibration *c)
{
	size_t n = rec->n;
	double lag = (double)c->shift, low, peak[2];
	struct align_range range[2];
	enum separate_status status = find_low(rec, y1, y2, &low);

	if (status != SEPARATE_OK)
		return status;
	range[0] = (struct align_range){ NEAREST * low, FARTHEST * low };
	range[1] = (struct align_range){ fmax(NEAREST * low, VARIES * lag), INFINITY };
	if (align_elsewhere(y1, y2, n, n / 2, lag, c->correlation < 0.5 ? 2 : 1, range,
		    peak) != NUM_OK)
		return SEPARATE_MEMORY;
	if (c->correlation < 0.5)
		peak[0] = fmax(peak[0], peak[1]);
	return c->correlation < ALONE * peak[0] ? SEPARATE_NO_LAG : SEPARATE_OK;
}

/* OK if y2 follows y1 by a lag at which they have more in common than c has. */
static enum separate_status follows(const struct record *rec, const double *y1,
	const double *y2, const struct calibration *c)
{
	struct calibration other = *c;
	double lag;
	enum num_status status =
		align_lag(y1, y2, rec->n, rec->n / 2, &lag, &other.correlation);

	if (status != NUM_OK)
		return status == NUM_MEMORY ? SEPARATE_MEMORY : SEPARATE_NO_LAG;
	if (lag < 1 || other.correlation <= c->correlation)
		return SEPARATE_NO_LAG;
	other.shift = (long)floor(lag + 0.5);
	return check_lag(rec, y1, y2, &other);
}

/* SWAPPED if particles seem to pass sensor 2 first.  Tested only if the lag found
 * explains less than half of the power of the channels. */
static enum separate_status find_reverse(
	const struct record *rec, const struct calibration *c)
{
	enum separate_status status;

	if (!isnan(rec->par->lag) || rec->par->in_order || c->correlation > 0.5)
		return SEPARATE_OK;
	status = follows(rec, rec->y2, rec->y1, c);
	return status == SEPARATE_OK       ? SEPARATE_SWAPPED
	       : status == SEPARATE_NO_LAG ? SEPARATE_OK
					   : status;
}

/* OPPOSITE if the channels have nothing in common, but would have if one were negated, at
 * the lag given if it is. */
static enum separate_status find_opposite(
	const struct record *rec, const struct calibration *c)
{
	struct calibration other = *c;
	enum separate_status status;

	other.correlation = -c->correlation;
	negate(rec->y2, rec->n);
	status = isnan(rec->par->lag) ? follows(rec, rec->y1, rec->y2, c)
				      : check_lag(rec, rec->y1, rec->y2, &other);
	negate(rec->y2, rec->n);
	return status == SEPARATE_OK ? SEPARATE_OPPOSITE : status;
}

/* Deviations of the noise above which the logarithm of a sample counts.  In 14 records in
 * which plain correlation finds no lag 1, 4 and 16 have 176, 205 and 102 particles found
 * rightly: impulses (3), turbulent flow (5) and laminar flow (6). */
static const double LOUD = 4;

/* y: m means of the logarithms of as many samples of x as box, less their mean. */
static void take_loudness(const double *x, double noise, size_t box, double *y, size_t m)
{
	double mean;

	for (size_t i = 0; i < m; i++) {
		y[i] = 0;
		for (size_t k = 0; k < box; k++)
			y[i] += asinh(x[i * box + k] / (LOUD * noise)) / (double)box;
	}
	mean = mean_of(y, m);
	for (size_t i = 0; i < m; i++)
		y[i] -= mean;
}

/* The lag at which the channels correlate where means of samples count by their
 * logarithm: small particles then tell as much of it as large ones, impulses little, and
 * delays that differ by less than a mean add up. */
static enum separate_status find_lag_by_means(
	const struct record *rec, size_t box, double *y, struct calibration *c)
{
	struct record means = *rec;
	struct calibration other = *c;
	enum separate_status status;

	means.n = rec->n / box;
	means.y1 = y;
	means.y2 = y + means.n;
	take_loudness(rec->y1, c->noise[0], box, means.y1, means.n);
	take_loudness(rec->y2, c->noise[1], box, means.y2, means.n);
	status = find_lag(&means, &other);
	if (status == SEPARATE_OK && other.shift == 0)
		status = SEPARATE_NO_LAG;
	if (status == SEPARATE_OK)
		status = check_lag(&means, means.y1, means.y2, &other);
	if (status == SEPARATE_OK) {
		c->correlation = other.correlation;
		c->lag = other.lag * (double)box;
		c->shift = other.shift * (long)box;
		c->transit = other.transit * (double)box;
	}
	return status;
}

/* The same, of single samples or, if they have no lag, of means of an eighth, a quarter
 * and a half of a pulse.  Of 31 records in turbulent and laminar flow three then have 18,
 * 8 and 28 more particles found rightly, the last of them by longer means than an eighth.
 */
static enum separate_status find_lag_by_all(
	const struct record *rec, struct calibration *c)
{
	static const double part[] = { 0, 0.25, 0.5, 1 };
	double low, *y = malloc(2 * rec->n * sizeof *y);
	enum separate_status status =
		y ? find_low(rec, rec->y1, rec->y2, &low) : SEPARATE_MEMORY;

	if (status == SEPARATE_OK)
		status = SEPARATE_NO_LAG;
	for (size_t k = 0; status == SEPARATE_NO_LAG && k < sizeof part / sizeof *part;
		k++)
		status = find_lag_by_means(rec, (size_t)fmax(part[k] * low, 1), y, c);
	free(y);
	return status;
}

/* Moves the second channel back by the lag. */
static void align(struct record *rec, const struct calibration *c)
{
	rec->y2 += c->shift;
	rec->n -= (size_t)c->shift;
}

/* Difference of the widths of both sensors' pulses that is not believed before pulses
 * are fitted.  In the first seeds of the 183 scenes of tests/matrix/scenes.tsv with equal
 * coils that are asserted by make check the guess differs by more in five: noise alone,
 * impulses, shocks and a strong baseline. */
static const double WIDTHS = 0.03;

/* First guess of the width of the pulses of sensor 2.  The autocorrelation of a sine ends
 * at twice the lag where it is lowest; other pulses have tails. */
static enum num_status find_width(const struct record *rec, struct calibration *c)
{
	enum num_status status =
		align_width(rec->y1, rec->y2, rec->n, 2.5 * rec->low, &c->width);

	if (fabs(log(c->width)) < WIDTHS)
		c->width = 1;
	return status;
}

static enum separate_status find_duration(
	struct record *rec, struct calibration *c, struct look *look)
{
	const struct calibrate_par *par = rec->par;
	double length = (double)rec->n + (double)c->shift;

	rec->low = look->lowest;
	if (!(rec->low > 0) && find_low(rec, rec->y1, rec->y2, &rec->low) != SEPARATE_OK)
		return SEPARATE_MEMORY;
	if (find_width(rec, c) != NUM_OK)
		return SEPARATE_MEMORY;
	if (!c->whitening.tap)
		look->low = rec->low;
	else if (look->coloured && look->kind == WHITEN_COLOURED)
		rec->low = look->low; /* whitening has changed the pulses */
	c->pulse = par->pulse == CALIBRATE_ANY_PULSE ? PULSE_SINE : par->pulse;
	c->duration = par->duration;
	if ((isnan(c->duration) &&
		    known_shape_duration(c->pulse, rec->low, &c->duration) != NUM_OK) ||
		known_shape_set(c, c->pulse) != NUM_OK)
		return SEPARATE_MEMORY;
	if (!(c->duration >= SHAPE_SHORTEST))
		return SEPARATE_FAST;
	if (isnan(par->lag) && (double)c->shift < CALIBRATE_APART * c->duration)
		return SEPARATE_AT_ONCE;
	return c->duration > 0.5 * length ? SEPARATE_SLOW : SEPARATE_OK;
}

/* First guess of the gain, from the power of each channel without its noise. */
static double first_gain(const struct record *rec, const struct calibration *c)
{
	double v1 = variance(rec->y1, rec->n) - c->noise[0] * c->noise[0];
	double v2 = variance(rec->y2, rec->n) - c->noise[1] * c->noise[1];

	return v1 > 0 && v2 > 0 ? sqrt(v2 / v1) : 1;
}

/* Divides everything by the noise. */
static void normalise(struct record *rec, struct calibration *c)
{
	double v1 = c->noise[0] * c->noise[0], v2 = c->noise[1] * c->noise[1];

	for (int k = 0; k < c->tones; k++)
		c->tone_power[k] /= v1;
	c->tone_variance = fmax(rec->lines.left[0] / v1, rec->lines.left[1] / v2);
	for (size_t i = 0; i < rec->n; i++) {
		rec->y1[i] /= c->noise[0];
		rec->y2[i] /= c->noise[1];
	}
}

/* Multiplies the assumed noise by s1 and s2. */
static void scale_noise(struct record *rec, struct calibration *c, double s1, double s2)
{
	c->noise[0] *= s1;
	c->noise[1] *= s2;
	for (size_t i = 0; i < rec->n; i++) {
		rec->y1[i] /= s1;
		rec->y2[i] /= s2;
	}
}

static enum separate_status learn(
	const struct record *rec, struct template *found, struct calibration *c)
{
	if (found && found->alone && !found->shape)
		return SEPARATE_NO_LAG;
	set_range(rec, found, rec->wide, c);
	set_thresholds(rec, c);
	return learn_pulse(rec->par, rec->y1, rec->y2, rec->n, rec->low, found, c);
}

static int is_known(const struct template *found)
{
	double near = found->events <= 2 * TEMPLATE_LEAST ? NEAR_OF_FEW : NEAR;

	/* With pulses of either sign, a known shape that is reversed takes too much work.
	 */
	return !(found->reversed && found->signs) && found->left < near;
}

/* Takes the pulse from the record if it is not given; a pulse of sensor.h that fits as
 * well has fewer parameters and is preferred, also one at another duration than the
 * guess, which foreign events may mislead. */
static enum separate_status find_template(
	const struct record *rec, struct template *found, struct calibration *c)
{
	const struct calibrate_par *par = rec->par;
	static const double factor[] = { 1, 0.5, 0.25, 0.125 };
	const unsigned char *hidden[2];

	learn_hidden(par, c, hidden);
	template_clear(found);
	if (par->pulse != CALIBRATE_ANY_PULSE || !isnan(par->duration))
		return SEPARATE_OK;
	found->events = 0;
	for (size_t k = 0; k < sizeof factor / sizeof *factor; k++) {
		double T = factor[k] * c->duration;
		double reach = calibration_reach(
			fmax(CALIBRATE_WIDE, par->spread), (double)c->shift, T);
		struct template other = { .alone = found->alone, .white = found->white };

		if (T < SHAPE_SHORTEST)
			break;
		if (template_find(&other, rec->y1, rec->y2, hidden, rec->n, T, c->transit,
			    c->width, reach, -1) != NUM_OK)
			return SEPARATE_MEMORY;
		other.elsewhere = k > 0;
		if (k > 0 && !(other.events > 0 && is_known(&other))) {
			template_clear(&other);
			continue;
		}
		template_clear(found);
		*found = other;
		if (found->events > 0 && is_known(found))
			break;
	}
	if (found->events > 0 && found->elsewhere)
		c->duration = found->duration;
	if (is_known(found) && !c->whitening.tap)
		template_clear(found);
	return SEPARATE_OK;
}

/* Finds out why the pulses do not fit, or whether pulses were taken for coloured noise.
 * There are too many of them if even in the quietest part both sensors record the same,
 * or the noise there has the expected level. */
static enum separate_status look_for_crowd(
	const struct record *rec, const struct calibration *c, int *dense)
{
	double level, coherence;

	if (matched_coherence(
		    c, rec->y1, rec->y2, rec->n, rec->work, &coherence, &level) != NUM_OK)
		return SEPARATE_MEMORY;
	*dense = coherence > 0.6 || (level < 1.5 && !c->whitening.tap);
	return SEPARATE_OK;
}

/* 1 if the lines, which changed faster than they were followed, leave more power than the
 * noise. */
static int lines_are_left(const struct calibration *c)
{
	return c->tones > 0 && isfinite(c->tone_variance) &&
	       c->tones * c->tone_variance > 1;
}

/* Otherwise neither the shape nor white noise describes the record: it was filtered.  The
 * noise is then measured behind the matched filter, with what lines leave. */
static enum separate_status learn_filtered(struct record *rec, struct calibration *c)
{
	double n1, n2;

	if (matched_noise(c, rec->y1, rec->n, rec->work, &n1) != NUM_OK ||
		matched_noise(c, rec->y2, rec->n, rec->work, &n2) != NUM_OK)
		return SEPARATE_MEMORY;
	c->lines_in_noise = lines_are_left(c);
	scale_noise(rec, c, n1, n2);
	c->misfit = FILTERED_MISFIT;
	return learn(rec, NULL, c);
}

static enum separate_status conclude(struct record *rec, struct calibration *c)
{
	enum separate_status status = SEPARATE_OK;

	if (c->events == 0 && isnan(rec->par->duration))
		return SEPARATE_NO_LAG;
	if (c->chi2 > BAD_FIT || (c->whitening.tap && !rec->par->filter))
		status = look_for_crowd(rec, c, &c->dense);
	if (c->dense)
		set_range(rec, NULL, 0, c);
	else if (status == SEPARATE_OK && c->chi2 > BAD_FIT && !c->whitening.tap &&
		 !c->presumed_white)
		status = learn_filtered(rec, c);
	set_thresholds(rec, c);
	return status;
}

int measure_white_above(const struct look *look, double duration)
{
	return colour_is_white(&look->noise, fmin(SHAPE_BAND / duration, 0.25));
}

/* Scales a pulse taken from a whitened record so that amplitudes are those of the
 * original record. */
static enum separate_status set_peak(const struct record *rec, const double *raw,
	const struct template *found, struct calibration *c)
{
	double *work = rec->work;
	struct tones_track track;
	enum separate_status status;

	memcpy(work, raw, rec->n * sizeof *work);
	status = find_lines_take(c, work, rec->n, &track);
	if (status == SEPARATE_OK) {
		divide_by_level(rec, work, rec->n);
		shape_scale(c->shape, c->noise[0] / template_peak(found, work, rec->n));
	}
	return status;
}

enum separate_status measure(struct look *look, const double *raw, double *y1, double *y2,
	size_t n, double *work, struct calibration *c)
{
	struct calibrate_par known = *look->par, *par = &known;
	const int first =
		look->first && par->pulse == CALIBRATE_ANY_PULSE && isnan(par->duration);
	struct record rec = {
		.par = par, .y1 = y1, .y2 = y2, .n = n, .work = work, .wide = look->wide
	};
	enum separate_status status = find_lines(par, y1, y2, n, work, c, &rec.lines);

	if (status == SEPARATE_OK) {
		level_noise(&rec, c);
		status = find_lag(&rec, c);
	}
	if (status == SEPARATE_OK && measure_noise(&rec, c) != NUM_OK)
		status = SEPARATE_MEMORY;
	if (status == SEPARATE_OK)
		status = check_band(&rec, c);
	if (status == SEPARATE_OK)
		status = find_reverse(&rec, c);
	if (status == SEPARATE_OK && !look->seen &&
		(isnan(par->duration) || isnan(par->lag))) {
		status = check_lag(&rec, y1, y2, c);
		if (status == SEPARATE_NO_LAG && isnan(par->lag))
			status = find_lag_by_all(&rec, c);
	}
	if (status == SEPARATE_NO_LAG)
		status = find_opposite(&rec, c);
	if (status != SEPARATE_OK)
		return status;
	align(&rec, c);
	if (c->shift >
		0) /* the duration of c is that of a transit time of whole samples */
		known.duration *= (double)c->shift / c->lag;
	status = find_duration(&rec, c, look);
	if (status != SEPARATE_OK)
		return status;
	c->gain = isnan(par->gain) ? first_gain(&rec, c) : par->gain;
	c->misfit = isinf(c->transit) ? UNKNOWN_MISFIT : 0;
	normalise(&rec, c);
	look->wander = rec.lines.drift / (c->noise[0] * c->noise[0]);
	if (!c->whitening.tap) {
		status = look_for_colour(&rec, look);
		c->presumed_white = look->coloured;
	}
	/* Pulses of any shape would be fitted to the drift. */
	if (status == SEPARATE_OK && look->first && look->noise.drift > 0 &&
		!c->whitening.tap)
		return SEPARATE_COLOURED;
	look->found.alone = first && c->whitening.tap && !(look->noise.drift > 0);
	look->found.white = c->whitening.tap || !look->coloured ||
			    measure_white_above(look, c->duration);
	if (status == SEPARATE_OK && (first || !c->whitening.tap))
		status = find_template(&rec, &look->found, c);
	if (status == SEPARATE_OK && first && look->coloured &&
		(!c->whitening.tap || look->found.events == 0) &&
		!measure_white_above(look, c->duration))
		status = SEPARATE_COLOURED;
	else if (status == SEPARATE_OK && look->found.events < look->events)
		status = SEPARATE_NO_LAG;
	look->effort->attempts += status == SEPARATE_OK;
	if (status == SEPARATE_OK)
		status = learn(&rec, &look->found, c);
	if (status == SEPARATE_OK && c->measured && c->whitening.tap)
		status = set_peak(&rec, raw, &look->found, c);
	template_clear(&look->found);
	return status == SEPARATE_OK ? conclude(&rec, c) : status;
}
