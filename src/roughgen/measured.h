/* measured.h - measured surfaces made ready for use: options of roughgen
 *
 *	struct measured *m = measured_open(path);
 *	while (measured_next(m, &r, &crown))
 *		...
 *	measured_close(m);
 */
#ifndef MEASURED_H
#define MEASURED_H

#include "cli/opt.h"
#include "io/fields.h"

extern struct opt measured_rows[]; /* for OPT_TABLE; what needs a file */

struct measured;

struct measured *measured_open(const char *path);
/* The heights of the next record, cropped, filled, levelled, resampled and scaled as
 * the options want.  An existing crown is subtracted and its drop returned.  0 at the
 * end; dies where there was no record at all. */
int measured_next(struct measured *m, struct record *r, double *crown);
int measured_more(struct measured *m); /* 1 if a record follows, or is promised */
/* Why the records are doubtful by their own account, with a warning; NULL: they are not.
 */
const char *measured_doubted(struct measured *m);
void measured_close(struct measured *m);

#endif
