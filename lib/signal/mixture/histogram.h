/* histogram.h - a weighted histogram of two quantities, divided among its peaks
 *
 * Cells are counted by rows; cell (i, j) has the number i * HISTOGRAM_CELLS + j.  It is
 * smoothed, its peaks are sources, and each cell belongs to the peak that is reached by
 * moving to the highest neighbour repeatedly.
 */
#ifndef SIGNAL_HISTOGRAM_H
#define SIGNAL_HISTOGRAM_H

enum {
	HISTOGRAM_CELLS = 64, /* in each direction */
	HISTOGRAM_ALL = HISTOGRAM_CELLS * HISTOGRAM_CELLS,
	HISTOGRAM_PEAKS = 16
};

struct histogram {
	double weight[HISTOGRAM_ALL], smooth[HISTOGRAM_ALL];
	int owner[HISTOGRAM_ALL]; /* peak of each cell, -1: none */
};

/* Place of a peak in cells: 0.5 is the middle of the first; share of all weight that
 * belongs to it. */
struct histogram_peak {
	double i, j, share;
};

/* The highest peaks, largest first; fills smooth and owner from weight.  most: how many
 * at most, up to HISTOGRAM_PEAKS; those below floor_share of the highest are noise. */
int histogram_peaks(struct histogram *h, int most, double floor_share,
	struct histogram_peak peak[HISTOGRAM_PEAKS]);

#endif
