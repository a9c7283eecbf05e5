/* matched.c - see matched.h */
#include "signal/learn/matched.h"
#include "num/robust.h"
#include <math.h>
#include <stdlib.h>

/* Matched filter of y[0 .. n) at every eighth of a duration, or at every sample of
 * shorter pulses, at *points points: at most n. */
static enum num_status filter_points(const struct calibration *c, const double *y,
	size_t n, double *out, size_t *points)
{
	double T = c->duration;
	size_t len, count = 0, stride = (size_t)fmax(T / 8, 1);
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
	*points = count;
	return p ? NUM_OK : NUM_MEMORY;
}

enum num_status matched_coherence(const struct calibration *c, const double *y1,
	const double *y2, size_t n, double *r, double *coherence, double *level)
{
	enum { BLOCK = 16 }; /* points: two durations */
	double *z = malloc(2 * n * sizeof *z), xy = 0, xx = 0, yy = 0, limit, count = 0;
	size_t points, second, blocks;

	*coherence = *level = 0;
	if (!z || filter_points(c, y1, n, z, &points) != NUM_OK ||
		filter_points(c, y2, n, z + n, &second) != NUM_OK) {
		free(z);
		return NUM_MEMORY;
	}
	blocks = points / BLOCK;
	for (size_t b = 0; b < blocks; b++) {
		r[b] = 0;
		for (size_t i = b * BLOCK; i < (b + 1) * BLOCK; i++)
			r[b] += z[i] * z[i] + z[n + i] * z[n + i];
		r[blocks + b] = r[b];
	}
	limit = robust_quantile(r, blocks, 0.1);
	for (size_t b = 0; b < blocks; b++)
		for (size_t i = b * BLOCK; r[blocks + b] <= limit && i < (b + 1) * BLOCK;
			i++) {
			xy += z[i] * z[n + i];
			xx += z[i] * z[i];
			yy += z[n + i] * z[n + i];
			count += 2;
		}
	*level =
		count > 0
			? sqrt((xx + yy) / count / (c->duration * shape_energy(c->shape)))
			: 0;
	free(z);
	if (xx > 0 && yy > 0)
		*coherence = xy / sqrt(xx * yy);
	return NUM_OK;
}

enum num_status matched_noise(const struct calibration *c, const double *y, size_t n,
	double *work, double *noise)
{
	size_t count;

	if (filter_points(c, y, n, work, &count) != NUM_OK)
		return NUM_MEMORY;
	*noise = count ? robust_scale(work, count) /
				 sqrt(c->duration * shape_energy(c->shape))
		       : 1;
	return NUM_OK;
}
