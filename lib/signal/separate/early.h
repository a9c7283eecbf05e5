/* early.h - separate.h, with rows of a live record before all of it is there that the
 * instrument is learned from
 *
 * Another separation learns the instrument from the first samples alone.  If these show
 * it clearly, its rows are given up to the first that is not a pulse that stands alone.
 * The instrument is learned, and all samples are separated, as by separate.h; the rows of
 * what was given before are then left out.
 */
#ifndef SIGNAL_EARLY_H
#define SIGNAL_EARLY_H

#include "signal/separate/renewal.h"

struct early;
/* As separate_new(); no row is early if par tells how much is learned from, or more than
 * the first samples do: a kept instrument or a filter. */
struct early *early_new(const struct separate_par *par); /* NULL: no memory */
void early_free(struct early *e);

/* As those of separate.h. */
enum separate_status early_push(struct early *e, const double *x, size_t n);
enum separate_status early_end(struct early *e);
int early_next(struct early *e, struct transit *p);

/* What separates all samples. */
const struct renewal *early_whole(const struct early *e);

#endif
