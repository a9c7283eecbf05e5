/* raw_layout.h - samples without a header: options of every program that reads fields */
#ifndef RAW_LAYOUT_H
#define RAW_LAYOUT_H

#include "cli/opt.h"
#include "io/fields.h"

/* For OPT_TABLE: of planes, and of fields that may have layers. */
extern struct opt raw_rows[], raw_layer_rows[];

/* Layout that was given, for fields_open(); NULL if the stream has headers.  Dies
 * where one option lacks the other. */
const struct raw_layout *raw_given(void);

#endif
