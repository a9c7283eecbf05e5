/* resample.c - see resample.h */
#include "life/particle/resample.h"
#include <math.h>
#include <string.h>

/* Equally spaced points (teeth of a comb) in [0, sum) are compared with the running sum
 * of the weights, without the copies that were kept before: weight - kept * unit. */
struct comb {
	const double *weight;
	double unit; /* weight of one kept copy; 0 keeps none */
	double sum;
};

static inline double rest(const struct comb *c, size_t i)
{
	return c->unit > 0 ? c->weight[i] - c->unit * floor(c->weight[i] / c->unit)
			   : c->weight[i];
}

static void comb_stratified(
	const struct comb *c, size_t n, uint32_t *ancestor, struct draw *draw)
{
	double step = c->sum / (double)n, reached = c->weight[0];
	size_t i = 0;

	for (size_t k = 0; k < n; k++) {
		double tooth = step * ((double)k + draw_uniform(draw));

		while (reached <= tooth && i + 1 < n)
			reached += c->weight[++i];
		ancestor[k] = (uint32_t)i;
	}
}

/* One offset for all teeth: particle i ends before tooth number reached / step - offset,
 * rounded up.  The ancestor of a tooth is the number of particles that end before it;
 * these are counted and summed without a branch, which would be mispredicted. */
static void comb_systematic(
	const struct comb *c, size_t n, uint32_t *ancestor, double offset)
{
	double scale = (double)n / c->sum, reached = 0;
	uint32_t ended = 0;

	memset(ancestor, 0, n * sizeof *ancestor);
	for (size_t i = 0; i + 1 < n; i++) {
		size_t end;

		reached += c->weight[i];
		end = (size_t)(reached * scale + (1 - offset));
		if (end < n)
			ancestor[end]++;
	}
	for (size_t k = 0; k < n; k++)
		ancestor[k] = ended += ancestor[k];
}

/* Ancestors first .. n - 1 by independent uniforms in sorted order: from the top down,
 * U_(k) = U_(k+1) V^(1/k). */
static void comb_multinomial(const struct comb *c, size_t n, size_t first,
	uint32_t *ancestor, struct draw *draw)
{
	double top = 1, reached = c->sum;
	size_t i = n - 1;

	for (size_t k = n - first; k > 0; k--) {
		top *= exp(log(draw_uniform(draw)) / (double)k);
		while (reached - rest(c, i) > top * c->sum && i > 0)
			reached -= rest(c, i--);
		ancestor[first + k - 1] = (uint32_t)i;
	}
}

/* Merges the ascending list of kept copies, counted anew, with the ascending list of
 * drawn ones in ancestor[kept .. n - 1], from the front: the position read is always
 * ahead of the position written. */
static void merge_kept(const struct comb *c, size_t n, size_t kept, uint32_t *ancestor)
{
	size_t put = 0, drawn = kept;

	for (size_t i = 0; i < n; i++) {
		size_t copies = (size_t)floor(c->weight[i] / c->unit);

		while (drawn < n && ancestor[drawn] == i) {
			copies++;
			drawn++;
		}
		while (copies-- > 0 && put < n)
			ancestor[put++] = (uint32_t)i;
	}
}

static void resample_residual(
	struct draw *draw, struct comb *c, size_t n, uint32_t *ancestor)
{
	size_t kept = 0;
	double left = 0;

	c->unit = c->sum / (double)n;
	for (size_t i = 0; i < n; i++) {
		kept += (size_t)floor(c->weight[i] / c->unit);
		left += rest(c, i);
	}
	if (kept < n) {
		c->sum = left;
		comb_multinomial(c, n, kept, ancestor, draw);
	} else {
		kept = n;
	}
	merge_kept(c, n, kept, ancestor);
}

void resample(enum resampling scheme, struct draw *draw, const double *weight, double sum,
	size_t n, uint32_t *ancestor)
{
	struct comb c = { weight, 0, sum };

	switch (scheme) {
	case RESAMPLE_SYSTEMATIC:
		comb_systematic(&c, n, ancestor, draw_uniform(draw));
		break;
	case RESAMPLE_STRATIFIED:
		comb_stratified(&c, n, ancestor, draw);
		break;
	case RESAMPLE_RESIDUAL:
		resample_residual(draw, &c, n, ancestor);
		break;
	case RESAMPLE_MULTINOMIAL:
		comb_multinomial(&c, n, 0, ancestor, draw);
		break;
	}
}
