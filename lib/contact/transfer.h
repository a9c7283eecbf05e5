/* transfer.h - restriction to a grid of about half as many cells in each direction, and
 * interpolation from it; for lib/contact only
 *
 * Any two sizes can be combined: a coarse cell is the mean over the parts of at most
 * three fine cells in each direction that it covers; a fine cell is interpolated between
 * four coarse centres.
 */
#ifndef CONTACT_TRANSFER_H
#define CONTACT_TRANSFER_H

#include "contact/problem.h"
#include "num/status.h"

enum { TRANSFER_TAPS = 3 };

/* One direction: n cells to m. */
struct axis {
	size_t n, m;
	size_t *first; /* fine cell where a coarse one begins */
	double *cover; /* parts of the coarse cell in TRANSFER_TAPS cells from there on */
	size_t *low, *high; /* coarse neighbours of a fine cell */
	double *share;      /* of the higher in between */
};

struct transfer {
	struct axis x, y;
};

/* Chooses the next coarser grid, sized for fast transforms; 1 if it is coarser. */
int transfer_coarsen(const struct contact_par *fine, struct contact_par *coarse);

/* Whether it succeeds or not, transfer_done() frees it. */
enum num_status transfer_make(struct transfer *t, const struct contact_par *fine,
	const struct contact_par *coarse);
void transfer_done(struct transfer *t);

/* Bilinear value at a fine cell: (1 - share) low + share high, each way. */
static inline double transfer_at(
	const struct transfer *t, const double *coarse, size_t x, size_t y)
{
	const double *a = coarse + t->y.low[y] * t->x.m,
		     *b = coarse + t->y.high[y] * t->x.m;
	size_t low = t->x.low[x], high = t->x.high[x];
	double sx = t->x.share[x], sy = t->y.share[y];
	double first = a[low] + sx * (a[high] - a[low]);

	return first + sy * (b[low] + sx * (b[high] - b[low]) - first);
}

#endif
