#include "formats_in.h"
#include "cli/msg.h"
#include "cli/unit.h"
#include "points.h"
#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE_MAX = 65536 };

/* ---- bytes ---- */

static const size_t width_of[] = { 8, 4, 4, 2, 2, 1, 8, 4, 1 };

static double sample_at(const char *data, enum sample_type type, int big_endian)
{
	const unsigned char *b = (const unsigned char *)data;
	size_t width = width_of[type];
	uint64_t bits = 0;
	double v;
	float f;
	uint32_t low;

	for (size_t i = 0; i < width; i++)
		bits |= (uint64_t)b[big_endian ? width - 1 - i : i] << (8 * i);
	switch (type) {
	case FLOAT64:
		memcpy(&v, &bits, sizeof v);
		return v;
	case FLOAT32:
		low = (uint32_t)bits;
		memcpy(&f, &low, sizeof f);
		return f;
	case INT32:
		return bits < 0x80000000 ? (double)bits : (double)bits - 4294967296.0;
	case INT16:
		return bits < 0x8000 ? (double)bits : (double)bits - 65536;
	case INT8:
		return bits < 0x80 ? (double)bits : (double)bits - 256;
	case INT64: /* of two's complement */
		return bits >> 63 ? -(double)(~bits + 1) : (double)bits;
	default:
		return (double)bits;
	}
}

static void need(const struct content *c, size_t bytes, const char *what)
{
	if (c->size < bytes)
		die(EXIT_RUN, "%s: want %zu bytes of %s, got %zu", c->name, bytes, what,
			c->size);
}

static double number(const struct content *c, size_t at, enum sample_type type)
{
	return sample_at(c->data + at, type, 0);
}

/* Rows of nx samples, stride bytes apart, from at on; missing is a sample, rounded as the
 * samples are, nan for none.  Returns where they end. */
static size_t take(const struct content *c, size_t at, size_t stride,
	enum sample_type type, int big_endian, double scale, double missing,
	struct record *r)
{
	double *z = r->data[0];
	size_t nx = (size_t)r->nx, ny = (size_t)r->ny;

	if (type == FLOAT32)
		missing = (double)(float)missing;
	if (stride < nx * width_of[type])
		stride = nx * width_of[type];
	need(c, at + stride * (ny - 1) + nx * width_of[type], "samples");
	for (size_t iy = 0; iy < ny; iy++)
		for (size_t ix = 0; ix < nx; ix++) {
			double v = sample_at(
				c->data + at + iy * stride + ix * width_of[type], type,
				big_endian);

			*z = v == missing ? NAN : v * scale;
			/* check_heights() refuses those near 0, of another byte order */
			if (*z == 0)
				*z = nextafter(0, v);
			z++;
		}
	return at + stride * (ny - 1) + nx * width_of[type];
}

/* Text or zeros may follow the samples; other bytes are samples that the header does not
 * count. */
static void check_rest(const struct content *c, size_t at, const struct record *r)
{
	size_t end = c->size;

	while (end > at && c->data[end - 1] == '\0')
		end--;
	for (; at < end; at++)
		if (iscntrl((unsigned char)c->data[at]) &&
			!isspace((unsigned char)c->data[at]))
			die(EXIT_RUN, "%s: more than the %d x %d samples of its header",
				c->name, r->nx, r->ny);
}

/* ---- properties from the file and the command line ---- */

double unit_named(const char *name, size_t length)
{
	static const struct {
		const char *name;
		double value;
	} units[] = { { "nm", 1e-9 }, { "um", 1e-6 }, { "\xc2\xb5m", 1e-6 },
		{ "\xce\xbcm", 1e-6 }, { "\xb5m", 1e-6 }, { "micron", 1e-6 },
		{ "microns", 1e-6 }, { "micrometer", 1e-6 }, { "micrometre", 1e-6 },
		{ "mm", 1e-3 }, { "cm", 1e-2 }, { "m", 1 }, { "pm", 1e-12 },
		{ "A", 1e-10 } };

	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (strlen(units[i].name) == length &&
			memcmp(units[i].name, name, length) == 0)
			return units[i].value;
	return NAN;
}

