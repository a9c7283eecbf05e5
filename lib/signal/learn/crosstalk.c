/* crosstalk.c - see crosstalk.h */
#include "signal/learn/crosstalk.h"
#include "num/dot.h"
#include "num/sigmas.h"
#include "signal/noise/robust.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Fewest pulses that tell of crosstalk. */
enum { FEWEST = 6 };

double crosstalk_median(double *share, size_t count, double energy)
{
	double middle = robust_median(share, count);
	/* The variance of a median is pi / 2 that of a mean. */
	double error =
		sqrt(M_PI_2 * fmax(pow(robust_spread(share, count), 2) / (double)count,
				      1 / energy));

	return count >= FEWEST && fabs(middle) > SIGMAS_NEVER * error &&
			       fabs(middle) < CROSSTALK_MOST
		       ? middle
		       : 0;
}

/* 1 if the other channel has no pulse of its own at the time of m. */
static int is_alone(const struct mark *m, double noise, const struct marks *other)
{
	for (size_t k = 0; k < other->count; k++) {
		const struct mark *o = &other->mark[k];

		if (fabs(o->t - m->t) < 0.5 * (m->T + o->T) &&
			fabs(o->value) * other->noise >
				CROSSTALK_MOST * fabs(m->value) * noise)
			return 0;
	}
	return 1;
}

/* The share of channel own in the other one, by least squares in each pulse. */
static enum num_status share_of(const double *const x[2],
	const unsigned char *const hidden[2], size_t n, const struct marks m[2], int own,
	double *found)
{
	const struct marks *mine = &m[own], *other = &m[!own];
	double *share = malloc((mine->count + 1) * sizeof *share), energy = 0;
	size_t count = 0;

	if (!share)
		return NUM_MEMORY;
	for (size_t i = 0; i < mine->count; i++) {
		const struct mark *k = &mine->mark[i];
		double first = k->t - 0.5 * k->T;
		size_t from = (size_t)fmax(first, 0), length = (size_t)k->T;
		const double *a = x[own] + from, *b = x[!own] + from;
		double mean, square;

		if (first < 0 || from + length > n || !is_alone(k, mine->noise, other) ||
			(hidden[own] && memchr(hidden[own] + from, 1, length)) ||
			(hidden[!own] && memchr(hidden[!own] + from, 1, length)))
			continue;
		mean = mean_of(a, length);
		square = dot(a, a, length) - (double)length * mean * mean;
		share[count++] =
			(dot(a, b, length) - (double)length * mean * mean_of(b, length)) /
			square;
		energy += square / (other->noise * other->noise);
	}
	*found = crosstalk_median(share, count, energy);
	free(share);
	return NUM_OK;
}

enum num_status crosstalk_find(const double *const x[2],
	const unsigned char *const hidden[2], size_t n, const struct marks m[2],
	double share[2])
{
	enum num_status status = share_of(x, hidden, n, m, 1, &share[0]);

	return status == NUM_OK ? share_of(x, hidden, n, m, 0, &share[1]) : status;
}
