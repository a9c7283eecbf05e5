#include "io/fields.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "io/ends.h"
#include "io/formats.h"
#include "io/gsf.h"
#include "io/kinds.h"
#include "io/magnitudes.h"
#include "io/nrrd.h"
#include "io/reasons.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct fields_in {
	struct place at;
	struct raw_layout raw;
	int is_raw;
	long unmarked; /* records that do not state whether another one follows */
	struct reasons reasons;
};

struct fields_out {
	FILE *f;
	const char *name;
	struct pool *pool;
	long records; /* of the stream that is being written */
	int open;     /* another record was announced */
};

double *record_need(
	const struct record *r, const char *name, int finite, const struct fields_in *in)
{
	int k = record_find(r, name);

	if (k < 0)
		die(EXIT_RUN, "%s: record %ld: no field '%s', want %s", in->at.name,
			in->at.record, name, opt_reads());
	if (finite && r->data[k])
		check_finite(&in->at, r, name, r->data[k], record_points(r), 0);
	return r->data[k];
}

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

/* Heights of float32 below a millimetre are below 1e-26 if taken for float64. */
static void check_magnitudes(const struct place *at, const struct record *r)
{
	struct magnitudes m = { 0 };

	for (int k = 0; k < r->nfields; k++)
		if (r->data[k])
			magnitudes_add(&m, r->data[k], record_points(r));
	m.samples = (double)record_points(r); /* a hundredth of one field is too many */
	if (magnitudes_single(&m))
		die(EXIT_RUN,
			"%s: record %ld: the samples look like float32: want "
			"little-endian float64",
			at->name, at->record);
	if (magnitudes_absurd(&m, 1e-20))
		die(EXIT_RUN,
			"%s: record %ld: samples of up to %.2g: not little-endian float64?",
			at->name, at->record, m.most);
}

static void read_raw(struct fields_in *in, struct record *r)
{
	const char *fields = in->raw.fields;
	int n = 1;

	for (const char *s = fields; s && *s; s++)
		n += *s == ',';
	r->nx = in->raw.nx;
	r->ny = in->raw.ny;
	r->nz = in->raw.nz;
	r->dx = in->raw.dx;
	r->dy = in->raw.dy;
	r->dz = in->raw.dz;
	check_sizes(&in->at, (double[]){ n, r->nx, r->ny, r->nz }, 4);
	name_fields(&in->at, fields, r, n);
	samples_read(&in->at, r, (struct samples){ 0, 0 });
	check_magnitudes(&in->at, r);
}

/* Recognises the format by the first line, which has been read then. */
static const struct format {
	int (*is)(const char *magic);
	void (*read)(struct place *at, struct record *r);
} formats[] = {
	{ nrrd_is, nrrd_read },
	{ gsf_is, gsf_read },
};

static void read_formatted(struct fields_in *in, struct record *r)
{
	size_t size = 0, n = sizeof formats / sizeof *formats, i = 0;
	char *magic = header_line(&in->at, &size);

	while (magic && i < n && !formats[i].is(magic))
		i++;
	if (magic && i < n) {
		formats[i].read(&in->at, r);
	} else {
		if (magic && in->at.record == 1)
			kind_refuse(in->at.name, magic, strlen(magic), KIND_FIELD);
		die(EXIT_RUN, "%s: record %ld: want NRRD or GSF, got '%.8s'", in->at.name,
			in->at.record, magic ? magic : "");
	}
	free(magic);
}

/* A record arrived that announces another one. */
static int promised(const struct fields_in *in)
{
	return in->at.mark.number > 0 && !in->at.mark.last;
}

int fields_more(struct fields_in *in)
{
	return promised(in) || input_peek(in->at.in) >= 0;
}

int fields_last(const struct fields_in *in)
{
	return in->at.mark.number > 0 && in->at.mark.last;
}

/* Records of a stream with an end mark are numbered from 1. */
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

/* Keys that programs compute with.  A value that they cannot read would be none to them:
 * a contact that states '5 GPa' would have no hardness. */
static void check_keys(const struct place *at, const struct record *r)
{
	static const char *const numbers[] = { "approach", "crown", "estar", "hardness",
		"mean_pressure", "sq", "step", NULL };
	static const char *const words[][3] = { { "boundary", "free", "periodic" },
		{ "converged", "yes", "no" } };

	for (int i = 0; numbers[i]; i++) {
		const char *value = record_get(r, numbers[i]);

		if (value && strcmp(value, "nan") != 0 &&
			isnan(record_get_number(r, numbers[i])))
			die(EXIT_RUN, "%s: record %ld: key %s is '%.40s', want a number",
				at->name, at->record, numbers[i], value);
	}
	for (int i = 0; i < 2; i++) {
		const char *const *word = words[i], *value = record_get(r, word[0]);

		if (value && strcmp(value, word[1]) != 0 && strcmp(value, word[2]) != 0)
			die(EXIT_RUN, "%s: record %ld: key %s is '%.40s', want %s or %s",
				at->name, at->record, word[0], value, word[1], word[2]);
	}
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
	check_keys(&in->at, r);
	input_whole(in->at.in, in->at.mark.last);
}

int fields_read(struct fields_in *in, struct record *r)
{
	record_clear(r);
	if (input_peek(in->at.in) >= 0) {
		read_record(in, r);
		if (record_get(r, "doubtful"))
			reasons_add(&in->reasons, record_get(r, "doubtful"));
		return 1;
	}
	if (in->at.record == 0)
		die(EXIT_RUN, "%s: empty, want %s", in->at.name, opt_reads());
	if (promised(in) && !file_followed())
		die(EXIT_RUN,
			"%s: the stream ends after record %ld, which announces another: its writer did not finish",
			in->at.name, in->at.record);
	return 0;
}

int fields_marked(const struct fields_in *in)
{
	return in->unmarked == 0;
}

void fields_only_check(struct fields_in *in, const char *name)
{
	in->at.unkept = name;
}

void fields_read_with(struct fields_in *in, struct pool *pool)
{
	in->at.pool = pool;
}

const char *fields_name(const struct fields_in *in)
{
	return in->at.name;
}

long fields_count(const struct fields_in *in)
{
	return in->at.record;
}

const char *fields_doubted(struct fields_in *in)
{
	return reasons_warn(&in->reasons, in->at.name);
}

void fields_close(struct fields_in *in)
{
	reasons_free(&in->reasons);
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

void fields_write_with(struct fields_out *out, struct pool *pool)
{
	out->pool = pool;
}

void fields_write(struct fields_out *out, const struct record *r, int more)
{
	nrrd_write(out->f, r, ++out->records, !more, out->pool);
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
