/* formats.h - functions shared by the formats of fields: each format has its own file and
 * a row in the table of fields.c */
#ifndef IO_FORMATS_H
#define IO_FORMATS_H

#include "io/input.h"
#include "io/record.h"
#include "num/pool.h"
#include <stdint.h>

/* The end mark of a record of wearpipe. */
struct mark {
	long number; /* of the record in its stream, from 1; 0: no mark */
	int last;
	uint32_t checksum; /* of the record with zeros for its digits */
};

/* Where a reader is, for its messages. */
struct place {
	struct input *in;
	struct pool *pool;  /* that shares the work on samples, or NULL */
	const char *unkept; /* a field that is only checked, or NULL */
	const char *name;   /* of the stream */
	long record;        /* from 1 */
	uint32_t checksum;  /* of the bytes of this record so far */
	struct mark mark;
};

/* Layout of raw samples in a stream: points of nfields values, x fastest. */
struct samples {
	int single; /* 4-byte float instead of 8-byte */
	int big_endian;
};

/* Samples are converted and summed in parts, several of them in memory at a time:
 *
 *	parts_begin(&p, points, width);
 *	while ((n = parts_next(&p)) > 0) {
 *		... n jobs: part_points(&p, k) points at part_bytes(&p, k), the first
 *		of them point p.first + k * PART_POINTS of the record; p.checksum[k]
 *		checksum = parts_sum(&p, checksum);
 *	}
 *	parts_end(&p);
 *
 * Parts of 1024 to 16384 points take the same time. */
enum { PART_POINTS = 4096, PARTS = 8 };

struct parts {
	size_t all, first, points; /* of the record; before these parts; in them */
	size_t width;              /* bytes of a point */
	unsigned char *bytes;
	uint32_t checksum[PARTS]; /* of each alone */
};

void parts_begin(struct parts *p, size_t points, size_t width);
size_t parts_next(struct parts *p);
size_t part_points(const struct parts *p, size_t k);
unsigned char *part_bytes(const struct parts *p, size_t k);
uint32_t parts_sum(const struct parts *p, uint32_t checksum);
void parts_end(struct parts *p);

/* Dies where one of n samples from point first on is not finite. */
void check_finite(const struct place *at, const struct record *r, const char *name,
	const double *sample, size_t n, size_t first);

/* Fills all fields of r, whose sizes and names are set; dies where the stream ends
 * before "want N bytes". */
void samples_read(struct place *at, struct record *r, struct samples layout);

/* Adds n fields by names and units, "height m, pressure Pa"; NULL: a single one is a
 * height in metres. */
void name_fields(const struct place *at, const char *fields, struct record *r, int n);

/* One header line without its newline, fresh memory; NULL at the end of the stream.
 * Dies where the header grows past a mebibyte. */
char *header_line(struct place *at, size_t *header_size);

/* The header line of the mark begins with mark_key; its checksum, at the end, covers the
 * record with mark_zeros in place of its own digits. */
extern const char mark_key[], mark_zeros[];

/* Dies unless each size is at least 1 and the record fits into memory. */
void check_sizes(const struct place *at, const double *sizes, int n);

/* Warns if a file, of which it is the first record, does not state units of lengths. */
void warn_units(const struct place *at, int spacings, int heights);

/* Dies unless the spacing of an axis, in metres, is one that a surface can have. */
void check_spacing(const struct place *at, int axis, double spacing);

#endif
