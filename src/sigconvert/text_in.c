#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/text.h"
#include "cli/unit.h"
#include "io/tables.h"
#include "moment.h"
#include "recording.h"
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
	AHEAD = 256,
	LINE_MOST = 1 << 24
}; /* rows used to estimate the rate; bytes of a line */

struct text_in {
	struct input *in;
	const char *name;
	char *line;
	size_t room, most;
	long number; /* of the line */
	char separator;
	int commas;   /* decimal commas are possible */
	char decimal; /* of the numbers so far, 0: none had one */
	int cells;
	char **heading, **cell; /* names of the columns, and the present row */
	char **unit;            /* of each cell's heading, NULL: none */
	int *taken;             /* cells of the channels */
	char **name_of;         /* the channels */
	double *scale;
	int time; /* cell, -1: none */
	int rate; /* the same */
	double time_scale, step, first;
	double resolution; /* of the times as they are written, s */
	double rounding;   /* largest effect of it on the times, s */
	int absolute;      /* they are dates, counted from the first */
	struct moment start;
	double *ahead; /* rows read to learn the rate: times and channels */
	size_t nahead, at;
	long rows;
	struct signal_format format;
};

/* The next line, without its newline; 0 at the end. */
static int any_line(struct text_in *t)
{
	size_t n = input_text_line(t->in, &t->line, &t->room, t->most, &t->number);

	if (n == 0)
		return 0;
	if (t->line[n - 1] != '\n')
		warn("%s: line %ld: no newline at the end: the last row may be truncated",
			t->name, t->number);
	while (n > 0 && strchr("\r\n", t->line[n - 1]))
		t->line[--n] = '\0';
	if (n != strlen(t->line))
		die(EXIT_RUN, "%s: line %ld: NUL byte: not a text file", t->name,
			t->number);
	if (t->number == 1 && strncmp(t->line, "\xef\xbb\xbf", 3) == 0)
		memmove(t->line, t->line + 3, n - 2);
	return 1;
}

/* The next line that is neither empty nor a comment; 0 at the end. */
static int next_line(struct text_in *t)
{
	while (any_line(t))
		if (t->line[strspn(t->line, " \t")] && *t->line != '#')
			return 1;
	return 0;
}

static char *trimmed(char *s, const char *blank)
{
	char *end = s + strlen(s);

	while (end > s && strchr(blank, end[-1]))
		*--end = '\0';
	return s + strspn(s, blank);
}

/* The end of a quoted text that begins here, behind its quote; NULL if it has none.  A
 * quote within is doubled (RFC 4180). */
static char *behind_quoted(char *s)
{
	for (s++; *s && (*s != '"' || s[1] == '"'); s++)
		s += *s == '"';
	return *s ? s + 1 : NULL;
}

/* Removes the quotes of a quoted text that ends here. */
static char *unquoted(char *s, const char *end)
{
	char *to = s;

	for (const char *from = s + 1; from < end - 1; from++) {
		from += *from == '"';
		*to++ = *from;
	}
	*to = '\0';
	return s;
}

/* Cuts the line; returns how many cells there are. */
static int cut(const struct text_in *t, char *line, char **cell, int most)
{
	const char separator[] = { t->separator, t->separator == ' ' ? '\t' : '\0',
		'\0' };
	const char *blank = t->separator == '\t' ? " " : " \t";
	int n = 0;

	for (char *s = line; s && n < most;) {
		char *end, *next;
		int quoted;

		s += strspn(s, blank);
		if (t->separator == ' ' && !*s)
			break;
		quoted = *s == '"';
		end = quoted ? behind_quoted(s) : s + strcspn(s, separator);
		if (!end)
			die(EXIT_RUN,
				"%s: line %ld: a quoted cell has no end in this line",
				t->name, t->number);
		next = t->separator == ' ' ? end : end + strspn(end, blank);
		if (*next && !strchr(separator, *next))
			die(EXIT_RUN, "%s: line %ld: text behind a quoted cell", t->name,
				t->number);
		next = *next ? next + 1 : NULL;
		*end = '\0';
		cell[n++] =
			quoted ? trimmed(unquoted(s, end), " \t") : trimmed(s, " \t\"");
		s = next;
	}
	return n;
}

