/* gaps.c - see gaps.h */
#include "signal/gaps.h"
#include <math.h>
#include <string.h>

/* Longest run of equal samples with this value. */
static size_t longest_run(const double *x, size_t n, double value)
{
	size_t longest = 0, run = 0;

	for (size_t i = 0; i < n; i++) {
		run = x[i] == value ? run + 1 : 0;
		longest = run > longest ? run : longest;
	}
	return longest;
}

void gaps_learn(struct gaps *g, const double *x, size_t n)
{
	double low = INFINITY, high = -INFINITY, share, equal = 0;

	*g = (struct gaps){ 0, -INFINITY, INFINITY };
	for (size_t i = 0; i < n; i++) {
		low = fmin(low, x[i]);
		high = fmax(high, x[i]);
		equal += i > 0 && x[i] == x[i - 1];
	}
	share = fmax(equal, 1) / (double)n;
	if (share > 0.5)
		return;
	g->run = 1 + (size_t)ceil(log((double)n / 1e-3) / log(1 / share));
	g->run = g->run < 4 ? 4 : g->run;
	if (longest_run(x, n, low) >= g->run)
		g->low = low;
	if (longest_run(x, n, high) >= g->run)
		g->high = high;
}

size_t gaps_mark(
	const struct gaps *g, const double *x, size_t from, size_t n, unsigned char *bad)
{
	size_t run = 1, clipped = 0, at = from;

	if (g->run == 0)
		return 0;
	while (at > 0 && run < g->run && x[at - 1] == x[from]) {
		at--;
		run++;
	}
	for (size_t i = from; i < n; i++) {
		if (i > from)
			run = x[i] == x[i - 1] ? run + 1 : 1;
		if (run == g->run)
			memset(bad + (i + 1 - run), GAPS_HELD, run);
		else if (run > g->run)
			bad[i] = GAPS_HELD;
		if (x[i] <= g->low || x[i] >= g->high) {
			bad[i] = GAPS_CLIPPED;
			clipped++;
		}
	}
	return clipped;
}
