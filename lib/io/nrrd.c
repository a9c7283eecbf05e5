/* nrrd.c - NRRD records with attached header; see wearpipe-streams(5)
 *
 * The layout (list axis first, one spacing on list and x axis, header padded to a
 * multiple of 1024 bytes) is what teem, ParaView, Gwyddion, numpy, Octave and
 * gnuplot all read rightly.
 */
#include "io/bytes.h"
#include "io/formats.h"
#include "cli/msg.h"
#include "cli/unit.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { AXES = 4, HEADER_UNIT = 1024 };

static const long REALISATION_MAX = 1000000000000000; /* exact in a table of doubles */

struct header {
	int dimension;
	int nsizes, nspacings, nunits, nkinds;
	double sizes[AXES], spacings[AXES];
	char units[AXES][16];
	int list_first; /* kinds say that axis 0 is a list */
	int raw;
	int endian; /* 0 not said, 1 little, 2 big */
	int type;   /* 0 not said, 4 float, 8 double */
	char *fields;
};

static _Noreturn void bad(const struct place *at, const char *what, const char *value)
{
	die(EXIT_RUN, "%s: record %ld: %s: '%.60s' is not understood", at->name,
		at->record, what, value);
}

static int parse_numbers(
	const struct place *at, const char *what, const char *text, double *v)
{
	int n = 0;
	const char *s = text;

	for (;;) {
		char *end;
		double x;

		s += strspn(s, " \t");
		if (!*s)
			return n;
		x = strtod(s, &end);
		if (end == s || (*end && !isspace((unsigned char)*end)) || n == AXES)
			bad(at, what, text);
		v[n++] = x;
		s = end;
	}
}

/* Words, quoted or not: "m" "m" m */
static int parse_words(const struct place *at, const char *text, char words[AXES][16])
{
	int n = 0;
	const char *s = text;

	for (;;) {
		const char *stop;
		size_t length;

		s += strspn(s, " \t");
		if (!*s)
			return n;
		stop = *s == '"' ? "\"" : " \t";
		s += *s == '"';
		length = strcspn(s, stop);
		if (n == AXES || length > 15)
			bad(at, "units or kinds", text);
		memcpy(words[n], s, length);
		words[n++][length] = '\0';
		s += length;
		s += *s != '\0';
	}
}

static int word_in(const char *word, const char *const *list)
{
	for (; *list; list++)
		if (strcasecmp(word, *list) == 0)
			return 1;
	return 0;
}

static void read_field(
	const struct place *at, struct header *h, const char *key, const char *v)
{
	static const char *const ignored[] = { "content", "labels", "min", "max",
		"old min", "old max", "oldmin", "oldmax", "centers", "centerings",
		"thicknesses", "axis mins", "axismins", "axis maxs", "axismaxs",
		"block size", "blocksize", "sample units", "sampleunits", "number",
		"space units", "measurement frame", NULL };
	char words[AXES][16];
	double number[AXES];

	if (strcasecmp(key, "type") == 0) {
		h->type = !strcasecmp(v, "double") ? 8 : !strcasecmp(v, "float") ? 4 : 0;
		if (!h->type)
			die(EXIT_RUN, "%s: record %ld: type %.30s: want double or float",
				at->name, at->record, v);
	} else if (strcasecmp(key, "dimension") == 0) {
		if (parse_numbers(at, key, v, number) != 1 ||
			(number[0] != 2 && number[0] != 3 && number[0] != 4))
			die(EXIT_RUN, "%s: record %ld: dimension %.30s: want 2, 3 or 4",
				at->name, at->record, v);
		h->dimension = (int)number[0];
	} else if (strcasecmp(key, "sizes") == 0) {
		h->nsizes = parse_numbers(at, key, v, h->sizes);
	} else if (strcasecmp(key, "spacings") == 0) {
		h->nspacings = parse_numbers(at, key, v, h->spacings);
	} else if (strcasecmp(key, "units") == 0) {
		h->nunits = parse_words(at, v, h->units);
	} else if (strcasecmp(key, "kinds") == 0) {
		h->nkinds = parse_words(at, v, words);
		h->list_first = h->nkinds > 0 && strcasecmp(words[0], "domain") != 0 &&
				strcasecmp(words[0], "space") != 0;
	} else if (strcasecmp(key, "endian") == 0) {
		h->endian = !strcasecmp(v, "little") ? 1 : !strcasecmp(v, "big") ? 2 : 0;
		if (!h->endian)
			bad(at, key, v);
	} else if (strcasecmp(key, "encoding") == 0) {
		h->raw = !strcasecmp(v, "raw");
		if (!h->raw)
			die(EXIT_RUN, "%s: record %ld: encoding %.30s: want raw",
				at->name, at->record, v);
	} else if (!word_in(key, ignored)) {
		die(EXIT_RUN, "%s: record %ld: NRRD field '%.30s' is not supported",
			at->name, at->record, key);
	}
}

