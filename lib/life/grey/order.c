/* order.c - see order.h */
#include "life/grey/order.h"
#include "life/grey/grey.h"
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* rows in each of the two means that are compared to detect a trend */
enum { TREND = 10 };

struct order {
	struct order_par par;
	int chosen;
	long rows;        /* observations so far */
	double first;     /* the first of them */
	int next;         /* place in the rings of the next observation */
	int ring;         /* its size */
	double *y, *gap;  /* last observations; gap[k] is that before y[k] */
	struct grey *fit; /* [largest + 1] of the window that ends at the newest */
	long *since;   /* row since which an order has been scored without interruption */
	double *error; /* [window][largest + 1] squared errors of the last rows */
	double *total; /* [largest + 1] sums over all rows */
	struct order_counts counts;
};

struct order *order_new(const struct order_par *par)
{
	struct order *o = calloc(1, sizeof *o);
	size_t orders = (size_t)par->largest + 1;

	if (!o)
		return NULL;
	o->par = *par;
	o->ring = par->largest > 2 * TREND ? par->largest : 2 * TREND;
	o->y = calloc((size_t)o->ring, sizeof *o->y);
	o->gap = calloc((size_t)o->ring, sizeof *o->gap);
	o->fit = calloc(orders, sizeof *o->fit);
	o->since = calloc(orders, sizeof *o->since);
	o->error = calloc(orders * (size_t)par->window, sizeof *o->error);
	o->total = calloc(orders, sizeof *o->total);
	if (!o->y || !o->gap || !o->fit || !o->since || !o->error || !o->total) {
		order_free(o);
		return NULL;
	}
	for (size_t p = 0; p < orders; p++)
		o->since[p] = LONG_MAX;
	return o;
}

void order_free(struct order *o)
{
	if (!o)
		return;
	free(o->y);
	free(o->gap);
	free(o->fit);
	free(o->since);
	free(o->error);
	free(o->total);
	free(o);
}

void order_pass(struct order *o, struct state *s)
{
	size_t orders = (size_t)o->par.largest + 1;

	state_move(s, &o->chosen, sizeof o->chosen);
	state_move(s, &o->rows, sizeof o->rows);
	state_move(s, &o->first, sizeof o->first);
	state_move(s, &o->next, sizeof o->next);
	state_move(s, o->y, (size_t)o->ring * sizeof *o->y);
	state_move(s, o->gap, (size_t)o->ring * sizeof *o->gap);
	state_move(s, o->fit, orders * sizeof *o->fit);
	state_move(s, o->since, orders * sizeof *o->since);
	state_move(s, o->error, orders * (size_t)o->par.window * sizeof *o->error);
	state_move(s, o->total, orders * sizeof *o->total);
	state_move(s, &o->counts, sizeof o->counts);
}

static int lag_place(const struct order *o, int lag)
{
	return (o->next - 1 - lag + 2 * o->ring) % o->ring;
}

static int orders_now(const struct order *o)
{
	return o->rows < o->par.largest ? (int)o->rows : o->par.largest;
}

/* Errors of the forecasts made for the row just taken, from the fits before it. */
static void score(struct order *o, double y, double gap)
{
	double *row = o->error +
		      (size_t)(o->rows % o->par.window) * ((size_t)o->par.largest + 1);

	for (int p = GREY_ORDER_MIN; p <= orders_now(o); p++) {
		double e;

		if (o->fit[p].n != p) { /* not fitted: outside the searched range */
			o->since[p] = o->rows + 1;
			o->total[p] = 0;
			continue;
		}
		if (o->rows <= p)
			o->since[p] = o->rows;
		e = y - grey_forecast(&o->fit[p], gap, gap);
		row[p] = e * e;
		o->total[p] += row[p];
	}
}

/* The trend continues: the mean of the last rows lies farther from the first observation
 * than the mean of the rows before them, on the same side. */
static int goes_on(const struct order *o)
{
	double recent = 0, before = 0;

	if (o->rows < 2 * TREND)
		return 0;
	for (int lag = 0; lag < TREND; lag++) {
		recent += o->y[lag_place(o, lag)];
		before += o->y[lag_place(o, lag + TREND)];
	}
	return (recent - before) * (recent - TREND * o->first) > 0;
}

