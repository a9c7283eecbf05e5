/* formats.h - the field formats behind fields.h: one file each, reader and writer */
#ifndef SHELL_FORMATS_H
#define SHELL_FORMATS_H

#include "io/fields.h"
#include <stdio.h>

/* Where a reader is, for its messages. */
struct place {
	FILE *f;
	const char *name; /* of the stream */
	long record;      /* from 1 */
};

/* Both start behind the magic line and fill an empty record, or die. */
void nrrd_read(const struct place *at, struct record *r);
void gsf_read(const struct place *at, struct record *r);
void nrrd_write(FILE *f, const struct record *r);

/* Layout of raw samples in a stream: points of nfields values, x fastest. */
struct samples {
	int single; /* 4-byte float instead of 8-byte */
	int big_endian;
};

/* Fills all fields of r, whose sizes and names are set; dies where the stream ends
 * before "want N bytes". */
void samples_read(const struct place *at, struct record *r, struct samples layout);

/* One header line without its newline, fresh memory; NULL at the end of the stream.
 * Dies where the header grows past a mebibyte. */
char *header_line(const struct place *at, size_t *header_size);

/* Dies unless nx * ny * nz * nfields points make sense. */
void check_sizes(const struct place *at, const double *sizes, int n);

/* Dies unless the spacing of an axis, in metres, is one that a surface can have. */
void check_spacing(const struct place *at, int axis, double spacing);

/* Adds a field that must not exist yet; memory is not touched. */
void record_new_field(struct record *r, const char *name, const char *unit);

#endif