/* Whether the line has this text outside of quotes. */
static int has(char *line, const char *text)
{
	for (char *s = line; *s;) {
		char *end = *s == '"' ? behind_quoted(s) : NULL;

		if (strncmp(s, text, strlen(text)) == 0)
			return 1;
		s = end ? end : s + 1;
	}
	return 0;
}

/* A comma in a file of decimal points separates thousands: 1,234 is not 1.234. */
static int number(struct text_in *t, char *s, double *v)
{
	char *end, *point = strchr(s, '.');
	char decimal = point ? '.' : '\0';

	*v = NAN;
	if (!*s || !strcmp(s, "nan") || !strcmp(s, "NaN") || !strcmp(s, "NA"))
		return 1;
	if (t->commas && !point && (point = strchr(s, ','))) {
		decimal = ',';
		*point = '.';
	}
	*v = sample_parse(s, &end);
	if (end == s || *end)
		return 0;
	if (t->decimal && decimal && decimal != t->decimal)
		die(EXIT_RUN,
			"%s: line %ld: '%.*s%c%s': decimal points and commas in one file",
			t->name, t->number, (int)(point - s), s, decimal, point + 1);
	if (decimal)
		t->decimal = decimal;
	return 1;
}

/* The unit in "Flow [L/min]" or "u (mV)", removed from the heading; NULL if there is
 * none. */
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
	return *unit ? unit : NULL;
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
	int found = -1;

	/* t may be a time beside a temperature T */
	for (int fold = 0; fold < 2 && found < 0; fold++)
		for (int i = 0; i < t->cells; i++) {
			if (fold ? !same(t->heading[i], name)
				 : strcmp(t->heading[i], name) != 0)
				continue;
			if (found >= 0)
				die(EXIT_RUN,
					"%s: columns %d and %d are called '%.40s': choose one by its number",
					t->name, found + 1, i + 1, name);
			found = i;
		}
	if (found >= 0)
		return found;
	if (end != name && !*end && n >= 1 && n <= t->cells)
		return (int)n - 1;
	return -1;
}

/* The name of a heading in a table. */
static char *name_of(const char *heading, int lower)
{
	char *name = xstrdup(*heading ? heading : "-");

	for (char *s = name; *s; s++)
		*s = strchr(" \t:", *s) ? '_'
		     : lower            ? (char)tolower((unsigned char)*s)
					: *s;
	return name;
}

static void take(struct text_in *t, int cell, const char *name)
{
	t->name_of[t->format.channels] = name_of(name ? name : t->heading[cell], !name);
	t->taken[t->format.channels++] = cell;
}

static _Noreturn void no_column(const struct text_in *t, const char *name)
{
	struct text all = { 0 };

	for (int i = 0; i < t->cells && i < 12; i++)
		text_add(&all, "%s'%.40s'", i ? " " : "", t->heading[i]);
	die(EXIT_RUN, "%s: no column '%s' among %s", t->name, name, all.s);
}

