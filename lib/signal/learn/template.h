/* template.h - the pulse of a record, taken from the record itself
 *
 * Among the clear events of a record, the one that most others equal within noise is
 * selected, and these are averaged, each at its own arrival, size and velocity.  Nothing
 * is assumed about the shape: it includes the effects of the front-end, of a reversed
 * coil or of another kind of sensor.  Overlapping pulses and foreign events equal few
 * others.
 */
#ifndef SIGNAL_TEMPLATE_H
#define SIGNAL_TEMPLATE_H

#include "num/status.h"
#include "signal/pulse/shape.h"
#include <stddef.h>

enum { TEMPLATE_EVENTS = 32, TEMPLATE_LEAST = 3 };

struct template
{
	struct shape *shape; /* NULL: there are not enough events that are alike */
	double duration; /* samples, of a pulse whose delay is that of the alignment */
	int events;
	double t1[TEMPLATE_EVENTS], t2[TEMPLATE_EVENTS]; /* arrivals, samples */
	double a[TEMPLATE_EVENTS];                       /* amplitudes at sensor 1 */
	int signs;                                       /* 1: some of either sign */
	/* The pulse of sensor.h that is most similar, and the share of the energy that it
	 * leaves.  Arrivals are those of this pulse. */
	int pulse, reversed;
	double left;
	int elsewhere; /* set by the caller: 1: found at a duration other than the guess
			*/
	/* Set by the caller, kept. */
	int alone; /* 1: no known pulse is to be tried instead */
	int white; /* 1: the noise is, above the band of the pulses */
};

/* y1, y2[0 .. n), aligned to within reach, in units of white noise; duration: a guess
 * within a factor of two; transit: samples between the sensors, INFINITY if unknown;
 * width: of the pulses of sensor 2 over those of sensor 1; hidden: flags of samples that
 * are not known, or NULL.  single: -1, or the number of the one clear event, in the order
 * of size and shortness, that is taken: it has its noise, and may be more than one pulse.
 * NUM_MEMORY. */
enum num_status template_find(struct template *t, const double *y1, const double *y2,
	const unsigned char *const hidden[2], size_t n, double duration, double transit,
	double width, double reach, int single);
void template_clear(struct template *t);

/* The share of the energy that the most similar pulse of sensor.h leaves after symmetric
 * taps -half .. half; 2 if none of about this duration has its sign. */
enum num_status template_known(
	const struct template *t, const double *tap, int half, double *left);

/* Peak of the mean of x1[0 .. n), a record of the same events before its noise was made
 * white, for a pulse of amplitude 1. */
double template_peak(const struct template *t, const double *x1, size_t n);

#endif
