#include "cli/files.h"
#include "cli/msg.h"
#include "cli/unit.h"
#include "recording.h"
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>

enum { AHEAD = 64 }; /* rows used to estimate the rate */

struct text_in {
	FILE *f;
	const char *name;
	char *line;
	size_t room;
	long number; /* of the line */
	char separator;
	int commas; /* decimal commas are possible */
	int cells;
	char **heading;
	int *taken; /* cells of the channels */
	double *scale;
	int time; /* cell, -1: none */
	double time_scale, step, first, last;
	double *ahead; /* rows read to learn the rate: times and channels */
	size_t nahead, at;
	long rows;
	struct signal_format format;
};

/* The next line that is neither empty nor a comment; 0 at the end. */
static int next_line(struct text_in *t)
{
	ssize_t n;

	while ((n = getline(&t->line, &t->room, t->f)) > 0) {
		t->number++;
		while (n > 0 && strchr("\r\n", t->line[n - 1]))
			t->line[--n] = '\0';
		if ((size_t)n != strlen(t->line))
			die(EXIT_RUN, "%s: line %ld: NUL byte: not a text file", t->name,
				t->number);
		if (t->number <= 1 && strncmp(t->line, "\xef\xbb\xbf", 3) == 0)
			memmove(t->line, t->line + 3, (size_t)n - 2);
		if (t->line[strspn(t->line, " \t")] && *t->line != '#')
			return 1;
	}
	if (ferror(t->f))
		die(EXIT_RUN, "%s:", t->name);
	return 0;
}

static char *trimmed(char *s)
{
	char *end = s + strlen(s);

	while (end > s && strchr(" \t\"", end[-1]))
		*--end = '\0';
	return s + strspn(s, " \t\"");
}

/* Cuts the line; returns how many cells there are. */
static int cut(const struct text_in *t, char *line, char **cell, int most)
{
	int n = 0;

	for (char *s = line; s && n < most;) {
		char *next;

		if (t->separator == ' ')
			s += strspn(s, " \t");
		if (t->separator == ' ' && !*s)
			break;
		next = t->separator == ' ' ? strpbrk(s, " \t") : strchr(s, t->separator);
		if (next)
			*next++ = '\0';
		cell[n++] = trimmed(s);
		s = next;
	}
	return n;
}

static int number(const struct text_in *t, char *s, double *v)
{
	char *end;

	*v = NAN;
	if (!*s || !strcmp(s, "nan") || !strcmp(s, "NaN") || !strcmp(s, "NA"))
		return 1;
	if (t->commas && strchr(s, ',') && !strchr(s, '.'))
		*strchr(s, ',') = '.';
	*v = strtod(s, &end);
	return end != s && !*end;
}

/* The unit in "Flow [L/min]" or "u (mV)", cut off its heading; NULL if there is none.
 */
static char *unit_of(char *heading)
{
	size_t n = strlen(heading);
	char *open, *unit;

	if (n < 3 || !strchr("])", heading[n - 1]))
		return NULL;
	open = strrchr(heading, heading[n - 1] == ']' ? '[' : '(');
	if (!open || open == heading)
		return NULL;
	heading[n - 1] = '\0';
	unit = open + 1;
	*open = '\0';
	for (; open > heading && open[-1] == ' '; open--)
		open[-1] = '\0';
	return unit;
}

static int same(const char *a, const char *b)
{
	for (; *a && tolower((unsigned char)*a) == tolower((unsigned char)*b); a++, b++)
		;
	return !*a && !*b;
}

static int find(const struct text_in *t, const char *name)
{
	char *end;
	long n = strtol(name, &end, 10);

	for (int i = 0; i < t->cells; i++)
		if (same(t->heading[i], name))
			return i;
	if (end != name && !*end && n >= 1 && n <= t->cells)
		return (int)n - 1;
	return -1;
}

static void take(struct text_in *t, int cell)
{
	t->taken[t->format.channels++] = cell;
}

