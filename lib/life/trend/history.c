/* history.c - see history.h */
#include "life/trend/history.h"
#include <stdlib.h>

struct history {
	double t[HISTORY_MAX + 1], x[HISTORY_MAX + 1];
	int n;               /* whole groups */
	long rows, width;    /* rows in each group */
	long held;           /* rows of the unfinished group */
	double sum_t, sum_x; /* over it */
};

struct history *history_new(void)
{
	struct history *h = malloc(sizeof *h);

	if (h)
		history_clear(h);
	return h;
}

void history_clear(struct history *h)
{
	*h = (struct history){ .width = 1 };
}

void history_free(struct history *h)
{
	free(h);
}

void history_pass(struct history *h, struct state *s)
{
	state_move(s, h, sizeof *h);
}

static void merge_pairs(struct history *h)
{
	for (int k = 0; k < HISTORY_MAX / 2; k++) {
		h->t[k] = 0.5 * (h->t[2 * k] + h->t[2 * k + 1]);
		h->x[k] = 0.5 * (h->x[2 * k] + h->x[2 * k + 1]);
	}
	h->n = HISTORY_MAX / 2;
	h->width *= 2;
}

void history_add(struct history *h, double t, double x)
{
	h->sum_t += t;
	h->sum_x += x;
	h->held++;
	h->rows++;
	if (h->held < h->width)
		return;
	h->t[h->n] = h->sum_t / (double)h->held;
	h->x[h->n] = h->sum_x / (double)h->held;
	h->sum_t = h->sum_x = 0;
	h->held = 0;
	if (++h->n == HISTORY_MAX)
		merge_pairs(h);
}

int history_get(struct history *h, const double **t, const double **x)
{
	*t = h->t;
	*x = h->x;
	if (h->held == 0)
		return h->n;
	h->t[h->n] = h->sum_t / (double)h->held;
	h->x[h->n] = h->sum_x / (double)h->held;
	return h->n + 1;
}
