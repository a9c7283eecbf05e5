/* start.c - see start.h */
#include "signal/start.h"
#include "num/fft.h"
#include <math.h>
#include <stdlib.h>

/* Deviations of a clear pulse, of one that counts as much as any, and of the lag's peak.
 */
static const double CLEAR = 6, LIMIT = 10, PEAK = 3;

/* Lags of a regular train recur: the least of those that do as well to this share holds.
 */
static const double AS_GOOD = 0.85;

/* Lags within this share of a duration are no transit. */
static const double TOGETHER = 0.6;

struct bank {
	size_t n, size;
	struct fft *fft;
	double complex *y[2], *part;
	double *z[2];
};

static void bank_clear(struct bank *b)
{
	for (int c = 0; c < 2; c++) {
		fft_free(b->y[c]);
		fft_free(b->z[c]);
	}
	fft_free(b->part);
	fft_done(b->fft);
}

static int bank_start(struct bank *b, const double *y1, const double *y2, size_t n)
{
	size_t bins;

	*b = (struct bank){ .n = n, .size = fft_good_size(2 * n) };
	b->size += b->size % 2;
	bins = b->size / 2 + 1;
	b->fft = fft_new(b->size, 1);
	b->part = fft_alloc_complex(bins);
	for (int c = 0; c < 2; c++) {
		b->y[c] = fft_alloc_complex(bins);
		b->z[c] = fft_alloc(b->size);
	}
	if (!b->fft || !b->part || !b->y[0] || !b->y[1] || !b->z[0] || !b->z[1])
		return 0;
	for (int c = 0; c < 2; c++) {
		for (size_t i = 0; i < b->size; i++)
			b->z[c][i] = i < n ? (c ? y2 : y1)[i] : 0;
		fft_forward(b->fft, b->z[c], b->y[c]);
	}
	return 1;
}

/* Matched filter of both channels for sine pulses of duration T, in deviations. */
static void bank_filter(struct bank *b, double T)
{
	double norm = sqrt(2 / T) / (double)b->size;
	double *p = b->z[0];

	for (size_t i = 0; i < b->size; i++)
		p[i] = 0;
	for (long i = (long)(-T / 2); i <= (long)(T / 2); i++)
		p[i < 0 ? (long)b->size + i : i] = -sin(2 * M_PI * (double)i / T) * norm;
	fft_forward(b->fft, p, b->part);
	for (int c = 1; c >= 0; c--) {
		double complex *product = fft_alloc_complex(b->size / 2 + 1);

		for (size_t k = 0; product && k <= b->size / 2; k++)
			product[k] = b->y[c][k] * conj(b->part[k]);
		if (product)
			fft_inverse(b->fft, product, b->z[c]);
		fft_free(product);
	}
}

/* Energy beyond what is clear of the largest values, each alone within two durations:
 * more of one pulse would speak for durations that are too short. */
static double gathered(const double *z, size_t n, double T)
{
	double sum = 0, top = 0;
	size_t at = 0;

	for (size_t i = 0; i < n; i++) {
		double here = fabs(z[i]);

		if (top > 0 && (double)(i - at) > 2 * T) {
			sum += top * top - CLEAR * CLEAR;
			top = 0;
		}
		if (here > CLEAR && here > top) {
			top = here;
			at = i;
		}
	}
	return sum + (top > 0 ? top * top - CLEAR * CLEAR : 0);
}

static double try_duration(struct bank *b, double T)
{
	bank_filter(b, T);
	return gathered(b->z[0], b->n, T) + gathered(b->z[1], b->n, T);
}

/* Steps of a half, then of a fifth and a tenth. */
static double find_duration(struct bank *b)
{
	static const double finer[] = { 1.22, 1.1, 1.05 };
	double best = 0, most = 0;

	for (double T = 6; T < (double)b->n / 4; T *= 1.5) {
		double here = try_duration(b, T);

		if (here > most) {
			most = here;
			best = T;
		}
	}
	for (int k = 0; k < 3 && best > 0; k++) {
		double middle = best;

		for (int side = 0; side < 2; side++) {
			double T = side ? middle * finer[k] : middle / finer[k];
			double here = try_duration(b, T);

			if (here > most) {
				most = here;
				best = T;
			}
		}
	}
	return best;
}

/* Lag of the lowest autocorrelation before it clearly rises, as the duration of a sine
 * pulse that has its there. */
