#include "instrument_file.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "io/tables.h"
#include "num/crc32.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Of the rows and their meaning. */
static const char *const version = "7";

static uint32_t add(uint32_t crc, double value)
{
	return crc32_add(crc, &value, sizeof value);
}

/* What was given instead of learned. */
static uint32_t options_of(const struct instrument_place *place)
{
	const struct calibrate_par *par = place->known;
	uint32_t crc = 0;

	crc = add(crc, isnan(par->lag) ? -1 : par->lag);
	crc = add(crc, isnan(par->duration) ? -1 : par->duration);
	crc = add(crc, isnan(par->gain) ? -1 : par->gain);
	crc = add(crc, par->pulse);
	crc = add(crc, isnan(par->spread) ? -1 : par->spread);
	crc = add(crc, par->false_alarm);
	crc = add(crc, par->tones);
	for (int k = 0; k < par->tones; k++)
		crc = add(crc, par->omega[k]);
	for (size_t k = 0; par->filter && k < par->filter_taps; k++)
		crc = add(crc, par->filter[k]);
	return isnan(place->angle) ? crc : add(crc, place->angle);
}

/* --- write */

/* For people: what the rows say with its uncertainty. */
static void describe(struct table_out *t, const struct instrument_place *place,
	const struct instrument *in)
{
	const struct calibration *c = &in->cal;
	const struct flow *f = &in->flow;
	double rate = place->rate / in->ratio;
	double delay = ((double)c->shift + f->mean + c->origin) / rate;
	double v = place->spacing / delay, spread = sqrt(f->var) / rate / delay;
	double common = c->origin_se / rate / delay;

	table_comment(t, "noise", "%.6g V, %.6g V", c->noise[0], c->noise[1]);
	table_comment(t, "pulse", "%.6g s, gain %.6g, width %.6g, from %d pulses",
		c->duration / rate, c->gain, c->width, c->events);
	for (int k = 0; k < c->tones; k++)
		table_comment(t, "line", "%.6g Hz", c->omega[k] * rate / (2 * M_PI));
	if (f->count > 0 && delay > 0)
		table_comment(t, "velocity",
			"%.6g +- %.2g m/s of the flow, +- %.2g m/s of a particle, from "
			"%.0f",
			v, v * hypot(spread / sqrt(f->count), common), v * spread,
			f->count);
}

void instrument_write(const struct instrument_place *place, const struct instrument *in)
{
	struct instrument_value *v;
	size_t n;
	struct table_out *t;

	if (instrument_values(in, &v, &n) != NUM_OK)
		die(EXIT_RUN, "no memory");
	t = table_replace(place->path, NULL, "1 1 1", "name index value");
	table_comment(t, "instrument", "%s", version);
	table_comment(t, "rate", "%.17g", place->rate);
	table_comment(t, "spacing", "%.17g", place->spacing);
	table_comment(t, "options", "%08lx", (unsigned long)options_of(place));
	describe(t, place, in);
	for (size_t i = 0; i < n; i++) {
		const double cell[2] = { v[i].index, v[i].value };

		table_put_text(t, v[i].name);
		table_put_row(t, cell, 2);
	}
	table_done(t);
	free(v);
}

/* --- read */

static const char *key_of(const struct table_in *t, const char *key)
{
	const char *value = table_key(t, key);

	if (!value)
		die(EXIT_RUN,
			"%s: not written by duet --instrument: it has no key "
			"'%s'",
			table_name(t), key);
	return value;
}

static void check_keys(const struct table_in *t, const struct instrument_place *place)
{
	const char *found = key_of(t, "instrument");
	double rate = strtod(key_of(t, "rate"), NULL),
	       spacing = strtod(key_of(t, "spacing"), NULL);

	if (strcmp(found, version) != 0)
		die(EXIT_RUN, "%s: an instrument of version %s, want version %s",
			table_name(t), found, version);
	if (rate != place->rate)
		die(EXIT_RUN, "%s: learned at %g Hz, the record has %g Hz", table_name(t),
			rate, place->rate);
	if (spacing != place->spacing)
		die(EXIT_RUN, "%s: learned with sensors %g m apart, --spacing is %g m",
			table_name(t), spacing, place->spacing);
	if (strtoul(key_of(t, "options"), NULL, 16) != options_of(place))
		die(EXIT_RUN,
			"%s: learned with other options of the instrument, or through "
			"another filter",
			table_name(t));
}

/* The rows; *names holds their names, which free() frees. */
static size_t read_rows(struct table_in *t, struct instrument_value **v, char ***names)
{
	int name = table_need(t, "name"), index = table_need(t, "index"),
	    value = table_need(t, "value");
	size_t n = 0, room = 0;

	*v = NULL;
	*names = NULL;
	while (table_next(t)) {
		if (n == room) {
			room = room ? 2 * room : 1024;
			*v = xrealloc(*v, room, sizeof **v);
			*names = xrealloc(*names, room, sizeof **names);
		}
		(*names)[n] = xstrdup(table_text(t, name));
		(*v)[n] = (struct instrument_value){ (*names)[n],
			(int)table_whole(t, index, 0, 1e9), table_number(t, value) };
		n++;
	}
	return n;
}

/* A file that cannot be written is named before hours of the record are read. */
static void check_directory(const char *path)
{
	const char *slash = strrchr(path, '/');
	char *directory =
		slash ? xprintf("%.*s", (int)(slash - path + 1), path) : xstrdup(".");

	if (access(directory, W_OK))
		die(EXIT_RUN, "%s:", path);
	free(directory);
}

int instrument_read(const struct instrument_place *place, struct instrument *in)
{
	struct instrument_value *v;
	enum instrument_status status;
	const char *which = "";
	struct table_in *t;
	char **names;
	size_t n;

	if (access(place->path, F_OK) != 0) {
		if (!getenv(FILE_REPLAY))
			check_directory(place->path);
		return 0;
	}
	t = table_open(place->path);
	check_keys(t, place);
	n = read_rows(t, &v, &names);
	if (!table_marked(t)) /* the end mark has a checksum */
		die(EXIT_RUN, "%s: no end mark: it may be damaged", table_name(t));
	status = instrument_restore(in, v, n, &which);
	if (status == INSTRUMENT_MEMORY)
		die(EXIT_RUN, "no memory");
	if (status == INSTRUMENT_MISSING)
		die(EXIT_RUN, "%s: '%s' is missing or out of range", table_name(t),
			which);
	if (status == INSTRUMENT_UNKNOWN)
		die(EXIT_RUN, "%s: some rows do not belong to an instrument",
			table_name(t));
	table_close(t);
	for (size_t i = 0; i < n; i++)
		free(names[i]);
	free(names);
	free(v);
	return 1;
}