/* Spacings of four digits or more are equal up to rounding. */
static int differ(double a, double b)
{
	return fabs(a - b) > 1e-3 * fabs(b);
}

void settle_pixel(
	const struct content *c, const struct told *told, double *dx, double *dy)
{
	if (isnan(*dx) && isnan(told->dx))
		die(EXIT_RUN, "%s: the file does not state the spacing: specify --pixel",
			c->name);
	if (!isnan(*dx) && !isnan(told->dx) &&
		(differ(told->dx, *dx) || differ(told->dy, *dy)))
		die(EXIT_RUN, "%s: samples are %g x %g m apart, not --pixel %g x %g m",
			c->name, *dx, *dy, told->dx, told->dy);
	if (isnan(*dx)) {
		*dx = told->dx;
		*dy = told->dy;
	}
}

double settle_unit(const struct content *c, const struct told *told, double from_file)
{
	if (isnan(from_file) && isnan(told->unit))
		die(EXIT_RUN,
			"%s: the file does not state the unit of the heights: specify --height-unit",
			c->name);
	if (!isnan(from_file) && !isnan(told->unit) && differ(told->unit, from_file))
		die(EXIT_RUN, "%s: heights are in units of %g m, not --height-unit %g m",
			c->name, from_file, told->unit);
	if (isnan(from_file))
		from_file = told->unit;
	if (!(from_file > 0) || isinf(from_file))
		die(EXIT_RUN, "%s: heights in units of %g m, want a positive length",
			c->name, from_file);
	return from_file;
}

double *new_heights(const struct content *c, double nx, double ny, double dx, double dy,
	struct record *r)
{
	if (!(nx >= 1 && ny >= 1 && nx <= SIDE_MAX && ny <= SIDE_MAX) ||
		nx != floor(nx) || ny != floor(ny))
		die(EXIT_RUN, "%s: %g x %g samples, want 1 to %d each way", c->name, nx,
			ny, SIDE_MAX);
	if (!(dx > 0 && dx < 1e3 && dy > 0 && dy < 1e3))
		die(EXIT_RUN, "%s: invalid spacing of %g x %g m", c->name, dx, dy);
	record_init(r, (int)nx, (int)ny, dx, dy);
	return record_add(r, "height", "m");
}

/* ---- npy: a Python dictionary, then samples ---- */

/* The value of 'key': in the dictionary; NULL if it is missing. */
static const char *entry(const char *header, const char *key)
{
	const char *at = strstr(header, key);

	if (!at)
		return NULL;
	at = strchr(at + strlen(key), ':');
	return at ? at + 1 + strspn(at + 1, " ") : NULL;
}

