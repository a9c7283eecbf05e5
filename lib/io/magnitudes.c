#include "io/magnitudes.h"
#include <math.h>
#include <string.h>

/* Occurrence of the lower half in a bitmap, addressed by a multiplicative hash.  Numbers
 * that differ by rounding, such as those of a wave that repeats, are one: 12 bits are
 * rounding errors of 4096 units. */
static void add_half(struct magnitudes *m, double x)
{
	uint64_t bits;
	uint32_t half, bin;
	float single;

	memcpy(&bits, &x, sizeof bits);
	half = (uint32_t)bits;
	bin = (half >> 12) * 2654435761u >> 24;
	m->halves[bin / 64] |= (uint64_t)1 << bin % 64;
	memcpy(&single, &half, sizeof single);
	m->halved += half != 0;
	m->wild += !(fabsf(single) <= 1e15F);
}

void magnitudes_add(struct magnitudes *m, const double *x, size_t n)
{
	m->samples += (double)n;
	for (size_t i = 0; i < n; i++) {
		m->huge += fabs(x[i]) > 1e100;
		m->most = fmax(m->most, fabs(x[i]));
		add_half(m, x[i]);
	}
}

int magnitudes_absurd(const struct magnitudes *m, double least)
{
	return m->huge > 0.01 * m->samples || (m->most > 0 && m->most <= least);
}

int magnitudes_single(const struct magnitudes *m)
{
	int different = 0;

	for (size_t i = 0; i < sizeof m->halves / sizeof *m->halves; i++)
		for (uint64_t left = m->halves[i]; left; left &= left - 1)
			different++;
	return different >= 64 && m->wild <= 0.01 * m->halved;
}
