/* history.h - a series of any length in bounded memory
 *
 * Keeps up to HISTORY_MAX means of equal numbers of successive rows; when it is full,
 * neighbours are merged in pairs.  Shorter series are kept unchanged.
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
/* The complete groups, oldest first, then the incomplete last one.  Returns their number;
 * the arrays stay valid until the next row. */
int history_get(struct history *h, const double **t, const double **x);

#endif