static void choose(struct text_in *t, const struct recording_par *par)
{
	char *list = par->columns ? xstrdup(par->columns) : NULL, *rest = list;
	int renamed = 0;

	t->time = par->time ? find(t, par->time) : find(t, "time");
	if (t->time < 0 && !par->time)
		t->time = find(t, "t");
	if (par->time && t->time < 0)
		no_column(t, par->time);
	t->rate = t->time < 0 ? find(t, "rate") : -1;
	for (int i = 0; !list && i < t->cells; i++)
		if (i != t->time && i != t->rate)
			take(t, i, NULL);
	while (rest && *rest) {
		char *name = rest, *end = strchr(rest, ';'), *equals;
		int cell;

		rest = end ? end + 1 : NULL;
		if (end)
			*end = '\0';
		equals = par->table ? strchr(name, '=') : NULL;
		if (equals)
			*equals = '\0';
		cell = find(t, trimmed(equals ? equals + 1 : name, " \t\""));
		if (cell < 0)
			no_column(t, trimmed(equals ? equals + 1 : name, " \t\""));
		if (t->format.channels == t->cells)
			die(EXIT_USAGE, "--columns: the table has only %d", t->cells);
		renamed = equals != NULL;
		take(t, cell, equals ? trimmed(name, " \t\"") : NULL);
	}
	if (t->time >= 0 && t->format.channels == 1 && !renamed)
		strcpy(t->name_of[0], "y"); /* as in all series */
	free(list);
	if (!t->format.channels)
		die(EXIT_RUN, "%s: no column other than the times", t->name);
}

/* Scales to SI by the units of the headings; columns of unknown units are not changed. */
static void scale_units(struct text_in *t)
{
	char *units = xstrdup(""), **unit = t->unit;

	if (t->time >= 0 && unit[t->time]) {
		t->time_scale = unit_scale(unit[t->time], UNIT_TIME);
		if (t->time_scale <= 0)
			die(EXIT_RUN, "%s: times in '%s', want s, min, h or d", t->name,
				unit[t->time]);
	}
	for (int c = 0; c < t->format.channels; c++) {
		const char *name = unit[t->taken[c]];
		double volts = name ? unit_scale(name, UNIT_VOLTAGE) : 0;

		if (volts > 0)
			name = "V";
		t->scale[c] = volts > 0 ? volts : 1;
		units = xappend(units, "%s%s", c ? " " : "", name ? name : "1");
	}
	t->format.units = units;
}

/* Digits behind the decimal point, less the exponent. */
static double last_digit(const char *s)
{
	size_t whole = strcspn(s, ".,eE"), digits = 0;
	const char *exponent = strpbrk(s, "eE");

	if (s[whole] == '.' || s[whole] == ',')
		digits = strspn(s + whole + 1, "0123456789");
	return pow(10, (exponent ? strtod(exponent + 1, NULL) : 0) - (double)digits);
}

/* A date, counted from that of the first row, or a number in the unit of the heading. */
static double read_time(struct text_in *t, char *cell)
{
	struct moment m;
	double time = NAN, value, digit = 0;

	if ((t->absolute || (t->nahead == 0 && t->rows == 0)) && moment_parse(cell, &m)) {
		const char *fraction = strpbrk(cell, ".,");

		if (!t->absolute)
			t->start = m;
		t->absolute = 1;
		time = moment_between(&t->start, &m);
		digit = fraction ? last_digit(fraction) : 1;
	} else if (!t->absolute && number(t, cell, &value)) {
		time = value * t->time_scale;
		digit = last_digit(cell) * t->time_scale;
	}
	if (!isfinite(time))
		die(EXIT_RUN,
			"%s: line %ld: '%.40s' is not a time, want a number or a moment "
			"like 2026-11-22T03:04:05 or 2026-11-22",
			t->name, t->number, cell);
	digit = fmax(digit, 4e-16 * fabs(time));
	if (t->rows == 0 && (t->nahead == 0 || digit < t->resolution))
		t->resolution = digit;
	return time;
}

/* A column of the rate has the same number in every row. */
static void check_rate(struct text_in *t, char *cell)
{
	double rate;

	if (!number(t, cell, &rate) || !(rate > 0) || !isfinite(rate))
		die(EXIT_RUN, "%s: line %ld: '%.40s' is not a rate in hertz", t->name,
			t->number, cell);
	if (t->format.rate > 0 && rate != t->format.rate)
		die(EXIT_RUN, "%s: line %ld: rate %g after %g", t->name, t->number, rate,
			t->format.rate);
	t->format.rate = rate;
}

