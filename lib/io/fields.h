/* fields.h - streams of field records (height, pressure, ...) on a regular grid
 *
 * Writes NRRD as described in wearpipe-streams(5).  Reads that, plain 2-D NRRD (one
 * field, float or double, either endian), Gwyddion Simple Field, and headerless little-
 * endian float64 when a raw layout is given.  A stream holds any number of records; an
 * incomplete one ends the program with a message that names file and record.
 *
 *	struct fields_in *in = fields_open(path, NULL);
 *	struct record r = { 0 };
 *	while (fields_read(in, &r)) {
 *		double *h = record_need(&r, "height", in);
 *		double *p = record_add(&r, "pressure", "Pa");
 *		...
 *		fields_write(out, &r, fields_more(in));
 *	}
 *	record_free(&r);
 *	fields_close(in);
 */
#ifndef IO_FIELDS_H
#define IO_FIELDS_H

#include "io/input.h"
#include "io/record.h"
#include "num/pool.h"

/* Headerless input: sizes must be known beforehand. */
struct raw_layout {
	int nx, ny, nz;
	double dx, dy, dz;
	const char *fields; /* of a point, side by side: "height m, pressure Pa"; NULL: a
			     * height */
};

struct fields_in;
struct fields_out;

/* path NULL or "-" is standard input; raw NULL unless the data are headerless. */
struct fields_in *fields_open(const char *path, const struct raw_layout *raw);
struct fields_in *fields_from(struct input *in); /* takes ownership of an open input */
/* Threads to convert and sum samples with; without it the caller does. */
void fields_read_with(struct fields_in *in, struct pool *pool);
/* Does not keep a field, but dies where it is not finite: record_need() gives NULL. */
void fields_only_check(struct fields_in *in, const char *name);
/* 1 if all records read so far stated whether another one follows. */
int fields_marked(const struct fields_in *in);
/* 1 if a record follows, or is promised. */
int fields_more(struct fields_in *in);
/* 1 if the last record stated that it is the last one; does not wait for the input. */
int fields_last(const struct fields_in *in);
/* Fills r, whose old contents are freed or reused; 0 at the end of the stream.  Dies if
 * the stream has no record: the program that should have written it failed. */
int fields_read(struct fields_in *in, struct record *r);
const char *fields_name(const struct fields_in *in); /* for messages: "surf.nrrd" */
long fields_count(const struct fields_in *in);       /* records read so far */
/* Why records read so far are doubtful, as their keys "doubtful" say, all that differ as
 * one text, with a warning; NULL if none is.  Valid until the next call and
 * fields_close(). */
const char *fields_doubted(struct fields_in *in);
void fields_close(struct fields_in *in);

/* path NULL is standard output, which must not be a terminal. */
struct fields_out *fields_create(const char *path);
void fields_write_with(struct fields_out *out, struct pool *pool);
/* Writes and flushes one record with all its fields; more: another record will follow,
 * and a reader that does not find it reports an error.  Values must be finite unless they
 * are missing samples (nan). */
void fields_write(struct fields_out *out, const struct record *r, int more);
void fields_done(struct fields_out *out); /* checks that all was written; frees */

/* The samples of a field; dies naming file, record and field where it is absent or,
 * with finite != 0, where a sample is not finite. */
double *record_need(
	const struct record *r, const char *name, int finite, const struct fields_in *in);

#endif
