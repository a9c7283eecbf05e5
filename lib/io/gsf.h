/* gsf.h - records in Gwyddion Simple Field 1.0: one float32 field */
#ifndef IO_GSF_H
#define IO_GSF_H

#include "io/formats.h"
#include <stdio.h>

/* 1 for the first line of such a record, without its newline. */
int gsf_is(const char *magic);
/* Starts behind that line and fills an empty record, or dies. */
void gsf_read(struct place *at, struct record *r);
void gsf_write(FILE *f, const struct record *r, int field);

#endif
