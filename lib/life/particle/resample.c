/* resample.c - see resample.h */
#include "life/particle/resample.h"
#include <math.h>
#include <string.h>

/* Point k of n in (0, 1), ascending: one in each of n equal intervals, or independent
 * ones in sorted order, of which above is the distance of the last one from 1. */
static double point_of(
	enum resampling scheme, struct draw *draw, size_t k, size_t n, double *above)
{
	double u = draw_uniform(draw);

	if (scheme == RESAMPLE_STRATIFIED)
		return ((double)k + u) / (double)n;
	*above *= exp(log(u) / (double)(n - k));
	return 1 - *above;
}

/* Compares points in [0, sum) with the running sum of the weights, without those of the
 * copies that are kept before.  The ancestor of a particle is the number of those whose
 * last copy lies before it; these are counted and summed without a branch, which would be
 * mispredicted. */
void resample(enum resampling scheme, struct draw *draw, const double *weight, double sum,
	size_t n, uint32_t *ancestor)
{
	int comb = scheme == RESAMPLE_SYSTEMATIC; /* point k is k + offset */
	double unit = sum / (double)n, scale = 1 / unit, reached = 0, above = 1,
	       offset = comb ? draw_uniform(draw) : 0, point;
	size_t kept = 0, drawn = 0, points = n, copies = 0;
	uint32_t ended = 0;

	for (size_t i = 0; i < n && scheme == RESAMPLE_RESIDUAL; i++) {
		points -= copies = (size_t)(weight[i] * scale);
		sum -= (double)copies * unit;
	}
	point = comb || points == 0 ? 0 : point_of(scheme, draw, 0, points, &above);
	memset(ancestor, 0, n * sizeof *ancestor);
	for (size_t i = 0; i + 1 < n; i++) {
		size_t end;

		copies = scheme == RESAMPLE_RESIDUAL ? (size_t)(weight[i] * scale) : 0;
		kept += copies;
		reached += weight[i] - (double)copies * unit;
		while (!comb && drawn < points && point * sum < reached)
			if (++drawn < points)
				point = point_of(scheme, draw, drawn, points, &above);
		end = comb ? (size_t)(reached * scale + (1 - offset)) : kept + drawn;
		if (end < n)
			ancestor[end]++;
	}
	for (size_t k = 0; k < n; k++)
		ancestor[k] = ended += ancestor[k];
}
