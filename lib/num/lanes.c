#include "num/lanes.h"

typedef uint64_t words4 __attribute__((vector_size(32)));

/* Doubles that are looked at together, and those of the last steps. */
enum { FEW = 4, MANY = 8 * FEW };

static inline void add_bits(words4 *any, const double *x)
{
	words4 w;

	memcpy(&w, x, sizeof w);
	*any |= w;
}

static inline int is_set(const words4 *w)
{
	return ((*w)[0] | (*w)[1] | (*w)[2] | (*w)[3]) != 0;
}

LANES_CLONES size_t lanes_skip(const double *x, size_t i, size_t n)
{
	for (; i + MANY <= n; i += MANY) {
		words4 any = { 0 };

		/* Loops are not unrolled at -O2. */
		add_bits(&any, x + i);
		add_bits(&any, x + i + FEW);
		add_bits(&any, x + i + 2 * FEW);
		add_bits(&any, x + i + 3 * FEW);
		add_bits(&any, x + i + 4 * FEW);
		add_bits(&any, x + i + 5 * FEW);
		add_bits(&any, x + i + 6 * FEW);
		add_bits(&any, x + i + 7 * FEW);
		if (is_set(&any))
			break;
	}
	for (; i + FEW <= n; i += FEW) {
		words4 any = { 0 };

		add_bits(&any, x + i);
		if (is_set(&any))
			break;
	}
	/* A negative zero has ended both, too. */
	while (i < n && x[i] == 0)
		i++;
	return i;
}