static void choose(struct text_in *t, const struct recording_par *par)
{
	char *list = par->columns ? xstrdup(par->columns) : NULL, *rest = list;

	t->time = par->time ? find(t, par->time) : find(t, "time");
	if (t->time < 0 && !par->time)
		t->time = find(t, "t");
	if (par->time && t->time < 0)
		die(EXIT_RUN, "%s: no column '%s'", t->name, par->time);
	for (int i = 0; !list && i < t->cells; i++)
		if (i != t->time)
			take(t, i);
	while (rest && *rest) {
		char *name = rest, *end = strchr(rest, ';');
		int cell;

		rest = end ? end + 1 : NULL;
		if (end)
			*end = '\0';
		cell = find(t, trimmed(name));
		if (cell < 0)
			die(EXIT_RUN, "%s: no column '%s'", t->name, name);
		if (t->format.channels == t->cells)
			die(EXIT_USAGE, "--columns: the table has only %d", t->cells);
		take(t, cell);
	}
	free(list);
	if (!t->format.channels)
		die(EXIT_RUN, "%s: no column other than the times", t->name);
}

/* Scales to SI by the units of the headings; those that are not known stay as they are.
 */
static void scale_units(struct text_in *t, char **unit)
{
	char *units = xstrdup("");

	t->time_scale = 1;
	if (t->time >= 0 && unit[t->time]) {
		char *one = xprintf("1%s", unit[t->time]);
		const char *end,
			*wrong = unit_parse(one, UNIT_TIME, "", &t->time_scale, &end);

		if (wrong)
			die(EXIT_RUN, "%s: times in '%s', want a unit of time", t->name,
				unit[t->time]);
		free(one);
	}
	for (int c = 0; c < t->format.channels; c++) {
		const char *name = unit[t->taken[c]], *end;
		char *one = xprintf("1%s", name ? name : ""), *longer;

		t->scale[c] = 1;
		if (name && unit_parse(one, UNIT_VOLTAGE, "", &t->scale[c], &end) == NULL)
			name = "V";
		else
			t->scale[c] = 1;
		longer = xprintf("%s%s%s", units, c ? " " : "", name ? name : "1");
		free(units);
		units = longer;
		free(one);
	}
	t->format.units = units;
}

/* Takes one row into time and channels; 0 at the end. */
static int read_row(struct text_in *t, double *row)
{
	char **cell;
	char *copy;
	int n;

	if (!next_line(t))
		return 0;
	cell = xcalloc((size_t)t->cells + 1, sizeof *cell);
	copy = xstrdup(t->line);
	n = cut(t, t->line, cell, t->cells + 1);
	if (n != t->cells && !(n == t->cells + 1 && !*cell[n - 1]))
		die(EXIT_RUN, "%s: line %ld: want %d cells, got %d", t->name, t->number,
			t->cells, n);
	row[0] = NAN;
	if (t->time >= 0 && (!number(t, cell[t->time], &row[0]) || !isfinite(row[0])))
		die(EXIT_RUN, "%s: line %ld: no time: %.40s", t->name, t->number, copy);
	row[0] *= t->time_scale;
	for (int c = 0; c < t->format.channels; c++) {
		if (!number(t, cell[t->taken[c]], &row[1 + c]))
			die(EXIT_RUN, "%s: line %ld: not a number: %.40s", t->name,
				t->number, copy);
		row[1 + c] *= t->scale[c];
	}
	free(copy);
	free(cell);
	return 1;
}

/* Every time must be within half a step of that of the rate. */
static void check_time(struct text_in *t, double time)
{
	double want = t->first + (double)t->rows * t->step;

	if (t->time >= 0 && t->step > 0 && fabs(time - want) > 0.5 * t->step)
		die(EXIT_RUN,
			"%s: line %ld: time %.9g s, want %.9g s: samples are missing or "
			"the rate is not %ld Hz",
			t->name, t->number, time, want, t->format.rate);
	t->rows++;
}

