/* order.c - see order.h */
#include "life/grey/order.h"
#include "life/grey/grey.h"
#include <math.h>
#include <stdlib.h>

enum { WINDOW = 50 }; /* rows over which errors are averaged */

struct order {
	struct order_par par;
	struct order_state {
		int chosen;
		long rows; /* observations so far */
		struct order_counts counts;
	} now;
	struct observation {
		double y, gap; /* since the one before */
	} * last;              /* [largest], a ring */
	struct grey *fit;      /* [largest + 1], of the points that end at the newest */
	double *error;         /* [WINDOW][largest + 1] squared errors of the last rows */
};

struct order *order_new(const struct order_par *par)
{
	struct order *o = calloc(1, sizeof *o);
	size_t orders = (size_t)par->largest + 1;

	if (!o)
		return NULL;
	o->par = *par;
	o->last = calloc((size_t)par->largest, sizeof *o->last);
	o->fit = calloc(orders, sizeof *o->fit);
	o->error = calloc(orders * WINDOW, sizeof *o->error);
	if (o->last && o->fit && o->error)
		return o;
	order_free(o);
	return NULL;
}

void order_free(struct order *o)
{
	if (!o)
		return;
	free(o->last);
	free(o->fit);
	free(o->error);
	free(o);
}

void order_pass(struct order *o, struct state *s)
{
	size_t orders = (size_t)o->par.largest + 1;

	state_move(s, &o->now, sizeof o->now);
	state_move(s, o->last, (size_t)o->par.largest * sizeof *o->last);
	state_move(s, o->fit, orders * sizeof *o->fit);
	state_move(s, o->error, orders * WINDOW * sizeof *o->error);
}

static int orders_now(const struct order *o)
{
	return o->now.rows < o->par.largest ? (int)o->now.rows : o->par.largest;
}

/* Squared errors of all orders at a row of the last. */
static double *errors_at(const struct order *o, long row)
{
	return o->error + (size_t)(row % WINDOW) * ((size_t)o->par.largest + 1);
}

/* Errors of the forecasts made for the row just taken, from the fits before it. */
static void score(struct order *o, double y, double gap)
{
	double *error = errors_at(o, o->now.rows);

	for (int p = 1; p <= orders_now(o); p++) {
		double e = y - grey_forecast(&o->fit[p], gap, gap);

		error[p] = e * e;
	}
}

static void fit_orders(struct order *o, int low, int high)
{
	struct grey g = { 0 };
	double gap = 0;

	for (int lag = 0; lag < high; lag++) {
		const struct observation *one =
			&o->last[(o->now.rows - 1 - lag) % o->par.largest];

		grey_add(&g, one->y, gap);
		gap = one->gap;
		if (g.n >= low)
			o->fit[g.n] = g;
	}
	o->now.counts.tried += (unsigned long)(high - low + 1);
}

/* Order p has made its first forecast for row p. */
static double criterion(const struct order *o, int p, int rows)
{
	double sum = 0;

	if (o->par.rule == ORDER_INSAMPLE)
		return grey_residual(&o->fit[p]);
	if (p > o->now.rows - rows)
		return INFINITY; /* not scored over all of these rows */
	for (int k = 1; k <= rows; k++)
		sum += errors_at(o, o->now.rows - k)[p];
	return sum / rows;
}

/* Orders are compared over half of the rows, at most the window.  Residuals tell nothing
 * of the curves that pass through all points. */
static void choose(struct order *o, int high)
{
	int lowest = o->par.rule == ORDER_WINDOW ? 1 : GREY_ORDER_MIN, best = 0;
	long half = o->now.rows / 2;
	double least = INFINITY;

	if (o->par.rule == ORDER_FIXED || high <= lowest) {
		o->now.chosen = high;
		return;
	}
	for (int p = lowest; p <= high; p++) {
		double e = criterion(o, p, half < WINDOW ? (int)half : WINDOW);

		if (e < least || !best) {
			least = e;
			best = p;
		}
	}
	o->now.counts.changes += best != o->now.chosen;
	o->now.chosen = best;
}

void order_add(struct order *o, double y, double gap)
{
	int high;

	if (o->par.rule == ORDER_WINDOW)
		score(o, y, gap);
	o->last[o->now.rows++ % o->par.largest] = (struct observation){ y, gap };
	high = orders_now(o);
	fit_orders(o, o->par.rule == ORDER_FIXED ? high : 1, high);
	choose(o, high);
}

int order_chosen(const struct order *o)
{
	return o->now.chosen;
}

double order_forecast(const struct order *o, double h)
{
	return o->now.rows > 0 ? grey_forecast(&o->fit[o->now.chosen], h, h) : NAN;
}

struct order_counts order_counts(const struct order *o)
{
	return o->now.counts;
}
