/* align.c - see align.h */
#include "signal/detect/align.h"
#include "num/dot.h"
#include "num/fft.h"
#include "num/parabola.h"
#include <math.h>
#include <string.h>

/* The least one >= n: lags are searched in parts of many lengths, and the plan of a
 * transform of another length takes longer than the transform. */
static size_t power_of_two(size_t n)
{
	size_t power = 1;

	while (power < n)
		power *= 2;
	return power;
}

/* Correlation sum_n x(n) y(n + lag) at lags 0 .. max_lag. */
static enum num_status correlate(
	const double *x, const double *y, size_t n, size_t max_lag, double *r)
{
	const size_t size = power_of_two(n + max_lag + 1);
	struct fft *fft = fft_new(size, 1);
	double *pad = fft_alloc(size);
	double complex *fx = fft_alloc_complex(size / 2 + 1);
	double complex *fy = fft_alloc_complex(size / 2 + 1);
	enum num_status status = fft && pad && fx && fy ? NUM_OK : NUM_MEMORY;

	if (status == NUM_OK) {
		memcpy(pad, x, n * sizeof *x);
		fft_forward(fft, pad, fx);
		memset(pad, 0, size * sizeof *pad);
		memcpy(pad, y, n * sizeof *y);
		fft_forward(fft, pad, fy);
		for (size_t k = 0; k <= size / 2; k++)
			fy[k] *= conj(fx[k]) / (double)size;
		fft_inverse(fft, fy, pad);
		memcpy(r, pad, (max_lag + 1) * sizeof *r);
	}
	fft_free(pad);
	fft_free(fx);
	fft_free(fy);
	fft_done(fft);
	return status;
}

/* The correlation at lags 0 .. *max_lag, which becomes less than n, in units of *scale;
 * NULL with *status where there is none. */
static double *correlate_channels(const double *y1, const double *y2, size_t n,
	size_t *max_lag, double *scale, enum num_status *status)
{
	double e1 = dot(y1, y1, n), e2 = dot(y2, y2, n), *r;

	if (*max_lag >= n)
		*max_lag = n - 1;
	*scale = sqrt(e1 * e2);
	*status = NUM_DOMAIN;
	if (e1 == 0 || e2 == 0)
		return NULL;
	r = fft_alloc(*max_lag + 1);
	*status = r ? correlate(y1, y2, n, *max_lag, r) : NUM_MEMORY;
	if (*status == NUM_OK)
		return r;
	fft_free(r);
	return NULL;
}

enum num_status align_lag(const double *y1, const double *y2, size_t n, size_t max_lag,
	double *lag, double *peak)
{
	double scale;
	enum num_status status;
	double *r = correlate_channels(y1, y2, n, &max_lag, &scale, &status);
	size_t best = 0;

	if (!r)
		return status;
	for (size_t k = 1; k <= max_lag; k++)
		if (r[k] > r[best])
			best = k;
	*lag = (double)best;
	*peak = r[best] / scale;
	if (best > 0 && best < max_lag)
		*lag += parabola_top(r[best - 1], r[best], r[best + 1]);
	fft_free(r);
	return NUM_OK;
}

enum num_status align_elsewhere(const double *y1, const double *y2, size_t n,
	size_t max_lag, double lag, int ranges, const struct align_range *range,
	double *peak)
{
	double scale;
	enum num_status status;
	double *r = correlate_channels(y1, y2, n, &max_lag, &scale, &status);

	if (!r)
		return status;
	for (int i = 0; i < ranges; i++) {
		peak[i] = 0;
		for (size_t k = 0; k <= max_lag; k++) {
			double apart = fabs((double)k - lag);

			if (apart > range[i].more && apart <= range[i].most)
				peak[i] = fmax(peak[i], fabs(r[k]) / scale);
		}
	}
	fft_free(r);
	return NUM_OK;
}

enum num_status align_autocorrelation(
	const double *y1, const double *y2, size_t n, size_t max_lag, double *r)
{
	double *part = fft_alloc(max_lag + 1);
	enum num_status status = part ? correlate(y1, y1, n, max_lag, r) : NUM_MEMORY;

	if (status == NUM_OK)
		status = correlate(y2, y2, n, max_lag, part);
	for (size_t k = 0; status == NUM_OK && k <= max_lag; k++)
		r[k] += part[k];
	fft_free(part);
	return status;
}

double lowest_lag(const double *r, size_t max_lag)
{
	size_t low = 1;

	for (size_t k = 2; k <= max_lag; k++) {
		if (r[k] < r[low])
			low = k;
		else if (r[low] < 0 && r[k] > 0.5 * r[low])
			break;
	}
	return low < max_lag && r[low] < 0 ? (double)low : 0;
}

/* Correlation coefficient of a at lags 1 to most and b at lags w times as long. */
static double likeness(const double *a, const double *b, size_t most, double w)
{
	double x = 0, y = 0, xx = 0, yy = 0, xy = 0, n = (double)most;

	for (size_t k = 1; k <= most; k++) {
		double at = w * (double)k, u = at - floor(at);
		size_t i = (size_t)at;
		double v = (1 - u) * b[i] + u * b[i + 1];

		x += a[k];
		y += v;
		xx += a[k] * a[k];
		yy += v * v;
		xy += a[k] * v;
	}
	return (xy - x * y / n) / sqrt((xx - x * x / n) * (yy - y * y / n));
}

enum num_status align_width(
	const double *y1, const double *y2, size_t n, double most, double *width)
{
	enum { STEPS = 100 };
	size_t lags = (size_t)most, all = (size_t)(2 * most) + 2;
	double *r, best = -1;
	enum num_status status;

	*width = 1;
	if (lags < 2 || all >= n)
		return NUM_OK;
	r = fft_alloc(2 * (all + 1));
	status = r ? correlate(y1, y1, n, all, r) : NUM_MEMORY;
	if (status == NUM_OK)
		status = correlate(y2, y2, n, all, r + all + 1);
	/* from 1/2 to 2 */
	for (int k = -STEPS; status == NUM_OK && k <= STEPS; k++) {
		double w = exp2((double)k / STEPS);
		double here = likeness(r, r + all + 1, lags, w);

		if (here > best) {
			best = here;
			*width = w;
		}
	}
	fft_free(r);
	return status;
}