/* NRRD writes backslash and newline of a value as \\ and \n. */
static void unescape(char *s)
{
	char *to = s;

	for (; *s; s++) {
		if (s[0] == '\\' && s[1] == '\\')
			s++;
		else if (s[0] == '\\' && s[1] == 'n') {
			*to++ = '\n';
			s++;
			continue;
		}
		*to++ = *s;
	}
	*to = '\0';
}

static void read_key(const struct place *at, struct header *h, struct record *r,
	const char *key, char *value)
{
	unescape(value);
	if (strcmp(key, "fields") == 0) {
		free(h->fields);
		h->fields = xstrdup(value);
	} else if (strcmp(key, "cmd") == 0) {
		free(r->cmd);
		r->cmd = xstrdup(value);
	} else if (strcmp(key, "realisation") == 0) {
		char *end;

		r->realisation = strtol(value, &end, 10);
		if (end == value || *end || r->realisation < 0 ||
			r->realisation > REALISATION_MAX)
			bad(at, key, value);
	} else {
		keys_set(&r->keys, key, value);
	}
}

static void read_header(const struct place *at, struct header *h, struct record *r)
{
	size_t size = 0;
	char *line;

	while ((line = header_line(at, &size)) && *line) {
		char *colon = strchr(line, ':');

		if (*line != '#') {
			if (!colon)
				bad(at, "header line", line);
			*colon = '\0';
			if (colon[1] == '=')
				read_key(at, h, r, line, colon + 2);
			else if (colon[1] == ' ')
				read_field(at, h, line, colon + 2);
			else
				bad(at, line, colon + 1);
		}
		free(line);
	}
	if (!line)
		die(EXIT_RUN, "%s: record %ld: the stream ends inside the header",
			at->name, at->record);
	free(line);
}

static void check_header(const struct place *at, struct header *h)
{
	const char *missing = !h->type        ? "type"
			      : !h->dimension ? "dimension"
			      : !h->nsizes    ? "sizes"
			      : !h->raw       ? "encoding"
			      : !h->nspacings ? "spacings"
			      : !h->endian    ? "endian"
					      : NULL;

	if (missing)
		die(EXIT_RUN, "%s: record %ld: NRRD header without '%s'", at->name,
			at->record, missing);
	if (h->nsizes != h->dimension || h->nspacings != h->dimension)
		die(EXIT_RUN, "%s: record %ld: want %d sizes and spacings, got %d and %d",
			at->name, at->record, h->dimension, h->nsizes, h->nspacings);
	if (h->dimension > 2 && h->nkinds && !h->list_first)
		die(EXIT_RUN, "%s: record %ld: want kinds 'list domain domain'", at->name,
			at->record);
	check_sizes(at, h->sizes, h->nsizes);
}

/* Spacing of an axis in metres. */
static double spacing(const struct place *at, const struct header *h, int axis)
{
	double scale = 1, s = h->spacings[axis];
	char text[24];
	const char *end;

	if (h->nunits > axis && *h->units[axis]) {
		snprintf(text, sizeof text, "1%s", h->units[axis]);
		if (unit_parse(text, UNIT_LENGTH, "", &scale, &end))
			die(EXIT_RUN,
				"%s: record %ld: unit '%s' of axis %d is not a length",
				at->name, at->record, h->units[axis], axis);
	}
	check_spacing(at, axis, s * scale);
	return s * scale;
}

/* Names and units, "height m, pressure Pa"; a single field without a name is taken
 * for a height in metres. */
static void name_fields(
	const struct place *at, const struct header *h, struct record *r, int n)
{
	char *text = xstrdup(h->fields ? h->fields : n == 1 ? "height m" : ""), *s = text;

	for (int i = 0; i < n; i++) {
		char *comma = strchr(s, ','), *blank;
		char numbered[24];

		if (comma)
			*comma = '\0';
		s += strspn(s, " ");
		blank = strchr(s, ' ');
		if (blank)
			*blank = '\0';
		snprintf(numbered, sizeof numbered, "field%d", i + 1);
		if (h->fields && (!*s || record_find(r, s) >= 0))
			die(EXIT_RUN,
				"%s: record %ld: want the names of %d fields, got '%s'",
				at->name, at->record, n, h->fields);
		record_new_field(r, *s ? s : numbered, blank ? blank + 1 : "");
		s = comma ? comma + 1 : s + strlen(s);
	}
	if (*s && h->fields)
		die(EXIT_RUN, "%s: record %ld: want the names of %d fields, got '%s'",
			at->name, at->record, n, h->fields);
	free(text);
}

