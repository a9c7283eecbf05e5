/* formats_in.h - heights in the formats of instruments and of numpy
 *
 * Each reader takes a whole file in memory, fills a record with the field "height" in
 * metres, missing samples nan, or dies with a message that names the file and the error.
 */
#ifndef FORMATS_IN_H
#define FORMATS_IN_H

#include "io/fields.h"
#include <stddef.h>

enum in_format { IN_AUTO, IN_TEXT, IN_NPY, IN_SDF, IN_SUR, IN_AL3D, IN_RAW };
enum sample_type { FLOAT64, FLOAT32, INT32, INT16, UINT16, UINT8, INT64, UINT32, INT8 };

struct content {
	const char *name;
	char *data; /* size bytes and a NUL */
	size_t size;
};

/* Values from the command line; nan and 0 if not given. */
struct told {
	enum in_format format;
	double dx, dy, unit, missing;
	int profile;
	int nx, ny;
	enum sample_type type;
	int big_endian;
	size_t skip;
};

void formats_read(const struct content *c, const struct told *told, struct record *r);

/* For the readers. */
void text_read(const struct content *c, const struct told *told, struct record *r);

/* 1 if the text is a mark of a missing sample, such as BAD. */
int is_gap(const char *text);

/* A unit of length by its name, "um", "microns", in m; NAN if it is none. */
double unit_named(const char *name, size_t length);

/* Spacing and unit, of the command line or of the file; a contradiction dies, and so does
 * silence of both. */
void settle_pixel(
	const struct content *c, const struct told *told, double *dx, double *dy);
double settle_unit(const struct content *c, const struct told *told, double from_file);
/* An empty record of this size. */
double *new_heights(const struct content *c, double nx, double ny, double dx, double dy,
	struct record *r);

#endif
