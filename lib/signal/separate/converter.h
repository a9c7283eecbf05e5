/* converter.h - samples that a converter has not measured: at its limits, or repeated
 *
 * A limit shows as an extreme value that comes back more often than the next one, or, if
 * noise was added behind it, as extreme values that crowd; a dropout as a run of equal
 * values longer than those of the rest of the record make likely.  A zeroed converter has
 * seen nothing.  At its usual value, that without pulses, a coarse converter stands
 * longer than elsewhere.
 */
#ifndef SIGNAL_CONVERTER_H
#define SIGNAL_CONVERTER_H

#include <stddef.h>

/* An extreme value and the next one, and how often either was seen. */
struct converter_limit {
	double value, times, next, next_times;
};

struct converter {
	struct converter_limit limit[2]; /* largest; least, its sign changed */
	int blurred[2];                  /* 1: a limit with noise behind it is known */
	double from[2];                  /* it begins here; sign as above */
	double last, samples, repeats;
	/* The value that most samples have, if more than half of them have one; by how
	 * many it leads (Boyer and Moore, 1991), and those of its runs that have ended.
	 */
	double usual, lead, usual_samples, usual_repeats;
	size_t run; /* samples up to the last one that are equal */
	int stands; /* 1: too many to have been measured */
};

/* Takes the next sample, which becomes the last one if it is nan, that is, missing.
 * Returns how many of the last samples, including this one, turn out not to have been
 * measured; those returned before do not count again. */
size_t converter_next(struct converter *c, double *x);
/* 1 if all samples so far are equal. */
static inline int converter_is_constant(const struct converter *c)
{
	return (double)c->run == c->samples;
}
/* 1 if x is at a limit, by all samples so far. */
int converter_saturates(const struct converter *c, double x);
/* Looks in sign x[0..n), hidden[0..n) apart, for limits with noise behind them, such as
 * that of an amplifier before the converter; 1 if there are.  work: 2 n. */
int converter_find_blurred(struct converter *c, const double *x, double sign,
	const unsigned char *hidden, size_t n, double *work);

#endif
