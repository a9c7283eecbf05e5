/* standing.c - see standing.h */
#include "num/standing.h"
#include "num/periodogram.h"
#include <stdlib.h>
#include <string.h>

enum num_status standing_count(const double *const y[2], size_t n, double *count)
{
	size_t size = fft_good_size(n), bins = size / 2 + 1, sum = 0;
	struct periodogram *p = periodogram_new(size);
	double *power = malloc(bins * sizeof *power);
	enum num_status status = p && power ? NUM_OK : NUM_MEMORY;

	for (int c = 0; c < 2 && status == NUM_OK; c++) {
		memset(power, 0, bins * sizeof *power);
		memcpy(p->x, y[c], n * sizeof *y[c]);
		periodogram_add(p, 1 / (double)n, power, bins);
		for (size_t k = 1; k < bins; k++)
			sum += power[k] > 10;
	}
	/* Of a padded transform fewer are independent. */
	*count = 2 * (double)sum * (double)n / (double)size;
	periodogram_free(p);
	free(power);
	return status;
}
