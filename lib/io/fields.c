#include "io/fields.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "io/bytes.h"
#include "io/crc32.h"
#include "io/ends.h"
#include "io/formats.h"
#include "io/kinds.h"
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { HEADER_MAX = 1 << 20 };

struct fields_in {
	struct place at;
	struct raw_layout raw;
	int is_raw;
	long unmarked; /* records that did not say whether another one follows */
};

struct fields_out {
	FILE *f;
	const char *name;
	long records; /* of the stream that is being written */
	int open;     /* another record was promised */
};

/* Records */

void record_free(struct record *r)
{
	for (int i = 0; i < r->nfields; i++) {
		free(r->name[i]);
		free(r->unit[i]);
		free(r->data[i]);
	}
	keys_free(&r->keys);
	free(r->cmd);
	*r = (struct record){ 0 };
}

void record_init(struct record *r, int nx, int ny, double dx, double dy)
{
	record_free(r);
	r->nx = nx;
	r->ny = ny;
	r->nz = 1;
	r->dx = dx;
	r->dy = dy;
}

int record_find(const struct record *r, const char *name)
{
	for (int i = 0; i < r->nfields; i++)
		if (strcmp(r->name[i], name) == 0)
			return i;
	return -1;
}

static size_t points(const struct record *r)
{
	return (size_t)r->nx * (size_t)r->ny * (size_t)r->nz;
}

void record_new_field(struct record *r, const char *name, const char *unit)
{
	if (r->nfields == RECORD_FIELDS_MAX)
		die(EXIT_RUN, "more than %d fields in a record", RECORD_FIELDS_MAX);
	r->name[r->nfields] = xstrdup(name);
	r->unit[r->nfields] = xstrdup(unit);
	r->data[r->nfields++] = xcalloc(points(r), sizeof(double));
}

double *record_add(struct record *r, const char *name, const char *unit)
{
	int i = record_find(r, name);

	if (i < 0) {
		record_new_field(r, name, unit);
		i = r->nfields - 1;
	}
	return r->data[i];
}

void record_drop(struct record *r, const char *name)
{
	int i = record_find(r, name);

	if (i < 0)
		return;
	free(r->name[i]);
	free(r->unit[i]);
	free(r->data[i]);
	for (r->nfields--; i < r->nfields; i++) {
		r->name[i] = r->name[i + 1];
		r->unit[i] = r->unit[i + 1];
		r->data[i] = r->data[i + 1];
	}
}

double *record_need(
	const struct record *r, const char *name, int finite, const struct fields_in *in)
{
	int k = record_find(r, name);
	size_t n = points(r);

	if (k < 0)
		die(EXIT_RUN, "%s: record %ld: no field '%s', want %s", in->at.name,
			in->at.record, name, opt_reads());
	for (size_t i = 0; finite && i < n; i++)
		if (!isfinite(r->data[k][i]))
			die(EXIT_RUN,
				"%s: record %ld: %s is %g at x %zu, y %zu; want finite samples",
				in->at.name, in->at.record, name, r->data[k][i],
				i % (size_t)r->nx, i / (size_t)r->nx % (size_t)r->ny);
	return r->data[k];
}

void record_set(struct record *r, const char *key, const char *format, ...)
{
	char value[4096];
	va_list ap;
	int n;

	va_start(ap, format);
	n = vsnprintf(value, sizeof value, format, ap);
	va_end(ap);
	if (n < 0 || (size_t)n >= sizeof value)
		die(EXIT_RUN, "value of key %s is longer than %zu bytes", key,
			sizeof value);
	keys_set(&r->keys, key, value);
}

const char *record_get(const struct record *r, const char *key)
{
	return keys_get(&r->keys, key);
}

void record_copy_keys(struct record *to, const struct record *from)
{
	to->realisation = from->realisation;
	for (int i = 0; i < from->keys.n; i++)
		keys_set(&to->keys, from->keys.key[i], from->keys.value[i]);
}

double record_get_number(const struct record *r, const char *key)
{
	const char *text = record_get(r, key);
	char *end;
	double v;

	if (!text)
		return NAN;
	v = strtod(text, &end);
	return end == text || *end ? NAN : v;
}

/* What the formats share */

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
	double all = 8;

	for (int i = 0; i < n; i++) {
		if (!(sizes[i] >= 1 && sizes[i] <= 1e9) || sizes[i] != floor(sizes[i]))
			die(EXIT_RUN,
				"%s: record %ld: size %g, want a whole number from 1 to 1e9",
				at->name, at->record, sizes[i]);
		all *= sizes[i];
	}
	if (all > 1e15)
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

/* A regular file must hold what its header declares: said before memory is taken. */
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

/* Streams of records */

