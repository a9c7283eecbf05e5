/* reasons.h - why a stream is doubtful by its own account: each reason once, as one text
 */
#ifndef IO_REASONS_H
#define IO_REASONS_H

#include "io/keys.h"

struct reasons {
	struct keys all; /* without values */
	char *text;
};

/* Copies it; NULL: there is none. */
void reasons_add(struct reasons *r, const char *why);
/* The first eight, and the number of the others; NULL if there is none.  Valid until the
 * next call and reasons_free(). */
const char *reasons_text(struct reasons *r);
/* Warns of a stream that is doubtful for these reasons, and returns them; NULL: it is
 * not. */
const char *reasons_tell(const char *name, const char *why);
/* The same as reasons_text(), with a warning that names the stream. */
const char *reasons_warn(struct reasons *r, const char *name);
void reasons_free(struct reasons *r);

#endif