static void learn_rate(struct text_in *t, const struct recording_par *par)
{
	size_t width = (size_t)t->format.channels + 1;
	double rate = par->rate;

	t->ahead = xcalloc(AHEAD * width, sizeof *t->ahead);
	while (t->nahead < AHEAD && read_row(t, t->ahead + t->nahead * width))
		t->nahead++;
	if (t->time >= 0 && t->nahead > 1) {
		double span = t->ahead[(t->nahead - 1) * width] - t->ahead[0];

		if (!(span > 0))
			die(EXIT_RUN, "%s: the times are not ascending", t->name);
		if (isnan(rate))
			rate = (double)(t->nahead - 1) / span;
		t->first = t->ahead[0];
	}
	if (isnan(rate))
		die(EXIT_RUN, "%s: no column of times: specify --rate", t->name);
	t->format.rate = (long)(rate + 0.5);
	/* within the resolution of rounded times over 64 rows */
	if (t->format.rate < 1 || fabs(rate - (double)t->format.rate) > 2e-3 * rate)
		die(EXIT_RUN,
			"%s: %.6g samples per second is not an integer: specify --rate",
			t->name, rate);
	t->step = 1 / (double)t->format.rate;
}

struct text_in *text_open(const char *path, const struct recording_par *par)
{
	struct text_in *t = xcalloc(1, sizeof *t);
	char **unit, *copy;
	double v;
	int numbers = 1;

	t->f = file_open(path, &t->name);
	for (long i = 0; i < par->skip; i++, t->number++)
		if (getline(&t->line, &t->room, t->f) <= 0)
			die(EXIT_RUN, "%s: ends within --skip-lines %ld", t->name,
				par->skip);
	if (!next_line(t))
		die(EXIT_RUN, "%s: no row", t->name);
	t->separator = strchr(t->line, '\t')  ? '\t'
		       : strchr(t->line, ';') ? ';'
		       : strchr(t->line, ',') ? ','
					      : ' ';
	t->commas = t->separator != ',';
	t->heading = xcalloc(strlen(t->line) + 2, sizeof *t->heading);
	copy = xstrdup(t->line);
	t->cells = cut(t, copy, t->heading, (int)strlen(t->line) + 1);
	unit = xcalloc((size_t)t->cells + 1, sizeof *unit);
	t->taken = xcalloc((size_t)t->cells + 1, sizeof *t->taken);
	t->scale = xcalloc((size_t)t->cells + 1, sizeof *t->scale);
	for (int i = 0; i < t->cells; i++) {
		char *cell = xstrdup(t->heading[i]);

		numbers &= number(t, cell, &v);
		free(cell);
	}
	if (numbers)
		die(EXIT_RUN, "%s: line %ld: want a line of headings", t->name,
			t->number);
	for (int i = 0; i < t->cells; i++)
		unit[i] = unit_of(t->heading[i]);
	choose(t, par);
	scale_units(t, unit);
	learn_rate(t, par);
	free(unit);
	return t;
}

const struct signal_format *text_format(const struct text_in *t)
{
	return &t->format;
}

size_t text_read(struct text_in *t, double *x, size_t frames)
{
	size_t c = (size_t)t->format.channels, n = 0;
	double *row = xcalloc(c + 1, sizeof *row);

	for (; n < frames; n++) {
		if (t->at < t->nahead)
			memcpy(row, t->ahead + t->at++ * (c + 1), (c + 1) * sizeof *row);
		else if (!read_row(t, row))
			break;
		check_time(t, row[0]);
		memcpy(x + n * c, row + 1, c * sizeof *x);
	}
	free(row);
	return n;
}

void text_close(struct text_in *t)
{
	if (t->f != stdin)
		fclose(t->f);
	free(t->ahead);
	free(t->taken);
	free(t->scale);
	free(t->heading);
	free(t->line);
	free(t);
}
