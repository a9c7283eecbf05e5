/* raw_layout.h - samples without a header: options of every program that reads heights */
#ifndef RAW_H
#define RAW_H

#include "cli/opt.h"
#include "io/fields.h"

extern struct opt raw_rows[]; /* for OPT_TABLE */

/* Layout that was given, for fields_open(); NULL if the stream has headers.  Dies
 * where one option lacks the other. */
const struct raw_layout *raw_given(void);

#endif
