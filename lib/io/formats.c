#include "io/formats.h"
#include "cli/msg.h"
#include "io/bytes.h"
#include "io/crc32.h"
#include "io/kinds.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER_MAX = 1 << 20 };

const char mark_key[] = "stream:=", mark_zeros[] = "00000000";

/* Adds a line to the checksum, with zeros for the digits of a mark. */
static void sum_line(struct place *at, const char *line, size_t n)
{
	size_t key = strlen(mark_key), digits = strlen(mark_zeros);

	if (strncmp(line, mark_key, key) || n < key + digits + 1) {
		at->checksum = crc32_add(at->checksum, line, n);
		return;
	}
	at->checksum = crc32_add(at->checksum, line, n - digits - 1);
	at->checksum = crc32_add(at->checksum, mark_zeros, digits);
	at->checksum = crc32_add(at->checksum, line + n - 1, 1);
}

char *header_line(struct place *at, size_t *header_size)
{
	size_t most = input_limit("header", HEADER_MAX), room = 0, n;
	char *line = NULL;

	n = *header_size < most ? input_line(at->in, &line, &room, most - *header_size)
				: 1;
	if (*header_size + n > most)
		die(EXIT_RUN, "%s: record %ld: header longer than %zu bytes", at->name,
			at->record, most);
	if (n == 0 || line[n - 1] != '\n') {
		if (*header_size == 0 && at->record == 1)
			kind_refuse(at->name, line, n, KIND_FIELD);
		free(line);
		return NULL;
	}
	*header_size += n;
	sum_line(at, line, n);
	line[--n] = '\0';
	if (n && line[n - 1] == '\r')
		line[--n] = '\0';
	return line;
}

void check_sizes(const struct place *at, const double *sizes, int n)
{
	double all = 8, most = (double)input_limit("bytes", (size_t)1e15);

	for (int i = 0; i < n; i++) {
		if (!(sizes[i] >= 1 && sizes[i] <= 1e9) || sizes[i] != floor(sizes[i]))
			die(EXIT_RUN,
				"%s: record %ld: size %g, want a whole number from 1 to 1e9",
				at->name, at->record, sizes[i]);
		all *= sizes[i];
	}
	if (all > most)
		die(EXIT_RUN, "%s: record %ld: %g bytes of samples are too many",
			at->name, at->record, all);
}

void check_spacing(const struct place *at, int axis, double spacing)
{
	if (!(spacing >= 1e-30 && spacing <= 1e30))
		die(EXIT_RUN,
			"%s: record %ld: spacing of axis %d is %g m, want 1e-30 to 1e30",
			at->name, at->record, axis, spacing);
}

/* A regular file must have the length that its header declares: checked before memory is
 * allocated. */
static void check_length(const struct place *at, uint64_t want)
{
	uint64_t left = input_left(at->in);

	if (left < want)
		die(EXIT_RUN, "%s: record %ld: want %llu bytes, got %llu", at->name,
			at->record, (unsigned long long)want, (unsigned long long)left);
}

static double sample(const unsigned char *b, struct samples layout)
{
	if (layout.single)
		return (double)bytes_float(
			layout.big_endian ? bytes_u32_big(b) : bytes_u32_little(b));
	return layout.big_endian ? bytes_double_big(b) : bytes_double_little(b);
}

void samples_read(struct place *at, struct record *r, struct samples layout)
{
	size_t width = layout.single ? 4 : 8, nf = (size_t)r->nfields, nx = (size_t)r->nx;
	size_t row_size = nx * nf * width, rows = (size_t)r->ny * (size_t)r->nz;
	unsigned char *row = xcalloc(row_size, 1);

	check_length(at, (uint64_t)row_size * rows);
	for (size_t iy = 0; iy < rows; iy++) {
		size_t got = input_read(at->in, row, row_size);

		at->checksum = crc32_add(at->checksum, row, got);
		if (got < row_size)
			die(EXIT_RUN, "%s: record %ld: want %zu bytes, got %zu", at->name,
				at->record, row_size * rows, row_size * iy + got);
		for (size_t k = 0; k < nf; k++)
			for (size_t ix = 0; ix < nx; ix++)
				r->data[k][iy * nx + ix] =
					sample(row + (ix * nf + k) * width, layout);
	}
	free(row);
}
