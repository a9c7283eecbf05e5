#include "report.h"
#include "signal/filter/fir.h"
#include <math.h>
#include <stdlib.h>
#include <wearpipe/filter.h>

struct wp_filter {
	struct fir *fir;
	int channels;
};

enum wp_status wp_filter_taps(
	int order, double low, double high, double rate, double *taps)
{
	struct fir_band band = { order, low / rate, high / rate, FIR_HAMMING, 0, 1 };

	if (order < 1 || !(rate > 0) || !(band.low >= 0) || !(band.high > band.low) ||
		!(band.high <= 0.5))
		return WP_DOMAIN;
	return fir_design(&band, taps) == NUM_OK ? WP_OK : WP_IMPOSSIBLE;
}

struct wp_filter *wp_filter_new(
	const double *taps, size_t n, int channels, enum wp_status *status)
{
	struct wp_filter *f;

	if (n < 1 || channels < 1)
		return report(status, WP_DOMAIN);
	f = malloc(sizeof *f);
	if (!f)
		return report(status, WP_NO_MEMORY);
	f->channels = channels;
	f->fir = fir_new(taps, n, channels, 0);
	if (!f->fir) {
		free(f);
		return report(status, WP_NO_MEMORY);
	}
	report(status, WP_OK);
	return f;
}

void wp_filter_free(struct wp_filter *f)
{
	if (f)
		fir_free(f->fir);
	free(f);
}

enum wp_status wp_filter_run(struct wp_filter *f, double *x, size_t frames)
{
	size_t block = fir_block(f->fir);

	for (size_t i = 0; i < frames * (size_t)f->channels; i++)
		if (!isfinite(x[i]))
			return WP_NUMBERS;
	for (size_t done = 0; done < frames; done += block) {
		size_t n = frames - done < block ? frames - done : block;

		fir_run(f->fir, x + done * (size_t)f->channels, n);
	}
	return WP_OK;
}
