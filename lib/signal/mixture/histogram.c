/* histogram.c - peaks of a weighted histogram */
#include "signal/mixture/histogram.h"
#include "num/parabola.h"
#include <math.h>
#include <string.h>

enum { CELLS = HISTOGRAM_CELLS, ALL = HISTOGRAM_ALL };

/* Binomial smoothing along both axes: twelve passes of (1, 2, 1) / 4, sd 2.4 cells. */
static void smooth_weights(struct histogram *h)
{
	double *a = h->smooth, b[ALL];

	memcpy(a, h->weight, sizeof h->smooth);
	for (int pass = 0; pass < 12; pass++) {
		for (int i = 0; i < ALL; i++) {
			int j = i % CELLS;

			b[i] = (2 * a[i] + (j ? a[i - 1] : a[i]) +
				       (j < CELLS - 1 ? a[i + 1] : a[i])) /
			       4;
		}
		for (int i = 0; i < ALL; i++)
			a[i] = (2 * b[i] + (i >= CELLS ? b[i - CELLS] : b[i]) +
				       (i < ALL - CELLS ? b[i + CELLS] : b[i])) /
			       4;
	}
}

/* The highest of cell i and its eight neighbours; ties go to the lower index. */
static int uphill(const struct histogram *h, int i)
{
	int best = i, row = i / CELLS, col = i % CELLS;

	for (int r = row - 1; r <= row + 1; r++)
		for (int c = col - 1; c <= col + 1; c++)
			if (r >= 0 && r < CELLS && c >= 0 && c < CELLS &&
				h->smooth[r * CELLS + c] > h->smooth[best])
				best = r * CELLS + c;
	return best;
}

/* Vertex of the parabola through three values, within half a cell. */
static double vertex(double before, double at, double after)
{
	return fmax(fmin(parabola_top(before, at, after), 0.5), -0.5);
}

static struct histogram_peak locate(const struct histogram *h, int at)
{
	int i = at / CELLS, j = at % CELLS;
	const double *s = h->smooth + at;
	struct histogram_peak peak = { i + 0.5, j + 0.5, 0 };

	if (i > 0 && i < CELLS - 1)
		peak.i += vertex(s[-CELLS], s[0], s[CELLS]);
	if (j > 0 && j < CELLS - 1)
		peak.j += vertex(s[-1], s[0], s[1]);
	return peak;
}

/* Gives each cell to one of the count peaks at these cells. */
static void share_out(
	struct histogram *h, const int *at, int count, struct histogram_peak *peak)
{
	double total = 0;

	for (int i = 0; i < ALL; i++) {
		int top = i, next;

		h->owner[i] = -1;
		if (h->smooth[i] <= 0)
			continue;
		while ((next = uphill(h, top)) != top)
			top = next;
		for (int k = 0; k < count; k++)
			if (at[k] == top)
				h->owner[i] = k;
		if (h->owner[i] >= 0)
			peak[h->owner[i]].share += h->weight[i];
		total += h->weight[i];
	}
	for (int k = 0; k < count; k++)
		peak[k].share /= total;
}

int histogram_peaks(struct histogram *h, int most, double floor_share,
	struct histogram_peak peak[HISTOGRAM_PEAKS])
{
	int at[HISTOGRAM_PEAKS] = { 0 }, count = 0;

	smooth_weights(h);
	for (int i = 0; i < ALL; i++) {
		int k;

		if (h->smooth[i] <= 0 || uphill(h, i) != i)
			continue;
		for (k = count; k > 0 && h->smooth[at[k - 1]] < h->smooth[i]; k--)
			if (k < most)
				at[k] = at[k - 1];
		if (k < most) {
			at[k] = i;
			count += count < most;
		}
	}
	while (count > 1 && h->smooth[at[count - 1]] < floor_share * h->smooth[at[0]])
		count--;
	for (int k = 0; k < count; k++)
		peak[k] = locate(h, at[k]);
	share_out(h, at, count, peak);
	return count;
}
