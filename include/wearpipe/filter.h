/* filter.h - band-pass filters by the window method, on records in memory
 *
 *	static double x[2000], taps[201];
 *	struct wp_filter *f;
 *	x[1000] = 1;
 *	if (wp_filter_taps(200, 70.0, 130.0, 1000.0, taps) != WP_OK)
 *		return 1;
 *	f = wp_filter_new(taps, 201, 1, NULL);
 *	if (!f || wp_filter_run(f, x, 2000) != WP_OK)
 *		return 1;
 *	printf("%g\n", x[1100]);
 *	wp_filter_free(f);
 */
#ifndef WEARPIPE_FILTER_H
#define WEARPIPE_FILTER_H

#include <stddef.h>
#include <wearpipe/status.h>

#ifdef __cplusplus
extern "C" {
#endif

struct wp_filter;

/* Fills taps[order + 1] with a Hamming-windowed band-pass from low to high, in the unit
 * of rate; gain 1 at the middle of the band, at 0 where low is 0. */
WP_API enum wp_status wp_filter_taps(
	int order, double low, double high, double rate, double *taps);

/* A filter of n taps for interleaved frames of this number of channels. */
WP_API struct wp_filter *wp_filter_new(
	const double *taps, size_t n, int channels, enum wp_status *status);
WP_API void wp_filter_free(struct wp_filter *f);

/* Filters frames in place; samples before the first call are zero, and each call
 * continues where the last one ended.  Symmetric taps delay by (n - 1) / 2 frames.
 * WP_NUMBERS if a sample is not finite: nothing is filtered. */
WP_API enum wp_status wp_filter_run(struct wp_filter *f, double *x, size_t frames);

#ifdef __cplusplus
}
#endif
#endif
