/* renewal.h - separate.h over a record whose instrument may change
 *
 * A change of the flow, the gain or the noise ends the stretch that one instrument
 * describes.  Where the rows cease to fit, by the cumulative sum test of Page (Continuous
 * inspection schemes, Biometrika 41, 1954, 100-115), the instrument is learned again from
 * there on; where what it is learned from is not described, from half of that.  Such a
 * stretch takes the place of the rows that did not fit if its own rows do.
 *
 * Rows that may be replaced are held back.  An instrument that is kept, and sections that
 * are reported, are those of one stretch.
 */
#ifndef SIGNAL_RENEWAL_H
#define SIGNAL_RENEWAL_H

#include "signal/separate/separate.h"

struct renewal;
/* As those of separate.h. */
struct renewal *renewal_new(const struct separate_par *par); /* NULL: no memory */
void renewal_free(struct renewal *r);
enum separate_status renewal_push(struct renewal *r, const double *x, size_t n);
enum separate_status renewal_end(struct renewal *r);
int renewal_next(struct renewal *r, struct transit *p);

/* The present stretch, whose counters are those of the whole record.  Any of the
 * functions above may replace it. */
struct separate *renewal_now(const struct renewal *r);
/* Frames at which the instrument was learned anew, but for the first; *n of them. */
const long long *renewal_changes(const struct renewal *r, size_t *n);

#endif
