/* source.h - records from a stream of fields, or from the table that --output table made
 */
#ifndef SOURCE_H
#define SOURCE_H

#include "io/fields.h"

struct source;

struct source *source_open(const char *path, const struct raw_layout *raw);
/* As fields_read() and its like. */
int source_read(struct source *s, struct record *r);
int source_more(struct source *s);
const char *source_name(const struct source *s);
long source_count(const struct source *s);
void source_close(struct source *s);

/* Columns of such a table before those of the fields. */
#define SOURCE_COLUMNS "realisation x y z"
enum { SOURCE_BEFORE = 4 };

#endif