static void npy_read(const struct content *c, const struct told *told, struct record *r)
{
	enum { TYPES = 9 };
	static const char *const types[TYPES] = { "f8", "f4", "i4", "i2", "u2", "u1",
		"i8", "u4", "i1" };
	double dx = NAN, dy = NAN, unit, nx = 0, ny = 0, missing = told->missing;
	size_t length, at;
	const char *descr, *shape, *fortran;
	enum points found = POINTS_NONE;
	struct grid grid;
	char *header, close = 0;
	int type = 0;

	need(c, 12, "an npy header");
	length = (size_t)number(c, 8, UINT16);
	at = 10;
	if (c->data[6] >= 2) {
		length = (size_t)number(c, 8, UINT32);
		at = 12;
	}
	need(c, at + length, "an npy header");
	header = xcalloc(length + 1, 1);
	memcpy(header, c->data + at, length);
	descr = entry(header, "'descr'");
	shape = entry(header, "'shape'");
	fortran = entry(header, "'fortran_order'");
	if (!descr || strlen(descr) < 5 || !shape || !fortran)
		die(EXIT_RUN, "%s: the npy header has no descr, shape or fortran_order",
			c->name);
	while (type < TYPES && strncmp(descr + 2, types[type], 2) != 0)
		type++;
	if (*descr != '\'' || type == TYPES || !strchr("<>|", descr[1]) ||
		descr[4] != '\'')
		die(EXIT_RUN,
			"%s: samples of type %.*s, want f8, f4, i8, i4, i2, i1, u4, u2 or u1",
			c->name, (int)strcspn(descr, ",}"), descr);
	if (sscanf(shape, "(%lf, %lf%c", &ny, &nx, &close) != 3 || close != ')')
		die(EXIT_RUN, "%s: an array of shape %.*s, want two dimensions", c->name,
			(int)strcspn(shape, ")") + 1, shape);
	if (nx >= 0 && ny >= 0 &&
		nx * ny * (double)width_of[type] + 1 < (double)(c->size - at - length))
		die(EXIT_RUN, "%s: more than the %g x %g samples of its header", c->name,
			nx, ny);
	settle_pixel(c, told, &dx, &dy);
	unit = settle_unit(c, told, NAN);
	if (strncmp(fortran, "True", 4) == 0) {
		/* column-major order: read as rows and transposed */
		struct record turned = { 0 };
		double *z;

		new_heights(c, ny, nx, dy, dx, &turned);
		take(c, at + length, 0, (enum sample_type)type, descr[1] == '>', unit,
			missing, &turned);
		z = new_heights(c, nx, ny, dx, dy, r);
		for (int iy = 0; iy < r->ny; iy++)
			for (int ix = 0; ix < r->nx; ix++)
				*z++ = turned.data[0][(size_t)ix * (size_t)r->ny +
						      (size_t)iy];
		record_free(&turned);
	} else {
		new_heights(c, nx, ny, dx, dy, r);
		take(c, at + length, 0, (enum sample_type)type, descr[1] == '>', unit,
			missing, r);
	}
	if (r->nx >= 3)
		found = points_find(r->data[0], (size_t)r->ny, (size_t)r->nx, &grid);
	if (found == POINTS_FEW)
		free(grid.at);
	if (found > POINTS_FEW)
		die(EXIT_RUN,
			"%s: rows look like points x, y, z: want a matrix of heights, or points "
			"as text",
			c->name);
	free(header);
}

/* ---- SDF, ISO 25178-71 ---- */

/* What stands behind "Name =" in the header of the text form; NULL if that is missing. */
static const char *sdf_key(const struct content *c, const char *key)
{
	const char *at = c->data;

	for (; at; at = strchr(at, '\n') ? strchr(at, '\n') + 1 : NULL) {
		const char *s = at + strspn(at, " \t");
		size_t n = strlen(key);

		if (*s == '*')
			break;
		if (strncmp(s, key, n) != 0)
			continue;
		s += n + strspn(s + n, " \t");
		if (*s == '=')
			return s + 1 + strspn(s + 1, " \t");
	}
	return NULL;
}

static double sdf_number(const struct content *c, const char *key)
{
	const char *at = sdf_key(c, key);
	double value;
	char *end;

	if (!at)
		die(EXIT_RUN, "%s: no %s in the header", c->name, key);
	value = strtod(at, &end);
	if (end == at || !strchr(" \t\r\n", *end))
		die(EXIT_RUN, "%s: %s is '%.*s', want a number", c->name, key,
			(int)strcspn(at, "\r\n"), at);
	return value;
}

/* A height, or a word for none; dies at anything else. */
static double sdf_height(const struct content *c, const char **at)
{
	size_t n = strcspn(*at, " \t\r\n,");
	char word[32], *end;
	double v = sample_parse(*at, &end);

	snprintf(word, sizeof word, "%.*s", n < sizeof word ? (int)n : 31, *at);
	if (end != *at + n) {
		v = NAN;
		if (n >= sizeof word || !is_gap(word))
			die(EXIT_RUN, "%s: '%s' among the heights, want a number or BAD",
				c->name, word);
	}
	*at += n;
	return v;
}