/* Cuts the next line into cells; 0 at the end. */
static int read_cells(struct text_in *t)
{
	char **cell = t->cell;
	int n;

	if (!next_line(t))
		return 0;
	n = cut(t, t->line, cell, t->cells + 1);
	if (n != t->cells && !(n == t->cells + 1 && !*cell[n - 1]))
		die(EXIT_RUN, "%s: line %ld: want %d cells, got %d", t->name, t->number,
			t->cells, n);
	return 1;
}

static double read_number(struct text_in *t, int c)
{
	char *cell = t->cell[t->taken[c]];
	struct moment m;
	double value;

	if (!number(t, cell, &value))
		die(EXIT_RUN, "%s: line %ld: %s: '%.40s' is not a number%s", t->name,
			t->number, t->heading[t->taken[c]], cell,
			moment_parse(cell, &m) ? ": specify --time" : "");
	return value;
}

/* Takes one row into time and channels; 0 at the end. */
static int read_row(struct text_in *t, double *row)
{
	if (!read_cells(t))
		return 0;
	row[0] = t->time < 0 ? NAN : read_time(t, t->cell[t->time]);
	if (t->rate >= 0)
		check_rate(t, t->cell[t->rate]);
	for (int c = 0; c < t->format.channels; c++)
		row[1 + c] = read_number(t, c) * t->scale[c];
	return 1;
}

/* Every time must be within half a step of that of the rate. */
static void check_time(struct text_in *t, double time)
{
	double want = t->first + (double)t->rows * t->step;

	if (t->time >= 0 && fabs(time - want) > 0.5 * t->step + t->rounding)
		die(EXIT_RUN,
			"%s: line %ld: time %.9g s, want %.9g s: samples are missing or "
			"the rate is not %.9g Hz: set it by --rate",
			t->name, t->number, time, want, t->format.rate);
	t->rows++;
}

/* Largest deviation of the times read ahead from those of a rate. */
static double deviation(const struct text_in *t, double rate)
{
	size_t width = (size_t)t->format.channels + 1;
	double most = 0;

	for (size_t i = 0; i < t->nahead; i++)
		most = fmax(
			most, fabs(t->ahead[i * width] - *t->ahead - (double)i / rate));
	return most;
}

static double rounded(double value, int digits)
{
	char text[NUMBER_TEXT];

	snprintf(text, sizeof text, "%.*e", digits - 1, value);
	return strtod(text, NULL);
}

/* The rate or step, in the unit of the times, of the fewest digits that they allow:
 * they are rounded to their last digit, and may besides jitter by a quarter of a step. */
static double simplest_rate(const struct text_in *t, double rate)
{
	double jitter = deviation(t, rate), most = t->resolution;
	double unit = fmax(t->time_scale, 1); /* of min, h and d */

	if (jitter > most + 0.25 / rate)
		die(EXIT_RUN,
			"%s: the times of the first %zu rows are not equally far apart: "
			"samples are missing, or specify --rate",
			t->name, t->nahead);
	if (jitter > most)
		most += jitter;
	for (int digits = 1; digits < 17; digits++) {
		double a = rounded(unit * rate, digits) / unit;
		double b = 1 / (unit * rounded(1 / (unit * rate), digits));
		double off_a = deviation(t, a), off_b = deviation(t, b);

		if (fmin(off_a, off_b) <= most)
			return off_b < off_a && off_b < 1e-3 * off_a ? b
			       : off_a <= most                       ? a
								     : b;
	}
	return rate;
}

