/* surfimport - bring measured heights from other formats into a stream of fields */
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "formats_in.h"
#include "io/fields.h"
#include "io/reasons.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const format_words[] = { "auto", "text", "npy", "sdf", "sur", "al3d",
	"raw", NULL };
static const char *const type_words[] = { "float64", "float32", "int32", "int16",
	"uint16", "uint8", "int64", "uint32", "int8", NULL };

static int format, type, profile, big_endian;
static struct opt_list pixel, size;
static double unit = NAN, missing = NAN, skip;
static long first;
static const char *made_by;

static const struct opt opts[] = {
	{ 0, "format", OPT_WORD, UNIT_NONE, &format, 0, 0,
		"auto|text|npy|sdf|sur|al3d|raw",
		"format of the file; auto: recognised by its first bytes", format_words,
		0 },
	{ 0, "pixel", OPT_LIST, UNIT_LENGTH, &pixel, 1e-15, 1, "D[xD]",
		"spacing of the samples, if the file does not state it", NULL, 0 },
	{ 0, "height-unit", OPT_NUM, UNIT_LENGTH, &unit, 1e-30, 1e6, "U",
		"length represented by a height of 1, if the file does not state it",
		NULL, 0 },
	{ 0, "missing", OPT_NUM, UNIT_NONE, &missing, -INFINITY, INFINITY, "V",
		"number that represents a missing sample", NULL, 0 },
	{ 0, "profile", OPT_FLAG, UNIT_NONE, &profile, 0, 0, NULL,
		"text: the last two columns are positions and heights of a profile", NULL,
		0 },
	{ 0, "size", OPT_LIST, UNIT_COUNT, &size, 1, 65536, "NXxNY",
		"raw: samples along x and y", NULL, 0 },
	{ 0, "type", OPT_WORD, UNIT_NONE, &type, 0, 0,
		"float64|float32|int32|int16|uint16|uint8|int64|uint32|int8",
		"raw: type of a sample", type_words, 0 },
	{ 0, "big-endian", OPT_FLAG, UNIT_NONE, &big_endian, 0, 0, NULL,
		"raw: samples are big-endian", NULL, 0 },
	{ 0, "skip", OPT_NUM, UNIT_COUNT, &skip, 0, 1e15, "N",
		"raw: number of bytes before the samples", NULL, 0 },
	{ 0, "made-by", OPT_TEXT, UNIT_NONE, &made_by, 0, 0, "CMD",
		"command that wrote standard input, for the record", NULL, 0 },
	{ 'f', "first", OPT_INT, UNIT_COUNT, &first, 0, 1e15, "K",
		"number of the realisation", NULL, 0 },
	OPT_END,
};

static const struct prog prog = { "surfimport",
	"Convert measured heights from other formats to a stream of fields.", "[file]",
	"a file of heights: text, npy, sdf, sur, al3d, raw", "fields: height", opts };

static void read_all(FILE *f, struct content *c)
{
	size_t room = 1 << 16, n;

	c->data = xcalloc(room + 1, 1);
	while ((n = fread(c->data + c->size, 1, room - c->size, f)) > 0) {
		c->size += n;
		if (c->size == room) {
			room *= 2;
			c->data = xrealloc(c->data, room + 1, 1);
		}
	}
	if (ferror(f))
		die(EXIT_RUN, "%s:", c->name);
	c->data[c->size] = '\0';
}

static enum in_format recognise(const struct content *c)
{
	static const struct {
		const char *magic;
		size_t length;
		enum in_format format;
		const char *advice;
	} known[] = {
		{ "\x93NUMPY", 6, IN_NPY, NULL },
		{ "DIGITAL SURF", 12, IN_SUR, NULL },
		{ "DSCOMPRESSED", 12, IN_SUR,
			"is a compressed .sur: write it without compression" },
		{ "AliconaImaging", 14, IN_AL3D, NULL },
		{ "aISO-", 5, IN_SDF, NULL },
		{ "bISO-", 5, IN_SDF, NULL },
		{ "aBCR-", 5, IN_SDF, NULL },
		{ "bBCR-", 5, IN_SDF, NULL },
		{ "PK\003\004", 4, IN_TEXT,
			"is a zip container: surfunzip reads .x3p and .plux" },
		{ "NRRD", 4, IN_TEXT, "is NRRD already: roughgen reads it" },
		{ "Gwyddion Simple", 15, IN_TEXT, "is GSF: roughgen reads it" },
	};

	for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
		if (c->size < known[i].length ||
			memcmp(c->data, known[i].magic, known[i].length) != 0)
			continue;
		if (known[i].advice)
			die(EXIT_RUN, "%s: %s", c->name, known[i].advice);
		return known[i].format;
	}
	return IN_TEXT;
}

static void check_options(void)
{
	if (format == IN_RAW && size.n != 2)
		die(EXIT_USAGE, "--format raw requires --size NXxNY");
	if (format != IN_RAW && (size.n || skip > 0 || big_endian || opt_given("type")))
		die(EXIT_USAGE,
			"--size, --type, --skip and --big-endian are for --format "
			"raw");
	if (profile && format != IN_AUTO && format != IN_TEXT)
		die(EXIT_USAGE, "--profile requires --format text");
}

/* No relief of the earth has 100 km, and no atom a part in 1e10 of its diameter: such
 * heights are numbers of another type, byte order or unit. */
static void check_heights(const char *name, double most)
{
	if (most > 1e5 || (most > 0 && most < 1e-20))
		die(EXIT_RUN,
			"%s: heights of up to %.3g m: want another type, byte order or unit",
			name, most);
}

int main(int argc, char **argv)
{
	struct told told = { 0 };
	struct content c = { 0 };
	struct record r = { 0 };
	struct fields_out *out;
	FILE *f;
	double gaps = 0, most = 0;
	const char *why;
	size_t n;

	int operand = opt_parse(&prog, argc, argv);
	check_options();
	f = file_open(argv[operand], &c.name);
	read_all(f, &c);
	told.format = format == IN_AUTO ? recognise(&c) : (enum in_format)format;
	told.dx = pixel.n ? pixel.v[0] : NAN;
	told.dy = pixel.n ? pixel.v[pixel.n - 1] : NAN;
	told.unit = unit;
	told.missing = missing;
	told.profile = profile;
	told.nx = size.n == 2 ? (int)size.v[0] : 0;
	told.ny = size.n == 2 ? (int)size.v[1] : 0;
	told.type = (enum sample_type)type;
	told.big_endian = big_endian;
	told.skip = (size_t)skip;
	formats_read(&c, &told, &r);
	r.realisation = first;
	r.cmd = opt_cmd(made_by, NULL);
	n = (size_t)r.nx * (size_t)r.ny;
	for (size_t i = 0; i < n; i++) {
		if (isinf(r.data[0][i]))
			r.data[0][i] = NAN;
		gaps += isnan(r.data[0][i]);
		most = fmax(most, fabs(r.data[0][i]));
	}
	check_heights(c.name, most);
	if (gaps == (double)n)
		die(EXIT_RUN, "%s: every height is missing", c.name);
	note("%d x %d samples of %g x %g m, %.0f missing", r.nx, r.ny, r.dx, r.dy, gaps);
	stats_set("samples", (double)n);
	stats_set("samples_missing", gaps);
	out = fields_create(NULL);
	fields_write(out, &r, 0);
	fields_done(out);
	why = reasons_tell(c.name, record_get(&r, "doubtful"));
	record_free(&r);
	free(c.data);
	return shell_done(why ? EXIT_NOCONV : EXIT_SUCCESS);
}
