#include "contact/transfer.h"
#include "num/fft.h"
#include "num/status.h"
#include <math.h>
#include <stdlib.h>

/* Slivers that rounding leaves of cells that end together, 1e-11 on the longest grids.
 * From 0 to 1e-6 the solver takes as many iterations in tests/unit/exact.c. */
static const double sliver = 1e-9;

/* Half as many where that is a good size: other cells overlap without matching. */
static int coarser(int n)
{
	size_t half = ((size_t)n + 1) / 2;

	if (n == 1)
		return 1;
	return (int)(fft_good_size(half) == half ? half : fft_fast_size(half));
}

int transfer_coarsen(const struct contact_par *fine, struct contact_par *coarse)
{
	*coarse = *fine;
	coarse->nx = coarser(fine->nx);
	coarse->ny = coarser(fine->ny);
	coarse->dx = fine->dx * fine->nx / coarse->nx;
	coarse->dy = fine->dy * fine->ny / coarse->ny;
	return coarse->nx < fine->nx || coarse->ny < fine->ny;
}

static enum num_status make_axis(struct axis *a, size_t n, size_t m, int periodic)
{
	double ratio = (double)n / (double)m;

	a->n = n;
	a->m = m;
	a->first = calloc(m, sizeof *a->first);
	a->cover = calloc(m, TRANSFER_TAPS * sizeof *a->cover);
	a->low = calloc(n, sizeof *a->low);
	a->high = calloc(n, sizeof *a->high);
	a->share = calloc(n, sizeof *a->share);
	if (!a->first || !a->cover || !a->low || !a->high || !a->share)
		return NUM_MEMORY;
	for (size_t i = 0; i < m; i++) {
		double begin = (double)i * ratio, end = begin + ratio;

		a->first[i] = (size_t)(begin + sliver);
		for (size_t k = 0; k < TRANSFER_TAPS; k++) {
			double cell = (double)(a->first[i] + k);
			double part = fmin(end, cell + 1) - fmax(begin, cell);

			a->cover[TRANSFER_TAPS * i + k] =
				part > sliver ? part / ratio : 0;
		}
	}
	for (size_t i = 0; i < n; i++) {
		double x = ((double)i + 0.5) / ratio - 0.5, below = floor(x);

		a->share[i] = x - below;
		a->low[i] = below >= 0 ? (size_t)below : periodic ? m - 1 : 0;
		a->high[i] = below + 1 < (double)m ? (size_t)(below + 1)
			     : periodic            ? 0
						   : m - 1;
	}
	return NUM_OK;
}

enum num_status transfer_make(struct transfer *t, const struct contact_par *fine,
	const struct contact_par *coarse)
{
	int periodic = fine->boundary == CONTACT_PERIODIC;
	enum num_status x =
		make_axis(&t->x, (size_t)fine->nx, (size_t)coarse->nx, periodic);
	enum num_status y =
		make_axis(&t->y, (size_t)fine->ny, (size_t)coarse->ny, periodic);

	return x ? x : y;
}

static void free_axis(struct axis *a)
{
	free(a->first);
	free(a->cover);
	free(a->low);
	free(a->high);
	free(a->share);
}

void transfer_done(struct transfer *t)
{
	free_axis(&t->x);
	free_axis(&t->y);
}
