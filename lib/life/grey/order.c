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
	int ring; /* size of that of the last observations */
	struct order_state {
		int chosen, next; /* next: place in the ring of the next observation */
		long rows;        /* observations so far */
		double first;     /* the first of them */
		struct order_counts counts;
	} now;
	struct observation {
		double y, gap; /* since the one before */
	} * last;
	struct candidate {
		struct grey fit; /* of the window that ends at the newest */
		long since;      /* row since which it has been scored on end */
		double total;    /* of squared errors since then */
	} * of;                  /* [largest + 1] */
	double *error; /* [window][largest + 1] squared errors of the last rows */
};

struct order *order_new(const struct order_par *par)
{
	struct order *o = calloc(1, sizeof *o);
	size_t orders = (size_t)par->largest + 1;

	if (!o)
		return NULL;
	o->par = *par;
	o->ring = par->largest > 2 * TREND ? par->largest : 2 * TREND;
	o->last = calloc((size_t)o->ring, sizeof *o->last);
	o->of = calloc(orders, sizeof *o->of);
	o->error = calloc(orders * (size_t)par->window, sizeof *o->error);
	if (!o->last || !o->of || !o->error) {
		order_free(o);
		return NULL;
	}
	for (size_t p = 0; p < orders; p++)
		o->of[p].since = LONG_MAX;
	return o;
}

void order_free(struct order *o)
{
	if (!o)
		return;
	free(o->last);
	free(o->of);
	free(o->error);
	free(o);
}

void order_pass(struct order *o, struct state *s)
{
	size_t orders = (size_t)o->par.largest + 1;

	state_move(s, &o->now, sizeof o->now);
	state_move(s, o->last, (size_t)o->ring * sizeof *o->last);
	state_move(s, o->of, orders * sizeof *o->of);
	state_move(s, o->error, orders * (size_t)o->par.window * sizeof *o->error);
}

static const struct observation *observed(const struct order *o, int lag)
{
	return &o->last[(o->now.next - 1 - lag + 2 * o->ring) % o->ring];
}

static int orders_now(const struct order *o)
{
	return o->now.rows < o->par.largest ? (int)o->now.rows : o->par.largest;
}

/* Errors of the forecasts made for the row just taken, from the fits before it. */
static void score(struct order *o, double y, double gap)
{
	double *row = o->error + (size_t)(o->now.rows % o->par.window) *
					 ((size_t)o->par.largest + 1);

	for (int p = GREY_ORDER_MIN; p <= orders_now(o); p++) {
		struct candidate *c = &o->of[p];
		double e;

		if (c->fit.n != p) { /* not fitted: outside the searched range */
			c->since = o->now.rows + 1;
			c->total = 0;
			continue;
		}
		if (o->now.rows <= p)
			c->since = o->now.rows;
		e = y - grey_forecast(&c->fit, gap, gap);
		row[p] = e * e;
		c->total += row[p];
	}
}

/* The trend continues: the mean of the last rows lies farther from the first observation
 * than the mean of the rows before them, on the same side. */
static int goes_on(const struct order *o)
{
	double recent = 0, before = 0;

	if (o->now.rows < 2 * TREND)
		return 0;
	for (int lag = 0; lag < TREND; lag++) {
		recent += observed(o, lag)->y;
		before += observed(o, lag + TREND)->y;
	}
	return (recent - before) * (recent - TREND * o->now.first) > 0;
}

static void fit_orders(struct order *o, int low, int high)
{
	struct grey g = { 0 };
	double gap = 0;

	for (int lag = 0; lag < high; lag++) {
		grey_add(&g, observed(o, lag)->y, gap);
		gap = observed(o, lag)->gap;
		if (g.n < GREY_ORDER_MIN)
			continue;
		o->of[g.n].fit = g;
		if (g.n < low)
			o->of[g.n].fit.n = 0;
	}
	for (int p = high + 1; p <= orders_now(o); p++)
		o->of[p].fit.n = 0;
}

/* Mean squared error of order p over the last rows. */
static double recent_error(const struct order *o, int p, int rows)
{
	double sum = 0;

	for (int k = 0; k < rows; k++)
		sum += o->error[(size_t)((o->now.rows - 1 - k) % o->par.window) *
					((size_t)o->par.largest + 1) +
				(size_t)p];
	return sum / rows;
}

/* Rows over which orders are compared: half of those since the lowest order's first
 * forecast, at most the window. */
static int rows_compared(const struct order *o)
{
	long half = (o->now.rows - GREY_ORDER_MIN + 1) / 2;

	return half < o->par.window ? (int)half : o->par.window;
}

static double criterion(const struct order *o, int p, int rows)
{
	const struct candidate *c = &o->of[p];

	if (o->par.rule == ORDER_INSAMPLE)
		return grey_residual(&c->fit);
	if (c->since > o->now.rows - rows)
		return INFINITY; /* not scored over all of these rows */
	if (o->par.rule == ORDER_ALL && c->since <= o->par.largest)
		return c->total / (double)(o->now.rows - c->since);
	return recent_error(o, p, rows);
}

static void choose(struct order *o, int low, int high)
{
	int rows = rows_compared(o), best = 0;
	double least = INFINITY, held;

	if (o->par.rule == ORDER_FIXED || (rows < 1 && o->par.rule != ORDER_INSAMPLE)) {
		o->now.chosen = high;
		return;
	}
	for (int p = low; p <= high; p++) {
		double e = criterion(o, p, rows);

		if (e < least || !best) {
			least = e;
			best = p;
		}
	}
	if (best == o->now.chosen)
		return;
	held = o->now.chosen >= low && o->now.chosen <= high
		       ? criterion(o, o->now.chosen, rows)
		       : INFINITY;
	if (o->par.rule != ORDER_WINDOW || least < (1 - o->par.hysteresis) * held ||
		!(held < INFINITY)) {
		o->now.counts.changes += o->now.chosen > 0;
		o->now.chosen = best;
	}
}

void order_add(struct order *o, double y, double gap)
{
	int low = GREY_ORDER_MIN, high;

	if (o->par.rule == ORDER_WINDOW || o->par.rule == ORDER_ALL)
		score(o, y, gap);
	if (o->now.rows == 0)
		o->now.first = y;
	o->last[o->now.next] = (struct observation){ y, gap };
	o->now.next = (o->now.next + 1) % o->ring;
	o->now.rows++;
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
		o->now.counts.skipped += (unsigned long)(all - (high - low + 1));
	}
	fit_orders(o, low, high);
	o->now.counts.tried += (unsigned long)(high - low + 1);
	choose(o, low, high);
}

int order_chosen(const struct order *o)
{
	return o->now.chosen;
}

double order_forecast(const struct order *o, double h)
{
	if (o->now.chosen)
		return grey_forecast(&o->of[o->now.chosen].fit, h, h);
	return o->now.rows > 0 ? observed(o, 0)->y : NAN;
}

struct order_counts order_counts(const struct order *o)
{
	return o->now.counts;
}
