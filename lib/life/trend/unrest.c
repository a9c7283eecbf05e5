/* unrest.c - see unrest.h */
#include "life/trend/unrest.h"
#include "num/robust.h"
#include <math.h>

enum { LEAST = 8 }; /* see "Unrest" in doc/trends.md */

/* A Wiener process or a jump takes the means off the line between those at a distance by
 * a square that grows with it, curved wear by one that grows faster, and noise by one
 * that does not: of two distances, twice the square at the first less that at the second.
 */
struct unrest unrest_of(const struct plateau *p, double range)
{
	struct unrest u = { .each = p->each };
	double before = 0;

	if (p->n > 0)
		u.between = (p->block[p->n - 1].t - p->block[0].t) / (p->n - 1);
	for (int far = 1; u.n < UNREST_STEPS && p->n - 2 * far >= LEAST; far *= 2) {
		double change[PLATEAU_BLOCKS], way[PLATEAU_BLOCKS], away[PLATEAU_BLOCKS],
			square;
		int n = p->n - 2 * far;

		for (int j = 0; j < n; j++) {
			const struct block *x = &p->block[j], *y = x + far, *z = y + far;
			double share = (y->t - x->t) / (z->t - x->t),
			       first = (y->y - x->y) / range / share,
			       second = (z->y - y->y) / range / (1 - share),
			       off = share * (1 - share) * (first - second);

			way[j] = fabs(z->y - x->y) / fabs(range);
			change[j] = first == second
					    ? 0
					    : 2 * (second - first) /
						      (fabs(first) + fabs(second));
			if (!isfinite(off)) /* values that overflow tell nothing */
				return (struct unrest){ 0 };
			away[j] =
				off / sqrt(1 + share * share + (1 - share) * (1 - share));
		}
		square = pow(robust_scale(away, (size_t)n), 2);
		u.way[u.n] = robust_median(way, (size_t)n);
		/* About the usual change: wear that accelerates evenly, or turns once,
		 * does not swing. */
		u.swing[u.n++] = pow(robust_spread(change, (size_t)n), 2);
		u.common = fmax(u.common, 2 * before - square);
		before = square;
	}
	return u;
}

double unrest_swing(const struct unrest *u, double time, double noise)
{
	double steps = fmax(0, rint(log2(time / u->between)));
	int k = steps < u->n ? (int)steps : -1;

	if (k < 0)
		return 0;
	/* Noise makes 4 * 6 / way^2 of its variance.  Of rates that vary about a mean,
	 * the square of a difference is twice that of one. */
	noise = fmax(noise / (double)u->each, u->common);
	return 0.5 * fmax(0, u->swing[k] - 24 * noise / (u->way[k] * u->way[k]));
}

/* The variance of the noise is known to about a factor of two. */
double unrest_common(const struct unrest *u, double noise)
{
	return u->n > 0 ? fmax(0, u->common - 2 * noise / (double)u->each) : 0;
}
