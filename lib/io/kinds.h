/* kinds.h - what a stream of the wrong kind is, by its first bytes */
#ifndef IO_KINDS_H
#define IO_KINDS_H

#include <stddef.h>

enum stream_kind { KIND_OTHER, KIND_FIELD, KIND_SIGNAL, KIND_TABLE };

/* Dies with "this is a signal (AU), want ..." if the n bytes begin a recognised stream of
 * another kind. */
void kind_refuse(const char *name, const void *bytes, size_t n, enum stream_kind wanted);

#endif
