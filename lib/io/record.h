/* record.h - fields on one regular grid, with names, units and keys, in memory */
#ifndef IO_RECORD_H
#define IO_RECORD_H

#include "io/keys.h"
#include <stddef.h>

enum { RECORD_FIELDS_MAX = 32 };

struct record {
	int nx, ny, nz;    /* points; nz = 1 for plane fields */
	double dx, dy, dz; /* spacing, m */
	int nfields;
	char *name[RECORD_FIELDS_MAX]; /* "height" */
	char *unit[RECORD_FIELDS_MAX]; /* "m" */
	/* Planar: data[k][(iz * ny + iy) * nx + ix]; NULL: not kept (fields.h). */
	double *data[RECORD_FIELDS_MAX];
	long realisation; /* from the key, else the place in the stream from 0 */
	char *cmd;        /* pipeline that rebuilds this record; NULL if unknown */
	struct keys keys; /* other key:=value pairs, carried through */
	/* Memory of earlier fields, each of so many points, for the next ones. */
	double *spare[RECORD_FIELDS_MAX];
	int spares;
	size_t spare_points;
};

/* A record without fields; frees what r held. */
void record_init(struct record *r, int nx, int ny, double dx, double dy);
void record_free(struct record *r);
/* Empties it, but keeps the memory of its fields for the fields of the next record: in a
 * long stream the system would otherwise clear the same pages for each. */
void record_clear(struct record *r);
/* nx ny nz. */
size_t record_points(const struct record *r);
/* Index of a field, -1 if absent. */
int record_find(const struct record *r, const char *name);
/* A zeroed new field, or the existing one of that name. */
double *record_add(struct record *r, const char *name, const char *unit);
/* A field of that name, which must not exist yet, whose samples are still to be set. */
void record_new_field(struct record *r, const char *name, const char *unit);
/* The same without room for samples. */
void record_name_field(struct record *r, const char *name, const char *unit);
/* Drops a field. */
void record_drop(struct record *r, const char *name);
/* Keys; record_get returns NULL if absent. */
void record_set(struct record *r, const char *key, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
/* Adds a reason to the key "doubtful", which programs that read the record repeat. */
void record_doubt(struct record *r, const char *why);
void record_drop_key(struct record *r, const char *key);
const char *record_get(const struct record *r, const char *key);
/* Copies the realisation and all keys but cmd. */
void record_copy_keys(struct record *to, const struct record *from);
double record_get_number(const struct record *r, const char *key); /* NAN if absent */

#endif
