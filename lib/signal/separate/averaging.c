/* averaging.c - means of samples, from which pulses of many samples are separated */
#include "num/dot.h"
#include "signal/detect/align.h"
#include "signal/separate/separate_state.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Pulses of more than SEPARATE_LONG samples are separated from means of as many samples,
 * at most MOST, as leave them half of that: what is learned from lasts that much longer,
 * and a second of the record takes as much less work.  128, 256 and 512 find 819, 818
 * and 818 of 842 particles of 16 records of 15 to 1000 kHz (tests/matrix/simulate), with
 * none wrong; two, one and one are then refused or not done within their length; 1024
 * leaves more. */
enum { MOST = 64 };

/* Samples in whose means the pulses are looked for first. */
enum { FEW = 8 };

int separate_ratio_of(double duration, int limit, int most)
{
	int ratio = 1;

	while (ratio < most && duration / ratio > limit)
		ratio *= 2;
	return ratio;
}

static void subtract_mean(double *x, size_t n)
{
	double mean = mean_of(x, n);

	for (size_t i = 0; i < n; i++)
		x[i] -= mean;
}

/* *lag: the lag at which the autocorrelation of both channels is lowest. */
static enum num_status find_lowest_lag(struct buffer mean[2], size_t n, double *lag)
{
	double *r = malloc((n / 4 + 1) * sizeof *r);
	enum num_status status = NUM_MEMORY;

	subtract_mean(mean[0].x, n);
	subtract_mean(mean[1].x, n);
	if (r)
		status = align_autocorrelation(mean[0].x, mean[1].x, n, n / 4, r);
	*lag = status == NUM_OK ? lowest_lag(r, n / 4) : 0;
	free(r);
	return status;
}

void separate_clear_buffers(struct buffer buffer[CHANNELS_MAX])
{
	for (int c = 0; c < CHANNELS_MAX; c++)
		buffer_clear(&buffer[c]);
}

enum num_status separate_average_buffers(const struct buffer buffer[CHANNELS_MAX],
	int channels, size_t n, int ratio, struct buffer mean[CHANNELS_MAX])
{
	memset(mean, 0, CHANNELS_MAX * sizeof *mean);
	for (int c = 0; c < channels; c++)
		if (buffer_average(&buffer[c], n, (size_t)ratio, &mean[c]) != NUM_OK)
			return NUM_MEMORY;
	return NUM_OK;
}

enum num_status separate_guess_ratio(const struct separate *s, int *ratio)
{
	struct buffer mean[CHANNELS_MAX];
	double lag = 0;
	enum num_status status = separate_average_buffers(
		s->buffer, 2, lesser(s->buffer[0].n, s->par.learn), FEW, mean);

	if (status == NUM_OK && mean[0].n >= SEPARATE_SHORTEST)
		status = find_lowest_lag(mean, mean[0].n, &lag);
	separate_clear_buffers(mean);
	*ratio = separate_ratio_of(2 * FEW * lag, SEPARATE_LONG, MOST);
	return status;
}

size_t separate_learned_means(const struct separate *s, int ratio)
{
	size_t most = s->par.window ? s->par.window / (size_t)ratio : SIZE_MAX;

	return s->default_learn ? lesser(s->par.learn, most)
				: s->par.learn / (size_t)ratio;
}

void separate_convert(struct separate *s, int ratio)
{
	s->ratio = ratio;
	s->par.learn = separate_learned_means(s, ratio);
	s->par.window /= (size_t)ratio;
	s->counters.samples /= ratio;
	s->counters.passed_over /= ratio;
	s->counters.unlearned /= ratio;
}

void separate_average(struct separate *s, int ratio)
{
	separate_convert(s, ratio);
	for (int c = 0; ratio > 1 && c < s->channels; c++)
		s->buffer[c].ratio = (size_t)ratio;
}