static void fit_orders(struct order *o, int low, int high)
{
	struct grey g = { 0 };
	double gap = 0;

	for (int lag = 0; lag < high; lag++) {
		grey_add(&g, o->y[lag_place(o, lag)], gap);
		gap = o->gap[lag_place(o, lag)];
		if (g.n < GREY_ORDER_MIN)
			continue;
		o->fit[g.n] = g;
		if (g.n < low)
			o->fit[g.n].n = 0;
	}
	for (int p = high + 1; p <= orders_now(o); p++)
		o->fit[p].n = 0;
}

/* Mean squared error of order p over the last rows. */
static double recent_error(const struct order *o, int p, int rows)
{
	double sum = 0;

	for (int k = 0; k < rows; k++)
		sum += o->error[(size_t)((o->rows - 1 - k) % o->par.window) *
					((size_t)o->par.largest + 1) +
				(size_t)p];
	return sum / rows;
}

/* Rows over which orders are compared: half of those since the lowest order's first
 * forecast, at most the window. */
static int rows_compared(const struct order *o)
{
	long half = (o->rows - GREY_ORDER_MIN + 1) / 2;

	return half < o->par.window ? (int)half : o->par.window;
}

static double criterion(const struct order *o, int p, int rows)
{
	const struct grey *g = &o->fit[p];

	if (o->par.rule == ORDER_INSAMPLE)
		return grey_residual(g);
	if (o->since[p] > o->rows - rows)
		return INFINITY; /* not scored over all of these rows */
	if (o->par.rule == ORDER_ALL && o->since[p] <= o->par.largest)
		return o->total[p] / (double)(o->rows - o->since[p]);
	return recent_error(o, p, rows);
}

static void choose(struct order *o, int low, int high)
{
	int rows = rows_compared(o), best = 0;
	double least = INFINITY, held;

	if (o->par.rule == ORDER_FIXED || (rows < 1 && o->par.rule != ORDER_INSAMPLE)) {
		o->chosen = high;
		return;
	}
	for (int p = low; p <= high; p++) {
		double e = criterion(o, p, rows);

		if (e < least || !best) {
			least = e;
			best = p;
		}
	}
	if (best == o->chosen)
		return;
	held = o->chosen >= low && o->chosen <= high ? criterion(o, o->chosen, rows)
						     : INFINITY;
	if (o->par.rule != ORDER_WINDOW || least < (1 - o->par.hysteresis) * held ||
		!(held < INFINITY)) {
		o->counts.changes += o->chosen > 0;
		o->chosen = best;
	}
}

void order_add(struct order *o, double y, double gap)
{
	int low = GREY_ORDER_MIN, high;

	if (o->par.rule == ORDER_WINDOW || o->par.rule == ORDER_ALL)
		score(o, y, gap);
	if (o->rows == 0)
		o->first = y;
	o->y[o->next] = y;
	o->gap[o->next] = gap;
	o->next = (o->next + 1) % o->ring;
	o->rows++;
	high = orders_now(o);
	if (high < GREY_ORDER_MIN)
		return;
	if (o->par.rule == ORDER_FIXED)
		low = high;
	else if (o->par.range_high > 0 && goes_on(o)) {
		int all = high - low + 1;

		low = o->par.range_low > low ? o->par.range_low : low;
		high = o->par.range_high < high ? o->par.range_high : high;
		low = low < high ? low : high;
		o->counts.skipped += (unsigned long)(all - (high - low + 1));
	}
	fit_orders(o, low, high);
	o->counts.tried += (unsigned long)(high - low + 1);
	choose(o, low, high);
}

int order_chosen(const struct order *o)
{
	return o->chosen;
}

double order_forecast(const struct order *o, double h)
{
	if (o->chosen)
		return grey_forecast(&o->fit[o->chosen], h, h);
	return o->rows > 0 ? o->y[lag_place(o, 0)] : NAN;
}

struct order_counts order_counts(const struct order *o)
{
	return o->counts;
}
