/* nrrd.h - records in NRRD with attached header; see wearpipe-streams(5) */
#ifndef IO_NRRD_H
#define IO_NRRD_H

#include "io/formats.h"
#include <stdio.h>

/* 1 for the first line of such a record, without its newline. */
int nrrd_is(const char *magic);
/* Starts behind that line and fills an empty record, or dies. */
void nrrd_read(struct place *at, struct record *r);
/* number: of the record in its stream, from 1; last: none follows.  pool: shares the work
 * on samples, or NULL. */
void nrrd_write(
	FILE *f, const struct record *r, long number, int last, struct pool *pool);

#endif
