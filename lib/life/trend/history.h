/* history.h - a series of any length in bounded memory
 *
 * Keeps up to HISTORY_MAX means of equal numbers of successive rows; when full,
 * neighbours are merged two by two.  Short series are kept as they are.
 */
#ifndef LIFE_HISTORY_H
#define LIFE_HISTORY_H

#include "num/state.h"

enum { HISTORY_MAX = 512 };

struct history;

struct history *history_new(void); /* NULL when out of memory */
void history_free(struct history *h);
void history_pass(struct history *h, struct state *s);
void history_clear(struct history *h);
void history_add(struct history *h, double t, double x);
/* The whole groups, oldest first, and after them the rows of the last, unfinished one
 * as a group of its own.  Returns their number; the arrays stay valid until the next
 * row. */
int history_get(struct history *h, const double **t, const double **x);

#endif
