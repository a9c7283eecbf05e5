/* order.h - selection of the order of the grey model with the best forecasts
 *
 * Every order from 1 to the largest forecasts each observation from the ones before it
 * (one backward pass, O(1) per order), so the choice depends on the observations alone
 * and not on random numbers.  Orders 1 and 2 forecast the newest one itself, which is
 * best where no exponential describes the series, as with rows at a constant ratio of
 * their ages.  Rules:
 *
 *   window    smallest mean squared error over the last 50 rows at most, all orders over
 *             the same rows
 *   insample  smallest mean squared residual of the fit itself, from order 4 on
 *   fixed     always the largest order
 */
#ifndef LIFE_ORDER_H
#define LIFE_ORDER_H

#include "num/state.h"

enum order_rule { ORDER_WINDOW, ORDER_INSAMPLE, ORDER_FIXED };

struct order_par {
	enum order_rule rule;
	int largest; /* largest order P >= 4, or the fixed order */
};

struct order;

struct order *order_new(const struct order_par *par); /* NULL when out of memory */
void order_free(struct order *o);
void order_pass(struct order *o, struct state *s);

/* Takes the observation made gap steps after the last one: scores the forecasts made
 * for it, then makes those for the next and chooses an order. */
void order_add(struct order *o, double y, double gap);
int order_chosen(const struct order *o); /* 0 without observations */
/* The chosen order's forecast h steps ahead from the observations alone. */
double order_forecast(const struct order *o, double h);
/* Orders fitted so far, and changes of the order. */
struct order_counts {
	unsigned long tried, changes;
};
struct order_counts order_counts(const struct order *o);

#endif
