/* lines.h - removal of narrow lines (mains, pump) from a stream
 *
 * Amplitude and phase of every line are found by least squares over a window of two hops
 * that moves on by one, and run linearly from the middle of one window to that of the
 * next; so they may change slowly, as may the frequency, and pulses much shorter than the
 * window hardly affect them (tones.h also excludes outliers).  A line of constant
 * amplitude is removed to rounding.  The output lags the input by at most two hops.
 */
#ifndef SIGNAL_LINES_H
#define SIGNAL_LINES_H

#include <stddef.h>

struct lines;

/* count frequencies omega, rad per sample; each of them and all differences at least pi /
 * hop, so that a window can resolve them.  NULL when out of memory. */
struct lines *lines_new(int count, const double *omega, int channels, size_t hop);
void lines_free(struct lines *lines);

/* Reads the next n frames, x[frame * channels + c]: hop of them, fewer (or none) at the
 * end of the stream and only there.  Returns the frames that are now clean and their
 * number, three hops at most, valid until the next call; NULL when out of memory.  A
 * stream that is too short for a fit (16 samples per line) is returned unchanged. */
const double *lines_run(struct lines *lines, const double *x, size_t n, size_t *clean);

#endif
