/* fields.h - streams of field records (height, pressure, ...) on a regular grid
 *
 * Writes NRRD as wearpipe-streams(5) says.  Reads that, plain 2-D NRRD (one field,
 * float or double, either endian), Gwyddion Simple Field, and headerless little-
 * endian float64 when a raw layout is given.  Records follow one another; each is
 * whole or the program dies naming file, record and what was wanted.
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
#ifndef SHELL_FIELDS_H
#define SHELL_FIELDS_H

#include "io/input.h"
#include "io/keys.h"
#include <stdint.h>
#include <stdio.h>

enum { RECORD_FIELDS_MAX = 32 };

struct record {
	int nx, ny, nz;    /* points; nz = 1 for plane fields */
	double dx, dy, dz; /* spacing, m */
	int nfields;
	char *name[RECORD_FIELDS_MAX];   /* "height" */
	char *unit[RECORD_FIELDS_MAX];   /* "m" */
	double *data[RECORD_FIELDS_MAX]; /* planar: data[k][(iz * ny + iy) * nx + ix] */
	long realisation; /* from the key, else the place in the stream from 0 */
	char *cmd;        /* pipeline that rebuilds this record; NULL if unknown */
	struct keys keys; /* other key:=value pairs, carried through */
};

/* Headerless input: sizes must be known beforehand. */
struct raw_layout {
	int nx, ny;
	double dx, dy;
};

struct fields_in;
struct fields_out;

/* path NULL or "-" is standard input; raw NULL unless the data are headerless. */
struct fields_in *fields_open(const char *path, const struct raw_layout *raw);
struct fields_in *fields_from(struct input *in); /* takes an open input over */
/* 1 where all records read so far said whether another one follows. */
int fields_marked(const struct fields_in *in);
/* 1 where a record follows, or is promised. */
int fields_more(struct fields_in *in);
/* Fills r, whose old contents are freed or reused; 0 at the end of the stream.  A stream
 * without any record dies: what should have written it failed. */
int fields_read(struct fields_in *in, struct record *r);
const char *fields_name(const struct fields_in *in); /* for messages: "surf.nrrd" */
long fields_count(const struct fields_in *in);       /* records read so far */
void fields_close(struct fields_in *in);

/* path NULL is standard output, which must not be a terminal. */
struct fields_out *fields_create(const char *path);
/* Writes and flushes one record with all its fields; more: another one will follow, and a
 * reader that does not find it says so.  Values must be finite unless they are missing
 * samples (nan). */
void fields_write(struct fields_out *out, const struct record *r, int more);
/* Gwyddion Simple Field (float32) of one field, for tools that want it. */
void fields_write_gsf(FILE *out, const struct record *r, int field);
void fields_done(struct fields_out *out); /* checks that all was written; frees */

/* A record without fields; frees what r held. */
void record_init(struct record *r, int nx, int ny, double dx, double dy);
void record_free(struct record *r);
/* Index of a field, -1 if absent. */
int record_find(const struct record *r, const char *name);
/* The samples of a field; dies naming file, record and field where it is absent or,
 * with finite != 0, where a sample is not finite. */
double *record_need(
	const struct record *r, const char *name, int finite, const struct fields_in *in);
/* A zeroed new field, or the existing one of that name. */
double *record_add(struct record *r, const char *name, const char *unit);
/* Drops a field. */
void record_drop(struct record *r, const char *name);
/* Keys; record_get returns NULL where absent. */
void record_set(struct record *r, const char *key, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
const char *record_get(const struct record *r, const char *key);
/* Copies the realisation and all keys but cmd. */
void record_copy_keys(struct record *to, const struct record *from);
double record_get_number(const struct record *r, const char *key); /* NAN where absent */

#endif
