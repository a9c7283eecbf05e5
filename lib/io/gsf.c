/* gsf.c - Gwyddion Simple Field 1.0: one float32 field, text header padded with NULs */
#include "io/gsf.h"
#include "cli/msg.h"
#include "cli/unit.h"
#include "num/bytes.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char first_line[] = "Gwyddion Simple Field 1.0";

static double number(const struct place *at, const char *key, const char *text)
{
	char *end;
	double v = strtod(text, &end);

	if (end == text || *end || !(v > 0) || !isfinite(v))
		die(EXIT_RUN, "%s: record %ld: %s = %.30s: want a number above 0",
			at->name, at->record, key, text);
	return v;
}

static double length_scale(const struct place *at, const char *unit)
{
	double scale = unit_scale(unit, UNIT_LENGTH);

	if (scale <= 0)
		die(EXIT_RUN, "%s: record %ld: unit '%.20s' is not a length", at->name,
			at->record, unit);
	return scale;
}

/* Splits "Key = value" in place. */
static char *split(char *line)
{
	char *value = strchr(line, '=');

	if (!value)
		return NULL;
	for (char *p = value; p > line && (p[-1] == ' ' || p[-1] == '\t'); p--)
		p[-1] = '\0';
	*value++ = '\0';
	return value + strspn(value, " \t");
}

/* The header ends with one to four NULs, up to a multiple of four bytes. */
static void skip_padding(struct place *at, size_t header_size)
{
	size_t n = 4 - header_size % 4;

	for (size_t i = 0; i < n; i++)
		if (input_get(at->in) != 0)
			die(EXIT_RUN,
				"%s: record %ld: GSF header is not padded with NUL bytes",
				at->name, at->record);
}

int gsf_is(const char *magic)
{
	return strcmp(magic, first_line) == 0;
}

void gsf_read(struct place *at, struct record *r)
{
	double sizes[2] = { 0 }, real[2] = { 0 }, xy = 0, z = 0; /* 0: not stated */
	size_t size = strlen(first_line) + 1;

	while (input_peek(at->in) > 0) {
		char *line, *value;

		line = header_line(at, &size);
		if (!line)
			die(EXIT_RUN, "%s: record %ld: the stream ends inside the header",
				at->name, at->record);
		value = split(line);
		if (!value)
			die(EXIT_RUN, "%s: record %ld: GSF header line '%.40s'", at->name,
				at->record, line);
		if (!strcmp(line, "XRes"))
			sizes[0] = number(at, line, value);
		else if (!strcmp(line, "YRes"))
			sizes[1] = number(at, line, value);
		else if (!strcmp(line, "XReal"))
			real[0] = number(at, line, value);
		else if (!strcmp(line, "YReal"))
			real[1] = number(at, line, value);
		else if (!strcmp(line, "XYUnits"))
			xy = length_scale(at, value);
		else if (!strcmp(line, "ZUnits"))
			z = length_scale(at, value);
		free(line);
	}
	if (!(sizes[0] > 0 && sizes[1] > 0 && real[0] > 0 && real[1] > 0))
		die(EXIT_RUN,
			"%s: record %ld: GSF header without XRes, YRes, XReal and YReal",
			at->name, at->record);
	skip_padding(at, size);
	check_sizes(at, sizes, 2);
	warn_units(at, xy > 0, z > 0);
	xy = xy > 0 ? xy : 1;
	z = z > 0 ? z : 1;
	r->nx = (int)sizes[0];
	r->ny = (int)sizes[1];
	r->nz = 1;
	r->dx = real[0] * xy / sizes[0];
	r->dy = real[1] * xy / sizes[1];
	check_spacing(at, 0, r->dx);
	check_spacing(at, 1, r->dy);
	record_new_field(r, "height", "m");
	samples_read(at, r, (struct samples){ 1, 0 });
	for (size_t i = 0; z != 1 && i < (size_t)r->nx * (size_t)r->ny; i++)
		r->data[0][i] *= z;
}

void gsf_write(FILE *f, const struct record *r, int field)
{
	size_t n = (size_t)r->nx * (size_t)r->ny;
	char *header = xprintf("%s\nXRes = %d\nYRes = %d\nXReal = %.17g\nYReal = %.17g\n"
			       "XYUnits = m\nZUnits = %s\nTitle = %s\n",
		first_line, r->nx, r->ny, r->nx * r->dx, r->ny * r->dy, r->unit[field],
		r->name[field]);
	size_t size = strlen(header);
	unsigned char b[4] = { 0 };

	fwrite(header, 1, size, f);
	fwrite(b, 1, 4 - size % 4, f);
	free(header);
	for (size_t i = 0; i < n; i++) {
		bytes_put_float_little(b, (float)r->data[field][i]);
		fwrite(b, 1, 4, f);
	}
}
