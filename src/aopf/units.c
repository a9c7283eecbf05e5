#include "units.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "event_list.h"
#include "filter_options.h"
#include "fleet_table.h"
#include "num/checksum.h"
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { NAME = 64, FILTERED = 5 };

struct progress {
	int64_t rows;
	double last, value; /* time and y of the last row */
	double clock;       /* of the last row read, which is ahead in a block */
};

struct machine {
	char *name;
	int number; /* in order of appearance, over all runs */
	struct progress now;
	int resumed;
	uint64_t sequence;       /* of the last saved state */
	struct adaptive *filter; /* NULL if bare */
	struct outlook *outlook; /* NULL without a threshold */
};

struct units {
	int bare;
	struct machine **unit;
	int n;
	int *of_input, n_input; /* unit of each number in the input */
	FILE *file;             /* NULL: nothing is kept */
	const char *path;
	size_t size; /* of the state of a unit */
	int damaged; /* 1: not all of the state to resume from was complete */
	unsigned char *place;
};

/* At the start of the file, and of each slot in it. */
struct head {
	char magic[16];
	uint64_t options, fleet, size;
};

struct place {
	uint64_t sequence, check;
	char name[NAME];
	struct progress now;
};

static const char magic[16] = "aopf state 16\n";

struct units *units_new(int bare)
{
	struct units *units = xcalloc(1, sizeof *units);

	units->bare = bare;
	return units;
}

static struct machine *add_unit(struct units *units, int number, const char *name)
{
	struct machine *u = xcalloc(1, sizeof *u);

	u->name = xstrdup(name);
	u->number = number;
	u->now.clock = -INFINITY;
	if (!units->bare)
		u->filter = filtering_new(number);
	if (!isnan(outlook_threshold))
		u->outlook = outlook_new(u->name, u->filter);
	units->unit = xrealloc(units->unit, (size_t)units->n + 1, sizeof *units->unit);
	return units->unit[units->n++] = u;
}

static void free_unit(struct machine *u)
{
	outlook_free(u->outlook);
	adaptive_free(u->filter);
	free(u->name);
	free(u);
}

void units_free(struct units *units)
{
	for (int i = 0; i < units->n; i++) {
		struct machine *u = units->unit[i];

		stats_add("rows", (double)u->now.rows);
		if (u->filter)
			filtering_count(u->filter);
		if (u->outlook)
			outlook_count(u->outlook);
		free_unit(u);
	}
	if (units->file && fclose(units->file))
		die(EXIT_RUN, "%s:", units->path);
	free(units->unit);
	free(units->of_input);
	free(units->place);
	free(units);
}

int units_alarm(const struct units *units)
{
	int active = 0;

	for (int i = 0; i < units->n; i++)
		active |= units->unit[i]->outlook &&
			  outlook_alarm(units->unit[i]->outlook) > 0;
	return active;
}

int units_report(const struct units *units)
{
	int resumed = 0, doubtful = units->damaged;

	for (int i = 0; i < units->n; i++) {
		const struct machine *u = units->unit[i];

		resumed += u->resumed;
		if (u->outlook)
			doubtful |= outlook_settle(u->outlook);
	}
	for (int i = 0; i < units->n_input && resumed > 0; i++)
		if (units->unit[units->of_input[i]]->resumed)
			resumed = 0;
	if (resumed > 0 && units->n_input > 0) {
		warn("the series has no unit of the saved state, whose first is '%s'",
			units->unit[0]->name);
		doubtful = 1;
	}
	return event_list_report() | doubtful;
}

struct machine *units_find(struct units *units, int number, const char *name)
{
	int i = 0;

	if (number < units->n_input)
		return units->unit[units->of_input[number]];
	while (i < units->n &&
		!(units->unit[i]->resumed && strcmp(units->unit[i]->name, name) == 0))
		i++;
	if (i == units->n)
		add_unit(units, units->n, name);
	units->of_input =
		xrealloc(units->of_input, (size_t)number + 1, sizeof *units->of_input);
	units->of_input[number] = i;
	units->n_input = number + 1;
	return units->unit[i];
}

int unit_number(const struct machine *u)
{
	return u->number;
}

int unit_takes(
	struct machine *u, const struct outlook_row *in, const struct table_in *from)
{
	const char *file = table_name(from), *colon = *u->name ? ": " : "";
	long line = table_line(from);

	if (u->resumed && in->t <= u->now.last) {
		if (in->t == u->now.last && in->y != u->now.value &&
			!(isnan(in->y) && isnan(u->now.value)))
			die(EXIT_RUN,
				"%s: line %ld: %s%sy is %g, but was %g when the state was "
				"saved: another series",
				file, line, u->name, colon, in->y, u->now.value);
		return 0;
	}
	if (!(in->clock >= u->now.clock))
		die(EXIT_RUN,
			"%s: line %ld: %s%soperating time %g comes after %g: it must not "
			"decrease",
			file, line, u->name, colon, in->clock, u->now.clock);
	u->now.clock = in->clock;
	return 1;
}

int unit_cells(int bare)
{
	return (bare ? 0 : FILTERED) + outlook_cells();
}

void unit_step(struct machine *u, const struct outlook_row *in, double *cell)
{
	struct adaptive_row row;

	u->now.rows++;
	u->now.last = in->t;
	u->now.value = in->y;
	if (u->filter) {
		adaptive_step(u->filter, in->t, in->y, &row);
		*cell++ = row.grey;
		*cell++ = row.prediction;
		*cell++ = row.state;
		*cell++ = row.order;
		*cell++ = row.ess;
	}
	if (u->outlook)
		outlook_step(u->outlook, in, u->filter ? &row : NULL, cell);
}