/* The rate of the times read ahead; NAN if there are none. */
static double told_rate(const struct text_in *t)
{
	size_t width = (size_t)t->format.channels + 1;
	double span, rate;

	if (t->time < 0 || t->nahead < 2)
		return NAN;
	span = t->ahead[(t->nahead - 1) * width] - *t->ahead;
	if (!(span > 0))
		die(EXIT_RUN, "%s: the times are not ascending", t->name);
	rate = simplest_rate(t, (double)(t->nahead - 1) / span);
	if (t->resolution > 1e-3 * span && deviation(t, rate) > 1e-9 * span)
		warn("%s: the times determine the rate of %g Hz only to a relative %.1g: "
		     "set it by --rate",
			t->name, rate, t->resolution / span);
	return rate;
}

static void learn_rate(struct text_in *t, const struct recording_par *par)
{
	size_t width = (size_t)t->format.channels + 1;
	size_t most = isnan(par->rate) && t->time >= 0 ? AHEAD : 1;
	double rate = par->rate;

	t->ahead = xcalloc(AHEAD * width, sizeof *t->ahead);
	while (t->nahead < most && read_row(t, t->ahead + t->nahead * width))
		t->nahead++;
	t->first = t->nahead ? *t->ahead : 0;
	if (t->rate >= 0 && !isnan(rate) && rate != t->format.rate)
		die(EXIT_USAGE, "--rate %g: the recording states %g Hz", rate,
			t->format.rate);
	if (t->rate >= 0)
		rate = t->format.rate;
	if (isnan(rate))
		rate = told_rate(t);
	if (isnan(rate))
		die(EXIT_RUN, "%s: %s", t->name,
			t->time < 0
				? "no column 'time' or 't': specify --rate, or --time NAME"
				: "the time of one row tells no rate: specify --rate");
	if (!(rate >= RATE_LEAST && rate <= RATE_MOST))
		die(EXIT_RUN, "%s: %g samples per second, want %g to %g", t->name, rate,
			RATE_LEAST, RATE_MOST);
	t->format.rate = rate;
	t->step = 1 / rate;
	/* Times of whole steps are not rounded, however few digits they have. */
	t->rounding = t->resolution;
	if (t->nahead > 1 && deviation(t, rate) < 0.5 * t->step)
		t->rounding = fmin(t->rounding, deviation(t, rate));
	if (t->absolute) {
		char text[MOMENT_TEXT];

		t->format.start = xstrdup(moment_text(&t->start, text));
	}
}

/* A column may be called by its number, as in "time;1;2". */
static int is_ordinal(double v)
{
	return v == floor(v) && v >= 0 && v < 1000;
}

struct text_in *text_open(struct input *in, const struct recording_par *par)
{
	struct text_in *t = xcalloc(1, sizeof *t);
	char *copy;
	double v;
	int numbers = 1, values = 0;

	t->in = in;
	t->name = input_name(in);
	t->most = input_limit("line", LINE_MOST);
	for (long i = 0; i < par->skip; i++)
		if (!any_line(t))
			die(EXIT_RUN, "%s: ends within --skip-lines %ld", t->name,
				par->skip);
	if (!next_line(t))
		die(EXIT_RUN, "%s: no row", t->name);
	/* "Diameter [um]" alone is one column. */
	t->separator = has(t->line, "\t")   ? '\t'
		       : has(t->line, ";")  ? ';'
		       : has(t->line, ",")  ? ','
		       : has(t->line, " [") ? '\n'
		       : has(t->line, " (") ? '\n'
					    : ' ';
	t->commas = t->separator != ',';
	t->heading = xcalloc(strlen(t->line) + 2, sizeof *t->heading);
	copy = xstrdup(t->line);
	t->cells = cut(t, copy, t->heading, (int)strlen(t->line) + 1);
	t->cell = xcalloc((size_t)t->cells + 1, sizeof *t->cell);
	t->unit = xcalloc((size_t)t->cells + 1, sizeof *t->unit);
	t->name_of = xcalloc((size_t)t->cells + 1, sizeof *t->name_of);
	t->taken = xcalloc((size_t)t->cells + 1, sizeof *t->taken);
	t->scale = xcalloc((size_t)t->cells + 1, sizeof *t->scale);
	for (int i = 0; i < t->cells; i++) {
		char *cell = xstrdup(t->heading[i]);
		int is_number = number(t, cell, &v);

		numbers &= is_number;
		values |= is_number && !is_ordinal(v);
		free(cell);
	}
	if (numbers || values)
		die(EXIT_RUN, "%s: line %ld: want a line of headings, got '%.40s'",
			t->name, t->number, t->line);
	for (int i = 0; i < t->cells; i++)
		t->unit[i] = unit_of(t->heading[i]);
	choose(t, par);
	t->time_scale = 1;
	if (par->table)
		return t;
	scale_units(t);
	learn_rate(t, par);
	return t;
}

