/* campbell.c - see campbell.h */
#include "signal/detect/campbell.h"
#include "num/dot.h"
#include "num/periodogram.h"
#include "num/sigmas.h"
#include "num/status.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Stretches of the jackknife, at most and at least, and the durations that each lasts
 * where there are more than the least: dependent ones would make the errors too small. */
enum { STRETCHES = 32, FEW = 8, APART = 4 };

/* Bands of the spectrum at most, and the durations that a stretch lasts for each.  Of 3,
 * 6 and 12, 3 shows a line with half of the power of the pulses the best in a stretch of
 * 33 durations: unlike is .47 to .67 for the three known shapes, not .23 to .36 or .10;
 * chance leaves .10 to .15, not .08 to .12 or .07 to .09. */
enum { BANDS = 64, LONG = 3 };

/* Sums of powers 1 to 4 of both channels over one stretch. */
struct sums {
	double n, power[2][4];
};

static void add(struct sums *to, const struct sums *from, double sign)
{
	to->n += sign * from->n;
	for (int c = 0; c < 2; c++)
		for (int k = 0; k < 4; k++)
			to->power[c][k] += sign * from->power[c][k];
}

static struct sums sum_stretch(
	const double *y1, const double *y2, size_t begin, size_t end)
{
	struct sums s = { 0 };

	s.n = (double)(end - begin);
	for (size_t i = begin; i < end; i++)
		for (int c = 0; c < 2; c++) {
			double y = c ? y2[i] : y1[i], square = y * y;

			s.power[c][0] += y;
			s.power[c][1] += square;
			s.power[c][2] += square * y;
			s.power[c][3] += square * square;
		}
	return s;
}

/* Both cumulants, turned into rate E[a^2] and rate E[a^4], mean of the channels. */
static void moments(const struct sums *s, double unit2, double unit4, double gain,
	double *square, double *fourth)
{
	*square = *fourth = 0;
	for (int c = 0; c < 2; c++) {
		double g2 = c ? gain * gain : 1, mean = s->power[c][0] / s->n;
		double m2 = s->power[c][1] / s->n, m3 = s->power[c][2] / s->n;
		double m4 = s->power[c][3] / s->n, k2 = m2 - mean * mean;
		double k4 = m4 - 4 * mean * m3 + 6 * mean * mean * m2 -
			    3 * mean * mean * mean * mean - 3 * k2 * k2;

		*square += 0.5 * (k2 - 1) / (g2 * unit2);
		*fourth += 0.5 * k4 / (g2 * g2 * unit4);
	}
}

/* The pulse at STEPS samples per duration, as far as it reaches; NULL: no memory. */
enum { STEPS = 32 };
static double *sample_pulse(const struct shape *shape, size_t *points)
{
	int half = (int)ceil(shape_reach(shape) * STEPS);
	double *p = calloc(*points = 2 * (size_t)half + 1, sizeof *p);

	if (p)
		shape_sample(shape, half, STEPS, 0, *points, p, NULL, NULL);
	return p;
}

/* Variance of the fourth cumulant, over the fourth power of the second, of a duration of
 * shot noise with 1 / x pulses of one height per duration (x = 0: Gaussian noise).  That
 * of n samples is n / duration times smaller.  It is a polynomial of x, of which the
 * coefficients are filled.  With k(a, b) the joint cumulant of a and b times two samples,
 * it is
 *
 *	sum of k(4, 4) + 16 k(3, 3) k(1, 1) + 18 k(2, 2)^2 + 16 k(1, 3) k(3, 1)
 *		+ 72 k(2, 2) k(1, 1)^2 + 24 k(1, 1)^4
 *
 * over all lags (Fisher, Proc. London Math. Soc. 30, 1929, for independent samples; terms
 * of odd order vanish or compensate). */
static enum num_status fourth_variance(const struct shape *shape, double coefficient[4])
{
	size_t points;
	double *p = sample_pulse(shape, &points), scale;

