#include "life/trend/bank.h"
#include "life/trend/passage.h"
#include "num/select.h"
#include "report.h"
#include <math.h>
#include <stdlib.h>
#include <wearpipe/life.h>

struct wp_life {
	struct bank_par par;
	struct bank *bank;
	struct bank_chances *chances;
	int draws;
	double last;   /* time */
	double life[]; /* one for each draw */
};

struct wp_life *wp_life_new(
	double threshold, int direction, int draws, uint64_t seed, enum wp_status *status)
{
	struct wp_life *l;

	if (!isfinite(threshold) || (direction != 1 && direction != -1) || draws < 1)
		return report(status, WP_DOMAIN);
	l = malloc(sizeof *l + (size_t)draws * sizeof *l->life);
	if (!l)
		return report(status, WP_NO_MEMORY);
	l->par = (struct bank_par){ .threshold = threshold, .direction = direction };
	l->draws = draws;
	l->last = -INFINITY;
	l->bank = bank_new(&l->par);
	l->chances = bank_chances_new(draws, seed);
	if (!l->bank || !l->chances) {
		wp_life_free(l);
		return report(status, WP_NO_MEMORY);
	}
	report(status, WP_OK);
	return l;
}

void wp_life_free(struct wp_life *l)
{
	if (!l)
		return;
	bank_free(l->bank);
	bank_chances_free(l->chances);
	free(l);
}

enum wp_status wp_life_observe(struct wp_life *l, double t, double y)
{
	if (!isfinite(t) || isinf(y))
		return WP_NUMBERS;
	if (t <= l->last)
		return WP_DOMAIN;
	l->last = t;
	bank_add(l->bank, t, y);
	return WP_OK;
}

enum wp_status wp_life_quantiles(
	struct wp_life *l, const double *level, double *quantile, int n, double *never)
{
	int draws = l->draws, finite = 0;

	if (!bank_ready(l->bank))
		return WP_IMPOSSIBLE;
	if (bank_draw(l->bank, l->chances, l->last, l->par.threshold, l->life))
		return WP_NO_MEMORY;
	sort_numbers(l->life, (size_t)draws);
	while (finite < draws && isfinite(l->life[finite]))
		finite++;
	for (int i = 0; i < n; i++) {
		if (!(level[i] >= 0 && level[i] <= 1))
			return WP_DOMAIN;
		quantile[i] = sorted_quantile(l->life, (size_t)draws, level[i]);
	}
	if (never)
		*never = (double)(draws - finite) / draws;
	return WP_OK;
}