static void sdf_text(const struct content *c, const struct told *told, struct record *r)
{
	double dx = sdf_number(c, "Xscale"), dy = sdf_number(c, "Yscale");
	double unit = settle_unit(c, told, sdf_number(c, "Zscale")), *z;
	const char *at = c->data;
	size_t n;

	while (at && *at != '*')
		at = strchr(at, '\n') ? strchr(at, '\n') + 1 : NULL;
	if (!at)
		die(EXIT_RUN, "%s: no line of * after the header", c->name);
	if (sdf_key(c, "Compression") && sdf_number(c, "Compression") != 0)
		die(EXIT_RUN, "%s: the samples are compressed", c->name);
	settle_pixel(c, told, &dx, &dy);
	z = new_heights(
		c, sdf_number(c, "NumPoints"), sdf_number(c, "NumProfiles"), dx, dy, r);
	at++;
	n = (size_t)r->nx * (size_t)r->ny;
	for (size_t i = 0; i < n; i++) {
		double v;

		at += strspn(at, " \t\r\n,");
		if (!*at || *at == '*')
			die(EXIT_RUN, "%s: want %zu heights, got %zu", c->name, n, i);
		v = sdf_height(c, &at);
		*z++ = v == told->missing ? NAN : v * unit;
	}
	if (!*at)
		warn("%s: no newline at the end: the last height may be truncated",
			c->name);
	at += strspn(at, " \t\r\n,");
	if (*at && *at != '*')
		die(EXIT_RUN, "%s: more than %zu heights: '%.12s'", c->name, n, at);
}

static void sdf_binary(const struct content *c, const struct told *told, struct record *r)
{
	enum { HEADER = 81 };
	static const enum sample_type types[] = { UINT8, UINT16, UINT32, FLOAT32, INT8,
		INT16, INT32, FLOAT64 };
	double dx, dy, unit, missing = told->missing;
	int type;

	need(c, HEADER, "an SDF header");
	dx = number(c, 46, FLOAT64);
	dy = number(c, 54, FLOAT64);
	unit = settle_unit(c, told, number(c, 62, FLOAT64));
	type = (unsigned char)c->data[79];
	if (c->data[78])
		die(EXIT_RUN, "%s: the samples are compressed", c->name);
	if (type > 7)
		die(EXIT_RUN, "%s: samples of type %d, want 0 to 7", c->name, type);
	settle_pixel(c, told, &dx, &dy);
	new_heights(c, number(c, 42, UINT16), number(c, 44, UINT16), dx, dy, r);
	/* the smallest integer represents a missing sample */
	if (isnan(missing) && types[type] == INT16)
		missing = -32768;
	if (isnan(missing) && types[type] == INT32)
		missing = -2147483648.0;
	check_rest(c, take(c, HEADER, 0, types[type], 0, unit, missing, r), r);
}

static void sdf_read(const struct content *c, const struct told *told, struct record *r)
{
	if (*c->data == 'a')
		sdf_text(c, told, r);
	else
		sdf_binary(c, told, r);
}

/* ---- Digital Surf ---- */

static double sur_unit(const struct content *c, size_t at)
{
	size_t n = 16;
	double unit;

	while (n > 0 && (c->data[at + n - 1] == ' ' || c->data[at + n - 1] == '\0'))
		n--;
	unit = unit_named(c->data + at, n);
	if (isnan(unit))
		die(EXIT_RUN, "%s: unit '%.*s' is not a unit of length", c->name, (int)n,
			c->data + at);
	return unit;
}