	memset(coefficient, 0, 4 * sizeof *coefficient);
	if (!p)
		return NUM_MEMORY;
	scale = 1 / sqrt(dot(p, p, points) / STEPS);
	for (size_t i = 0; i < points; i++)
		p[i] *= scale;
	for (size_t lag = 0; lag < points; lag++) {
		double k11 = 0, k22 = 0, k33 = 0, k44 = 0, k13 = 0, k31 = 0;
		double weight = (lag ? 2. : 1.) / STEPS;

		for (size_t i = lag; i < points; i++) {
			double x = p[i], y = p[i - lag], xy = x * y / STEPS;

			k11 += xy;
			k22 += xy * x * y;
			k13 += xy * y * y;
			k31 += xy * x * x;
			k33 += xy * x * y * x * y;
			k44 += xy * x * y * x * y * x * y;
		}
		coefficient[0] += weight * 24 * k11 * k11 * k11 * k11;
		coefficient[1] += weight * 72 * k22 * k11 * k11;
		coefficient[2] +=
			weight * (16 * k33 * k11 + 18 * k22 * k22 + 16 * k13 * k31);
		coefficient[3] += weight * k44;
	}
	free(p);
	return NUM_OK;
}

/* Least standard error of the fourth cumulant of this estimate, in its units: what shot
 * noise gives it at the estimate and this error, since the fewer large pulses happened to
 * be seen, the smaller is the estimate.  The jackknife does not see that. */
static double least_error(const struct shape *shape, double duration, size_t n,
	double unit2, double unit4, const struct campbell *c)
{
	double square = fmax(c->square, 0), scale = pow(square * unit2, 2) / unit4, e = 0;
	double k[4];

	if (fourth_variance(shape, k) != NUM_OK)
		return INFINITY;
	for (int step = 0; step < 2 && square > 0; step++) {
		double x = (fmax(c->fourth, 0) + e) / (square * square * duration);
		double var = k[0] + x * (k[1] + x * (k[2] + x * k[3]));

		e = scale * sqrt(var * duration / (double)n);
	}
	return e;
}

void campbell_estimate(const double *y1, const double *y2, size_t n,
	const struct shape *shape, double duration, double gain, struct campbell *c)
{
	double unit2 = duration * shape_energy(shape),
	       unit4 = duration * shape_fourth(shape);
	double part[STRETCHES][4], mean[4] = { 0 }, var[4] = { 0 }, factor, least;
	struct sums all = { 0 }, each[STRETCHES];
	int parts = (int)fmin(fmax((double)n / (APART * duration), FEW), STRETCHES);

	for (int k = 0; k < parts; k++) {
		each[k] = sum_stretch(y1, y2, n * (size_t)k / (size_t)parts,
			n * (size_t)(k + 1) / (size_t)parts);
		add(&all, &each[k], 1);
	}
	moments(&all, unit2, unit4, gain, &c->square, &c->fourth);
	c->rate = c->fourth > 0 ? c->square * c->square / c->fourth : NAN;
	c->amplitude = c->fourth > 0 && c->square > 0 ? sqrt(c->fourth / c->square) : NAN;
	for (int k = 0; k < parts; k++) {
		struct sums rest = all;

		add(&rest, &each[k], -1);
		moments(&rest, unit2, unit4, gain, &part[k][0], &part[k][1]);
		part[k][2] = part[k][0] * part[k][0] / part[k][1];
		part[k][3] = sqrt(part[k][1] / part[k][0]);
		for (int i = 0; i < 4; i++)
			mean[i] += part[k][i] / parts;
	}
	for (int k = 0; k < parts; k++)
		for (int i = 0; i < 4; i++)
			var[i] += (part[k][i] - mean[i]) * (part[k][i] - mean[i]);
	factor = (double)n < FEW * APART * duration ? INFINITY
						    : sqrt((parts - 1.0) / parts);
	c->square_se = factor * sqrt(var[0]);
	least = least_error(shape, duration, n, unit2, unit4, c);
	c->fourth_se = fmax(factor * sqrt(var[1]), least);
	least /= c->fourth;
	c->rate_se = fmax(factor * sqrt(var[2]), least * c->rate);
	c->amplitude_se = fmax(factor * sqrt(var[3]), 0.5 * least * c->amplitude);
	c->unlike = 0;
}

/* Power of a band, of the record beyond its noise and of one pulse, and the variance of
 * the former. */
struct band {
	double record, pulse, var;
};