struct fields_in *fields_from(struct input *input)
{
	struct fields_in *in = xcalloc(1, sizeof *in);

	in->at.in = input;
	in->at.name = input_name(input);
	return in;
}

struct fields_in *fields_open(const char *path, const struct raw_layout *raw)
{
	struct fields_in *in = fields_from(input_open(path));

	if (raw) {
		in->raw = *raw;
		in->is_raw = 1;
	}
	return in;
}

static void read_raw(struct fields_in *in, struct record *r)
{
	r->nx = in->raw.nx;
	r->ny = in->raw.ny;
	r->nz = 1;
	r->dx = in->raw.dx;
	r->dy = in->raw.dy;
	record_new_field(r, "height", "m");
	samples_read(&in->at, r, (struct samples){ 0, 0 });
}

static void read_formatted(struct fields_in *in, struct record *r)
{
	size_t size = 0;
	char *magic = header_line(&in->at, &size);

	if (magic && strncmp(magic, "NRRD000", 7) == 0 && strlen(magic) == 8)
		nrrd_read(&in->at, r);
	else if (magic && strcmp(magic, "Gwyddion Simple Field 1.0") == 0)
		gsf_read(&in->at, r);
	else {
		if (magic && in->at.record == 1)
			kind_refuse(in->at.name, magic, strlen(magic), KIND_FIELD);
		die(EXIT_RUN, "%s: record %ld: want NRRD or GSF, got '%.8s'", in->at.name,
			in->at.record, magic ? magic : "");
	}
	free(magic);
}

/* A record that promised another one came. */
static int promised(const struct fields_in *in)
{
	return in->at.mark.number > 0 && !in->at.mark.last;
}

int fields_more(struct fields_in *in)
{
	return promised(in) || input_peek(in->at.in) >= 0;
}

/* Records of a stream of ours are numbered from 1. */
static void check_mark(const struct fields_in *in, struct mark before)
{
	const struct mark *mark = &in->at.mark;
	long want = before.number > 0 && !before.last ? before.number + 1 : 1;

	if (mark->number > 0 && mark->checksum != in->at.checksum)
		die(EXIT_RUN, "%s: record %ld: want crc32 %08lx, got %08lx: damaged",
			in->at.name, in->at.record, (unsigned long)mark->checksum,
			(unsigned long)in->at.checksum);
	if (mark->number != want && (mark->number > 0 || want > 1))
		die(EXIT_RUN,
			"%s: record %ld: want number %ld of its stream, got number %ld",
			in->at.name, in->at.record, want, mark->number);
}

static void read_record(struct fields_in *in, struct record *r)
{
	struct mark before = in->at.mark;

	r->realisation = in->at.record++;
	in->at.checksum = 0;
	in->at.mark = (struct mark){ 0 };
	if (in->is_raw)
		read_raw(in, r);
	else
		read_formatted(in, r);
	in->unmarked += in->at.mark.number == 0;
	check_mark(in, before);
	input_whole(in->at.in, in->at.mark.last);
}

int fields_read(struct fields_in *in, struct record *r)
{
	record_free(r);
	if (input_peek(in->at.in) >= 0) {
		read_record(in, r);
		return 1;
	}
	if (in->at.record == 0)
		die(EXIT_RUN, "%s: no record", in->at.name);
	if (promised(in) && !file_followed())
		die(EXIT_RUN,
			"%s: the stream ends after record %ld, which says that another "
			"follows: what wrote it did not finish",
			in->at.name, in->at.record);
	return 0;
}

int fields_marked(const struct fields_in *in)
{
	return in->unmarked == 0;
}

const char *fields_name(const struct fields_in *in)
{
	return in->at.name;
}

long fields_count(const struct fields_in *in)
{
	return in->at.record;
}

void fields_close(struct fields_in *in)
{
	input_close(in->at.in);
	free(in);
}

struct fields_out *fields_create(const char *path)
{
	struct fields_out *out = xcalloc(1, sizeof *out);

	out->f = file_create(path, &out->name);
	if (isatty(fileno(out->f)))
		die(EXIT_USAGE, "not writing binary data to a terminal");
	return out;
}

void fields_write(struct fields_out *out, const struct record *r, int more)
{
	nrrd_write(out->f, r, ++out->records, !more);
	out->open = more;
	if (fflush(out->f) || ferror(out->f))
		die(EXIT_RUN, "%s:", out->name);
}

void fields_done(struct fields_out *out)
{
	ends_check();
	if (out->open)
		die(EXIT_RUN, "%s: record %ld is missing", out->name, out->records + 1);
	if (out->f != stdout && fclose(out->f))
		die(EXIT_RUN, "%s:", out->name);
	free(out);
}