/* --- on disk ------------------------------------------------------------------------ */

static void pass(struct machine *u, struct state *s)
{
	if (u->filter)
		adaptive_pass(u->filter, s);
	if (u->outlook)
		outlook_pass(u->outlook, s);
}

/* The size of the state of any unit. */
static size_t state_size(struct units *units)
{
	struct state s = { 0 };
	struct machine *u = add_unit(units, 0, "");

	pass(u, &s);
	free_unit(u);
	units->n--;
	return s.size;
}

/* The head of a file, and the room for a state in it. */
static struct head head_of(struct units *units, const char *options)
{
	struct head h = { .size = state_size(units),
		.options = checksum(options, strlen(options), CHECKSUM_START),
		.fleet = fleet_table_checksum() };

	memcpy(h.magic, magic, sizeof magic);
	units->size = (size_t)h.size;
	free(units->place);
	units->place = xcalloc(1, sizeof(struct place) + units->size);
	return h;
}

static off_t offset_of(const struct units *units, int number, uint64_t sequence)
{
	size_t size = sizeof(struct place) + units->size;

	return (off_t)(sizeof(struct head) + (2 * (size_t)number + sequence % 2) * size);
}

static uint64_t check_of(const struct units *units, struct place p)
{
	p.check = 0;
	return checksum(units->place + sizeof p, units->size,
		checksum(&p, sizeof p, CHECKSUM_START));
}

/* Reads a slot; 1 if it is complete. */
static int read_place(
	struct units *units, FILE *f, int number, int which, struct place *p)
{
	size_t size = sizeof *p + units->size;

	if (fseeko(f, offset_of(units, number, (uint64_t)which), SEEK_SET) ||
		fread(units->place, 1, size, f) != size)
		return 0;
	memcpy(p, units->place, sizeof *p);
	return p->sequence > 0 && check_of(units, *p) == p->check;
}

/* The unit of that number, from its newer complete copy; 0 if there is none. */
static int resume_unit(struct units *units, FILE *f, int number)
{
	struct place place[2];
	int whole[2], newer;
	struct state s = { .load = 1 };
	struct machine *u;

	for (int k = 0; k < 2; k++)
		whole[k] = read_place(units, f, number, k, &place[k]);
	if (!whole[0] && !whole[1])
		return 0;
	newer = whole[1] && (!whole[0] || place[1].sequence > place[0].sequence);
	read_place(units, f, number, newer, &place[newer]);
	u = add_unit(units, number, place[newer].name);
	u->resumed = 1;
	u->sequence = place[newer].sequence;
	u->now = place[newer].now;
	s.at = units->place + sizeof place[0];
	pass(u, &s);
	return 1;
}

void units_resume(struct units *units, const char *path, const char *options)
{
	struct head want = head_of(units, options), h;
	FILE *f = fopen(path, "rb");

	if (!f)
		die(EXIT_RUN, "%s:", path);
	if (fread(&h, sizeof h, 1, f) != 1 || memcmp(h.magic, magic, sizeof magic) != 0)
		die(EXIT_RUN, "%s: no state saved by aopf --save", path);
	if (h.options != want.options || h.size != want.size)
		die(EXIT_RUN, "%s: saved with other options, or by another aopf", path);
	if (h.fleet != want.fleet)
		die(EXIT_RUN, "%s: saved with another fleet in the file of --fleet",
			path);
	while (resume_unit(units, f, units->n))
		;
	units->damaged =
		fseeko(f, 0, SEEK_END) == 0 && ftello(f) > offset_of(units, units->n, 0);
	if (units->damaged)
		warn("%s: the state is damaged from unit %d on: units after the first %d "
		     "begin anew",
			path, units->n + 1, units->n);
	fclose(f);
	stats_set("units_resumed", units->n);
}

static void write_at(struct units *units, const void *bytes, size_t n, off_t at)
{
	const unsigned char *p = bytes;

	while (n > 0) {
		ssize_t done = pwrite(fileno(units->file), p, n, at);

		if (done < 0 && errno == EINTR)
			continue;
		if (done <= 0)
			die(EXIT_RUN, "%s:", units->path);
		p += done;
		n -= (size_t)done;
		at += done;
	}
}

void units_keep(struct units *units, const char *path, const char *options)
{
	struct head h = head_of(units, options);
	char *fresh;
	const char *name;

	fclose(file_reserve(path, &name)); /* no file that is read */
	units->path = path;
	/* Written beside the state to resume from, which is replaced once this one is
	 * complete. */
	units->file = file_create_beside(path, &fresh);
	write_at(units, &h, sizeof h, 0);
	for (int i = 0; i < units->n; i++)
		unit_save(units, units->unit[i]);
	file_replace(fresh, path);
}

void unit_save(struct units *units, struct machine *u)
{
	struct place p = { .sequence = ++u->sequence, .now = u->now };
	struct state s = { .at = units->place + sizeof p };

	if (!units->file)
		return;
	if (strlen(u->name) >= NAME)
		die(EXIT_RUN, "%s: a name of %d characters or more cannot be saved",
			u->name, (int)NAME);
	memcpy(p.name, u->name, strlen(u->name));
	pass(u, &s);
	p.check = check_of(units, p);
	memcpy(units->place, &p, sizeof p);
	write_at(units, units->place, sizeof p + units->size,
		offset_of(units, u->number, p.sequence));
}