/* Power of the pulses that makes that of all bands the same. */
static double common_rate(const struct band *band, int bands)
{
	double record = 0, pulse = 0;

	for (int b = 0; b < bands; b++) {
		record += band[b].record;
		pulse += band[b].pulse;
	}
	return record / pulse;
}

static double difference(const struct band *band, int bands, double rate)
{
	double square = 0, pulse = 0;

	for (int b = 0; b < bands; b++) {
		double expected = rate * band[b].pulse, off = band[b].record - expected;

		pulse += expected;
		if (expected > 0)
			square += (off * off - band[b].var) / expected;
	}
	return rate > 0 ? sqrt(fmax(square / pulse, 0)) : INFINITY;
}

void campbell_compare(const double *y1, const double *y2, size_t n,
	const struct shape *shape, double duration, double gain, struct campbell *c)
{
	size_t size = fft_good_size(n), bins = size / 2 + 1;
	struct periodogram *sum =
		(double)n < FEW * APART * duration ? NULL : periodogram_new(size);
	double *power = calloc(2 * bins + n, sizeof *power);
	struct band band[BANDS] = { 0 };
	double both = 0.5 * (1 + gain * gain), all = 0, below = 0;
	int bands = (int)fmin((double)n / (LONG * duration), BANDS);

	c->unlike = INFINITY;
	if (sum && power) {
		double *pulse = power + bins, *p = pulse + bins;

		shape_sample(shape, 0.5 * (double)n, duration, 0, n, p, NULL, NULL);
		periodogram_add_hann(sum, y1, n, 1 / HANN_SQUARE, power, bins);
		periodogram_add_hann(sum, y2, n, 1 / HANN_SQUARE, power, bins);
		/* in the middle of the window */
		periodogram_add_hann(sum, p, n, 1, pulse, bins);
		for (size_t k = 1; k < bins; k++)
			all += pulse[k];
		for (size_t k = 1; k < bins && below < all; below += pulse[k++]) {
			struct band *b = &band[(int)(bands * below / all)];
			double mean = 0.5 * power[k] / (double)n;

			b->record += mean - 1;
			b->pulse += both * pulse[k];
			/* of one periodogram, which both channels share, */
			b->var += mean * mean;
		}
		/* whose neighbours the window makes dependent */
		for (int k = 0; k < bands; k++)
			band[k].var *= 0.5 * 35. / 18;
		c->unlike = difference(band, bands, common_rate(band, bands));
	}
	periodogram_free(sum);
	free(power);
	/* An amplitude has half of the relative error of its square. */
	c->square_se = hypot(c->square_se, c->unlike * c->square);
	c->fourth_se = hypot(c->fourth_se, 2 * c->unlike * c->fourth);
	c->rate_se = hypot(c->rate_se, c->unlike * c->rate);
	c->amplitude_se = hypot(c->amplitude_se, 0.5 * c->unlike * c->amplitude);
}

/* How far the correlation of the pulse with itself falls below 0 at any lag. */
static double opposition(const struct shape *shape)
{
	size_t points;
	double *p = sample_pulse(shape, &points), energy, least = 0;

	if (!p)
		return 1;
	energy = dot(p, p, points);
	for (size_t lag = 1; lag < points; lag++)
		least = fmin(least, dot(p, p + lag, points - lag) / energy);
	free(p);
	return -least;
}

double campbell_most(
	const double *y, size_t n, const struct shape *shape, double duration)
{
	double square = dot(y, y, n), noise = (double)n;
	double energy = fmax(square - noise, 0);
	/* of the noise, and of its product with what is in it */
	double error = sqrt(2 * noise + 4 * energy);

	return (square - noise + SIGMAS_SELDOM * error) /
	       ((1 - opposition(shape)) * duration * shape_energy(shape));
}

void campbell_scale(struct campbell *c, double unit, double rate)
{
	double square = unit * unit;

	c->square *= square * rate;
	c->square_se *= square * rate;
	c->fourth *= square * square * rate;
	c->fourth_se *= square * square * rate;
	c->rate *= rate;
	c->rate_se *= rate;
	c->amplitude *= unit;
	c->amplitude_se *= unit;
}