/* ---- as a table, without a rate ---- */

static const char *unit_word(char *unit)
{
	for (char *s = unit; s && *s; s++)
		if (strchr(" \t", *s))
			*s = '_';
	return unit ? unit : "1";
}

/* Two columns of one name could not be told apart. */
static void check_names(const struct text_in *t)
{
	for (int c = 0; c < t->format.channels; c++) {
		int same_as_time = t->time >= 0 && !strcmp(t->name_of[c], "t");

		for (int k = 0; k < c && !same_as_time; k++)
			if (!strcmp(t->name_of[c], t->name_of[k]))
				die(EXIT_RUN,
					"%s: two columns are called '%s': rename one "
					"with --columns 'NEW=NAME'",
					t->name, t->name_of[c]);
		if (same_as_time)
			die(EXIT_RUN,
				"%s: column '%s' would be called 't' as the times are: "
				"rename it with --columns 'NEW=NAME'",
				t->name, t->heading[t->taken[c]]);
	}
}

static struct table_out *create_table(struct text_in *t, const char *start)
{
	struct text columns = { 0 }, units = { 0 };
	char *cmd = opt_cmd(NULL, NULL), moment[MOMENT_TEXT];
	struct table_out *out;

	check_names(t);
	if (t->absolute && start)
		die(EXIT_USAGE, "--start %s: the times are moments", start);
	if (t->absolute)
		start = moment_text(&t->start, moment);
	if (t->time >= 0) {
		text_add(&columns, "t ");
		text_add(&units, "%s ", t->absolute ? "s" : unit_word(t->unit[t->time]));
	}
	for (int c = 0; c < t->format.channels; c++) {
		text_add(&columns, "%s%s", c ? " " : "", t->name_of[c]);
		text_add(&units, "%s%s", c ? " " : "", unit_word(t->unit[t->taken[c]]));
	}
	out = table_create(NULL, cmd, units.s, columns.s);
	if (start)
		table_comment(out, "start", "%s", start);
	free(columns.s);
	free(units.s);
	free(cmd);
	return out;
}

static int is_text(const char *name)
{
	return !strcmp(name, "unit") || !strcmp(name, "event");
}

double text_to_table(struct text_in *t, const char *start)
{
	struct table_out *out = NULL;

	while (read_cells(t)) {
		double time = t->time < 0 ? NAN : read_time(t, t->cell[t->time]);

		if (!out)
			out = create_table(t, start);
		if (t->time >= 0)
			table_put(out, time);
		for (int c = 0; c < t->format.channels; c++)
			if (is_text(t->name_of[c]))
				table_put_text(out, t->cell[t->taken[c]]);
			else
				table_put(out, read_number(t, c));
		table_end_row(out);
		t->rows++;
	}
	if (!out)
		die(EXIT_RUN, "%s: no row below the headings", t->name);
	table_done(out);
	return (double)t->rows;
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
	input_close(t->in);
	free(t->ahead);
	for (int c = 0; c < t->format.channels; c++)
		free(t->name_of[c]);
	free(t->name_of);
	free(t->unit);
	free(t->cell);
	free(t->taken);
	free(t->scale);
	free(t->heading);
	free(t->line);
	free(t);
}