static void sur_read(const struct content *c, const struct told *told, struct record *r)
{
	enum { HEADER = 512 };
	double dx, dy, scale, offset, missing = told->missing, lowest;
	size_t at;
	int bits;

	need(c, HEADER, "a .sur header");
	if (number(c, 12, INT16) != 0)
		die(EXIT_RUN, "%s: big-endian files are not supported", c->name);
	if (number(c, 18, INT16) != 2 && number(c, 18, INT16) != 1)
		die(EXIT_RUN,
			"%s: object of type %g, want a surface (2) or a profile (1)",
			c->name, number(c, 18, INT16));
	bits = (int)number(c, 98, INT16);
	if (bits != 16 && bits != 32)
		die(EXIT_RUN, "%s: %d bits a sample, want 16 or 32", c->name, bits);
	dx = number(c, 120, FLOAT32) * sur_unit(c, 180);
	dy = number(c, 124, FLOAT32) * sur_unit(c, 196);
	if (number(c, 112, INT32) == 1)
		dy = dx;
	settle_pixel(c, told, &dx, &dy);
	scale = settle_unit(c, told, number(c, 128, FLOAT32) * sur_unit(c, 212));
	offset = number(c, 474, FLOAT32) * sur_unit(c, 212);
	lowest = number(c, 100, INT32);
	if (isnan(missing) && number(c, 86, INT16) == 1)
		missing = lowest - 2;
	at = HEADER + (size_t)number(c, 334, UINT16) + (size_t)number(c, 336, UINT16);
	new_heights(c, number(c, 108, INT32), number(c, 112, INT32), dx, dy, r);
	at = take(c, at, 0, bits == 16 ? INT16 : INT32, 0, scale, missing, r);
	if (number(c, 14, INT16) == 1) /* objects in the file */
		check_rest(c, at, r);
	for (size_t i = 0; i < (size_t)r->nx * (size_t)r->ny; i++)
		r->data[0][i] += offset;
}

/* ---- Alicona ---- */

/* Tags of 20 bytes of name, 30 of value and a line end; NAN if there is none. */
static double al3d_tag(const struct content *c, const char *key)
{
	enum { MAGIC = 17, TAG = 52 };

	for (size_t at = MAGIC; at + TAG <= c->size && c->data[at + 50] == '\r';
		at += TAG) {
		char value[31] = "";

		if (strncmp(c->data + at, key, 20) != 0)
			continue;
		memcpy(value, c->data + at + 20, 30);
		return strtod(value, NULL);
	}
	return NAN;
}

static void al3d_read(const struct content *c, const struct told *told, struct record *r)
{
	double dx = al3d_tag(c, "PixelSizeXMeter"), dy = al3d_tag(c, "PixelSizeYMeter");
	double at = al3d_tag(c, "DepthImageOffset"),
	       missing = al3d_tag(c, "InvalidPixelValue");
	double nx = al3d_tag(c, "Cols"), ny = al3d_tag(c, "Rows");
	size_t row;

	if (!(at > 0))
		die(EXIT_RUN, "%s: no DepthImageOffset: the file holds no heights",
			c->name);
	if (!(at < (double)c->size))
		die(EXIT_RUN, "%s: heights from byte %g on, but the file has %zu",
			c->name, at, c->size);
	settle_pixel(c, told, &dx, &dy);
	new_heights(c, nx, ny, dx, dy, r);
	/* rows begin at multiples of 8 bytes */
	row = ((size_t)r->nx * 4 + 7) / 8 * 8;
	take(c, (size_t)at, row, FLOAT32, 0, settle_unit(c, told, 1),
		isnan(told->missing) ? missing : told->missing, r);
}

/* ---- raw ---- */

static void raw_read(const struct content *c, const struct told *told, struct record *r)
{
	double dx = NAN, dy = NAN, unit = settle_unit(c, told, NAN);
	size_t bytes = (size_t)told->nx * (size_t)told->ny * width_of[told->type];

	settle_pixel(c, told, &dx, &dy);
	if (c->size != told->skip + bytes)
		die(EXIT_RUN, "%s: want %zu bytes, got %zu", c->name, told->skip + bytes,
			c->size);
	new_heights(c, told->nx, told->ny, dx, dy, r);
	take(c, told->skip, 0, told->type, told->big_endian, unit, told->missing, r);
}

void formats_read(const struct content *c, const struct told *told, struct record *r)
{
	static void (*const readers[])(const struct content *, const struct told *,
		struct record *) = { text_read, text_read, npy_read, sdf_read, sur_read,
		al3d_read, raw_read };

	readers[told->format](c, told, r);
}