static double least_like_itself(struct bank *b)
{
	enum { SINE = 100 };
	size_t low = 1;
	double least = 0, sine = 1;

	for (size_t k = 0; k <= b->size / 2; k++)
		b->part[k] =
			b->y[0][k] * conj(b->y[0][k]) + b->y[1][k] * conj(b->y[1][k]);
	fft_inverse(b->fft, b->part, b->z[0]);
	for (size_t k = 2; k < b->n / 4; k++) {
		if (b->z[0][k] < b->z[0][low])
			low = k;
		else if (b->z[0][low] < 0 && b->z[0][k] > 0.5 * b->z[0][low])
			break;
	}
	for (int k = 1; k < SINE; k++) {
		double r = 0;

		for (int i = 0; i + k < SINE; i++)
			r += sin(2 * M_PI * i / SINE) * sin(2 * M_PI * (i + k) / SINE);
		if (r < least) {
			least = r;
			sine = (double)k / SINE;
		}
	}
	return b->z[0][low] < 0 ? (double)low / sine : find_duration(b);
}

/* Correlation of the trains of clear pulses, in z[0]: lag k at k, -k at size - k. */
static void correlate_trains(struct bank *b, double T)
{
	double complex *other = fft_alloc_complex(b->size / 2 + 1);

	bank_filter(b, T);
	for (int c = 0; c < 2; c++)
		for (size_t i = 0; i < b->size; i++) {
			double z = b->z[c][i];

			b->z[c][i] = i >= b->n || fabs(z) < CLEAR
					     ? 0
					     : fmax(fmin(z, LIMIT), -LIMIT);
		}
	if (other) {
		fft_forward(b->fft, b->z[0], b->part);
		fft_forward(b->fft, b->z[1], other);
		for (size_t k = 0; k <= b->size / 2; k++)
			other[k] *= conj(b->part[k]);
		fft_inverse(b->fft, other, b->z[0]);
	}
	fft_free(other);
}

/* The largest of lags from lo to hi but for those nearer to 0 than least. */
static long largest(const struct bank *b, long lo, long hi, double least)
{
	long best = 0;
	double most = -1;

	for (long k = lo; k <= hi; k++) {
		double here = fabs(b->z[0][k < 0 ? (long)b->size + k : k]);

		if (fabs((double)k) >= least && here > most) {
			most = here;
			best = k;
		}
	}
	return best;
}

static double value(const struct bank *b, long lag)
{
	return b->z[0][lag < 0 ? (long)b->size + lag : lag];
}

/* The lag that stands out; positive if one that does is. */
static long choose_lag(const struct bank *b, long range, double T)
{
	long least = (long)ceil(TOGETHER * T);
	long best = largest(b, -range, range, (double)least);
	double most = fabs(value(b, best));

	for (long k = least; k <= range; k++)
		if (fabs(value(b, k)) >= AS_GOOD * most)
			return largest(b, k, k + (long)T, 0);
	return best;
}

static double rms_elsewhere(const struct bank *b, long lag, double T, long range)
{
	double sum = 0, count = 0;

	for (long k = -range; k <= range; k++)
		if (fabs((double)(k - lag)) > T && fabs((double)k) > T) {
			double here = b->z[0][k < 0 ? (long)b->size + k : k];

			sum += here * here;
			count++;
		}
	return sqrt(sum / fmax(count, 1));
}

static void find_lag(struct bank *b, double known, struct start *s)
{
	long range = (long)b->n / 2;
	double T = s->duration, rms;

	correlate_trains(b, T);
	if (isnan(known)) {
		s->lag = choose_lag(b, range, T);
	} else {
		double near = fmax(0.1 * known, 0.25 * T);

		s->lag = largest(b, (long)(known - near), (long)(known + near), 0);
	}
	rms = rms_elsewhere(b, s->lag, T, range);
	s->score = fabs(value(b, s->lag)) / fmax(rms, 1e-300);
	if (value(b, s->lag) == 0)
		s->score = 0;
	if (isnan(known)) {
		long none = largest(b, (long)(-TOGETHER * T), (long)(TOGETHER * T), 0);

		if (s->score < PEAK || fabs(value(b, none)) > 2 * fabs(value(b, s->lag))) {
			s->lag = none;
			s->score = fabs(value(b, none)) / fmax(rms, 1e-300);
			s->together = 1;
		}
	}
	s->sign = value(b, s->lag) < 0 ? -1 : 1;
	if (!isnan(known))
		s->lag = (long)floor(known + 0.5);
	else if (!(s->score >= PEAK) || value(b, s->lag) == 0)
		s->score = 0;
}

int start_find(const double *y1, const double *y2, size_t n, double duration, double lag,
	int crowded, struct start *s)
{
	struct bank b;
	int ok = bank_start(&b, y1, y2, n);

	*s = (struct start){ .sign = 1 };
	if (ok) {
		s->duration = !isnan(duration) ? duration
			      : crowded        ? least_like_itself(&b)
					       : find_duration(&b);
		if (s->duration > 0)
			find_lag(&b, lag, s);
	}
	bank_clear(&b);
	return ok;
}
