#include "io/magnitudes.h"
#include <math.h>

void magnitudes_add(struct magnitudes *m, const double *x, size_t n)
{
	m->samples += (double)n;
	for (size_t i = 0; i < n; i++) {
		m->huge += fabs(x[i]) > 1e100;
		m->most = fmax(m->most, fabs(x[i]));
	}
}

int magnitudes_absurd(const struct magnitudes *m, double least)
{
	return m->huge > 0.01 * m->samples || (m->most > 0 && m->most <= least);
}