void nrrd_read(const struct place *at, struct record *r)
{
	struct header h = { 0 };
	int list = 0;

	read_header(at, &h, r);
	check_header(at, &h);
	list = h.dimension > 2;
	if (list && h.sizes[0] > RECORD_FIELDS_MAX)
		die(EXIT_RUN, "%s: record %ld: %g fields, want at most %d", at->name,
			at->record, h.sizes[0], RECORD_FIELDS_MAX);
	r->nx = (int)h.sizes[list];
	r->ny = (int)h.sizes[list + 1];
	r->nz = h.dimension == 4 ? (int)h.sizes[3] : 1;
	r->dx = spacing(at, &h, list);
	r->dy = spacing(at, &h, list + 1);
	r->dz = h.dimension == 4 ? spacing(at, &h, 3) : 0;
	name_fields(at, &h, r, list ? (int)h.sizes[0] : 1);
	free(h.fields);
	samples_read(at, r, (struct samples){ h.type == 4, h.endian == 2 });
}

/* Value of a key: escaped, and without the ": " that ParaView's reader trips over. */
static void write_key(FILE *f, const char *key, const char *value)
{
	char before = '=';

	fprintf(f, "%s:=", key);
	for (; *value; before = *value++) {
		if (*value == '\\')
			fputs("\\\\", f);
		else if (*value == '\n')
			fputs("\\n", f);
		else if (!(*value == ' ' && before == ':'))
			putc(*value, f);
	}
	putc('\n', f);
}

static void write_number(FILE *f, double value)
{
	char text[NUMBER_TEXT];

	fprintf(f, " %s", number_text(value, text));
}

static char *make_header(const struct record *r, size_t *size)
{
	char *text = NULL;
	FILE *f = open_memstream(&text, size);
	int volume = r->nz > 1;

	if (!f)
		die(EXIT_RUN, "out of memory");
	fprintf(f, "NRRD0004\ntype: double\ndimension: %d\nsizes: %d %d %d", 3 + volume,
		r->nfields, r->nx, r->ny);
	if (volume)
		fprintf(f, " %d", r->nz);
	fprintf(f, "\nkinds: list domain domain%s\nspacings:", volume ? " domain" : "");
	write_number(f, r->dx);
	write_number(f, r->dx);
	write_number(f, r->dy);
	if (volume)
		write_number(f, r->dz);
	fprintf(f, "\nunits: \"m\" \"m\" \"m\"%s\nlabels: \"", volume ? " \"m\"" : "");
	for (int i = 0; i < r->nfields; i++)
		fprintf(f, "%s%s", i ? " " : "", r->name[i]);
	fprintf(f, "\" \"x\" \"y\"%s\nendian: little\nencoding: raw\nfields:=",
		volume ? " \"z\"" : "");
	for (int i = 0; i < r->nfields; i++)
		fprintf(f, "%s%s%s%s", i ? ", " : "", r->name[i], *r->unit[i] ? " " : "",
			r->unit[i]);
	fprintf(f, "\nrealisation:=%ld\n", r->realisation);
	for (int i = 0; i < r->keys.n; i++)
		write_key(f, r->keys.key[i], r->keys.value[i]);
	if (r->cmd)
		write_key(f, "cmd", r->cmd);
	fflush(f);
	fprintf(f, "#%*s\n\n",
		(int)((HEADER_UNIT - (*size + 3) % HEADER_UNIT) % HEADER_UNIT), "");
	if (fclose(f))
		die(EXIT_RUN, "out of memory");
	return text;
}

void nrrd_write(FILE *f, const struct record *r)
{
	size_t size, n = (size_t)r->nx * (size_t)r->nfields * 8;
	char *header = make_header(r, &size);
	unsigned char *row = xcalloc(n, 1);

	fwrite(header, 1, size, f);
	free(header);
	for (size_t iy = 0; iy < (size_t)r->ny * (size_t)r->nz; iy++) {
		unsigned char *b = row;

		for (size_t ix = 0; ix < (size_t)r->nx; ix++)
			for (int k = 0; k < r->nfields; k++, b += 8)
				bytes_put_double_little(
					b, r->data[k][iy * (size_t)r->nx + ix]);
		fwrite(row, 1, n, f);
	}
	free(row);
}
