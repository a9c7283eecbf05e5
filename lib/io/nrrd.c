/* nrrd.c - NRRD records with attached header; see wearpipe-streams(5)
 *
 * The layout (list axis first, one spacing on list and x axis, header padded to a
 * multiple of 1024 bytes) is what teem, ParaView, Gwyddion, numpy, Octave and
 * gnuplot all read rightly.
 */
#include "io/nrrd.h"
#include "cli/msg.h"
#include "cli/text.h"
#include "cli/unit.h"
#include "num/bytes.h"
#include "num/crc32.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { AXES = 4, HEADER_UNIT = 1024, KEYS_MAX = 1000 };

static const long REALISATION_MAX = 1000000000000000; /* exact in a table of doubles */

struct header {
	int dimension;
	int nsizes, nspacings, nunits, nkinds;
	double sizes[AXES], spacings[AXES];
	char units[AXES][16];
	int list_first; /* kinds say that axis 0 is a list */
	int raw;
	int endian;            /* 0 not stated, 1 little, 2 big */
	int type;              /* 0 not stated, 4 float, 8 double */
	char *fields, *sample; /* names and units; the unit of samples */
	struct keys seen[2];   /* names of fields, in small letters, and of keys */
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
		"block size", "blocksize", "number", "measurement frame", NULL };
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
	} else if (strcasecmp(key, "sample units") == 0 ||
		   strcasecmp(key, "sampleunits") == 0) {
		h->sample = *v ? xstrdup(v) : NULL;
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

static void read_mark(struct place *at, const char *value)
{
	unsigned checksum;
	char state[16];
	int end = 0;

	if (sscanf(value, "record %ld, %15[a-z], crc32 %8x%n", &at->mark.number, state,
		    &checksum, &end) != 3 ||
		value[end] || at->mark.number < 1 ||
		(strcmp(state, "last") != 0 && strcmp(state, "more") != 0))
		bad(at, "stream", value);
	at->mark.last = !strcmp(state, "last");
	at->mark.checksum = checksum;
}

static void read_key(struct place *at, struct header *h, struct record *r,
	const char *key, char *value)
{
	char *text;

	unescape(value);
	value = text = text_escape(value);
	if (strcmp(key, "stream") == 0) {
		read_mark(at, value);
	} else if (strcmp(key, "fields") == 0) {
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
		char *name = text_escape(key);

		keys_set(&r->keys, name, value);
		free(name);
		if ((size_t)r->keys.n > input_limit("keys", KEYS_MAX))
			die(EXIT_RUN, "%s: record %ld: more than %zu keys", at->name,
				at->record, input_limit("keys", KEYS_MAX));
	}
	free(text);
}

/* Of two values neither is certain to be meant. */
static void see(const struct place *at, struct header *h, char *name, int key)
{
	for (char *c = name; *c && !key; c++)
		*c = (char)tolower((unsigned char)*c);
	if (keys_get(&h->seen[key], name))
		die(EXIT_RUN, "%s: record %ld: '%.30s' is given twice in the header",
			at->name, at->record, name);
	keys_set(&h->seen[key], name, "");
}

static void read_header(struct place *at, struct header *h, struct record *r)
{
	size_t size = 0;
	char *line;

	while ((line = header_line(at, &size)) && *line) {
		char *colon = strchr(line, ':');

		if (*line != '#') {
			if (!colon)
				bad(at, "header line", line);
			*colon = '\0';
			see(at, h, line, colon[1] == '=');
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
	keys_free(&h->seen[0]);
	keys_free(&h->seen[1]);
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
	if (h->nunits && h->nunits != h->dimension)
		die(EXIT_RUN, "%s: record %ld: want a unit for each of %d axes, got %d",
			at->name, at->record, h->dimension, h->nunits);
	if (h->dimension > 2 && h->nkinds && !h->list_first)
		die(EXIT_RUN, "%s: record %ld: want kinds 'list domain domain'", at->name,
			at->record);
	check_sizes(at, h->sizes, h->nsizes);
}

/* Spacing of an axis in metres. */
static double spacing(const struct place *at, const struct header *h, int axis)
{
	double scale = 1, s = h->spacings[axis];

	if (h->nunits > axis && *h->units[axis]) {
		scale = unit_scale(h->units[axis], UNIT_LENGTH);
		if (scale <= 0)
			die(EXIT_RUN,
				"%s: record %ld: unit '%s' of axis %d is not a length",
				at->name, at->record, h->units[axis], axis);
	}
	check_spacing(at, axis, s * scale);
	return s * scale;
}

void name_fields(const struct place *at, const char *fields, struct record *r, int n)
{
	char *text = xstrdup(fields ? fields : n == 1 ? "height m" : ""), *s = text;

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
		if (fields && (!*s || record_find(r, s) >= 0))
			die(EXIT_RUN,
				"%s: record %ld: want the names of %d fields, got '%s'",
				at->name, at->record, n, fields);
		(at->unkept && strcmp(s, at->unkept) == 0 ? record_name_field
							  : record_new_field)(
			r, *s ? s : numbered, blank ? blank + 1 : "");
		s = comma ? comma + 1 : s + strlen(s);
	}
	if (*s && fields)
		die(EXIT_RUN, "%s: record %ld: want the names of %d fields, got '%s'",
			at->name, at->record, n, fields);
	free(text);
}

/* Converts lengths and pressures to SI. */
static void convert_units(const struct place *at, struct record *r)
{
	for (int k = 0; k < r->nfields; k++) {
		int height = !strcmp(r->name[k], "height");
		enum unit unit = height ? UNIT_LENGTH : UNIT_PRESSURE;
		double scale = unit_scale(r->unit[k], unit);

		if (scale <= 0 && *r->unit[k] &&
			(height || !strcmp(r->name[k], "pressure")))
			die(EXIT_RUN, "%s: record %ld: %s is in '%s', want %s", at->name,
				at->record, r->name[k], r->unit[k], unit_name(unit));
		if (scale <= 0 || scale == 1)
			continue;
		for (size_t i = 0; r->data[k] && i < record_points(r); i++)
			r->data[k][i] *= scale;
		free(r->unit[k]);
		r->unit[k] = xstrdup(unit_name(unit));
	}
}

int nrrd_is(const char *magic)
{
	return strncmp(magic, "NRRD000", 7) == 0 && strlen(magic) == 8;
}

void nrrd_read(struct place *at, struct record *r)
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
	if (!h.fields) {
		warn_units(at, *h.units[list] != '\0', h.sample || h.sizes[0] * list > 1);
		h.fields = h.sample ? xprintf("height %s", h.sample) : NULL;
	}
	name_fields(at, h.fields, r, list ? (int)h.sizes[0] : 1);
	samples_read(at, r, (struct samples){ h.type == 4, h.endian == 2 });
	convert_units(at, r);
	free(h.sample);
	free(h.fields);
}

/* Value of a key: escaped, and without ": ", which ParaView's reader cannot parse. */
static void write_key(struct text *t, const char *key, const char *value)
{
	char before = '=';

	text_add(t, "%s:=", key);
	for (; *value; before = *value++) {
		if (*value == '\\')
			text_add(t, "\\\\");
		else if (*value == '\n')
			text_add(t, "\\n");
		else if (!(*value == ' ' && before == ':'))
			text_add(t, "%c", *value);
	}
	text_add(t, "\n");
}

static void write_number(struct text *t, double value)
{
	char text[NUMBER_TEXT];

	text_add(t, " %s", number_text(value, text));
}

/* The mark is the last key, with zeros for the digits of its checksum. */
static struct text make_header(const struct record *r, long number, int last)
{
	struct text t = { 0 };
	int volume = r->nz > 1;

	text_add(&t, "NRRD0004\ntype: double\ndimension: %d\nsizes: %d %d %d", 3 + volume,
		r->nfields, r->nx, r->ny);
	if (volume)
		text_add(&t, " %d", r->nz);
	text_add(&t, "\nkinds: list domain domain%s\nspacings:", volume ? " domain" : "");
	write_number(&t, r->dx);
	write_number(&t, r->dx);
	write_number(&t, r->dy);
	if (volume)
		write_number(&t, r->dz);
	text_add(&t, "\nunits: \"m\" \"m\" \"m\"%s\nlabels: \"", volume ? " \"m\"" : "");
	for (int i = 0; i < r->nfields; i++)
		text_add(&t, "%s%s", i ? " " : "", r->name[i]);
	text_add(&t, "\" \"x\" \"y\"%s\nendian: little\nencoding: raw\nfields:=",
		volume ? " \"z\"" : "");
	for (int i = 0; i < r->nfields; i++)
		text_add(&t, "%s%s%s%s", i ? ", " : "", r->name[i],
			*r->unit[i] ? " " : "", r->unit[i]);
	text_add(&t, "\nrealisation:=%ld\n", r->realisation);
	/* The key that some records alone have is last: the others agree in their order.
	 */
	for (int i = 0; i < r->keys.n; i++)
		if (strcmp(r->keys.key[i], "doubtful") != 0)
			write_key(&t, r->keys.key[i], r->keys.value[i]);
	if (record_get(r, "doubtful"))
		write_key(&t, "doubtful", record_get(r, "doubtful"));
	if (r->cmd)
		write_key(&t, "cmd", r->cmd);
	text_add(&t, "%srecord %ld, %s, crc32 %s\n", mark_key, number,
		last ? "last" : "more", mark_zeros);
	text_add(&t, "#%*s\n\n",
		(int)((HEADER_UNIT - (t.n + 3) % HEADER_UNIT) % HEADER_UNIT), "");
	return t;
}

struct writing {
	struct parts parts;
	const struct record *r;
};

/* The fields of a point side by side. */
static void make_part(void *context, size_t k, int worker)
{
	const struct writing *t = context;
	unsigned char *bytes = part_bytes(&t->parts, k);
	size_t n = part_points(&t->parts, k), width = t->parts.width;

	(void)worker;
	for (int field = 0; field < t->r->nfields; field++, bytes += 8) {
		const double *from = t->r->data[field] + t->parts.first + k * PART_POINTS;

		for (size_t i = 0; i < n; i++)
			bytes_put_double_little(bytes + i * width, from[i]);
	}
}

static void sum_part(void *context, size_t k, int worker)
{
	struct parts *p = &((struct writing *)context)->parts;

	make_part(context, k, worker);
	p->checksum[k] = crc32_add(0, part_bytes(p, k), part_points(p, k) * p->width);
}

/* Adds the checksum of all samples. */
static uint32_t sum_samples(const struct record *r, uint32_t checksum, struct pool *pool)
{
	struct writing t = { .r = r };
	size_t parts;

	parts_begin(&t.parts, record_points(r), 8 * (size_t)r->nfields);
	while ((parts = parts_next(&t.parts)) > 0) {
		pool_run(pool, parts, sum_part, &t);
		checksum = parts_sum(&t.parts, checksum);
	}
	parts_end(&t.parts);
	return checksum;
}

static void write_samples(FILE *f, const struct record *r, struct pool *pool)
{
	struct writing t = { .r = r };
	size_t parts;

	parts_begin(&t.parts, record_points(r), 8 * (size_t)r->nfields);
	while ((parts = parts_next(&t.parts)) > 0) {
		pool_run(pool, parts, make_part, &t);
		fwrite(t.parts.bytes, t.parts.width, t.parts.points, f);
	}
	parts_end(&t.parts);
}

void nrrd_write(FILE *f, const struct record *r, long number, int last, struct pool *pool)
{
	struct text header = make_header(r, number, last);
	uint32_t checksum = sum_samples(r, crc32_add(0, header.s, header.n), pool);
	char *digits = header.s + header.n - strlen(mark_zeros);

	while (memcmp(digits, mark_zeros, strlen(mark_zeros)) != 0)
		digits--;
	for (int i = 7; i >= 0; i--, checksum >>= 4)
		digits[i] = "0123456789abcdef"[checksum & 15];
	fwrite(header.s, 1, header.n, f);
	free(header.s);
	write_samples(f, r, pool);
}
