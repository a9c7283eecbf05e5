#include "cli/msg.h"
#include "cli/unit.h"
#include "formats_in.h"
#include "io/reasons.h"
#include "points.h"
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* UTF-16, as spreadsheets write it, to bytes: a character beyond Latin-1 becomes '?'. */
static char *plain(const struct content *c)
{
	const unsigned char *b = (const unsigned char *)c->data;
	int big = c->size >= 2 && b[0] == 0xfe && b[1] == 0xff;
	int little = c->size >= 2 && b[0] == 0xff && b[1] == 0xfe;
	char *text = xcalloc(c->size + 1, 1);
	size_t n = 0;

	if (!big && !little) {
		size_t mark = c->size >= 3 && memcmp(b, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;

		memcpy(text, c->data + mark, c->size - mark);
		if (strlen(text) != c->size - mark)
			die(EXIT_RUN,
				"%s: NUL byte: neither text nor a format that is "
				"known; --format raw reads samples",
				c->name);
		return text;
	}
	for (size_t i = 2; i + 1 < c->size; i += 2) {
		unsigned high = b[i + (big ? 0 : 1)], low = b[i + (big ? 1 : 0)];

		text[n++] = high ? '?' : (char)low;
	}
	return text;
}

/* What cells between commas tell: whether each second one is the decimals of the one
 * before. */
struct pairs {
	int other; /* a cell is no whole number, or a second one has a sign */
	long minus, minus_zero; /* first cells with a sign, and of these -0 */
	long padded[2];         /* first and second cells such as 05 */
};

struct text {
	const struct content *c;
	char separator; /* ' ' for blanks */
	int comma;      /* decimal */
	double *value;
	size_t n, room;
	int columns;
	long rows, line;
	long empty;   /* the last empty line since the last row, 0: none */
	long inner;   /* the first one between rows */
	long gaps;    /* rows below empty lines */
	char *header; /* the last line that is not a row of numbers */
	long header_line;
	struct pairs pairs;
	struct reasons doubts; /* of the comments "# doubtful:" */
	double width, height;  /* of the surface, m, and the unit of heights, m, of the */
	double unit;           /* comments that Gwyddion writes; NAN if there are none */
	/* What the headings of an Arc/Info grid state, else NAN. */
	double missing, nx, ny;
};

/* The separator of cells: a semicolon or TAB, if there is one; a comma unless blanks
 * separate numbers with decimal commas. */
static void find_separator(struct text *t, const char *sample)
{
	const char *comma = strchr(sample, ',');

	t->separator = strchr(sample, ';')    ? ';'
		       : strchr(sample, '\t') ? '\t'
		       : comma                ? ','
					      : ' ';
	t->comma = (t->separator == ';' || t->separator == '\t') && comma;
	/* 1,25 2,50: a blank separates what would otherwise be a cell of two numbers */
	if (t->separator == ',' && !strchr(sample, '.')) {
		const char *s = sample;
		int inner = 0, spaced = 0;

		for (; *s; s++) {
			inner += *s == ',' && s > sample &&
				 isdigit((unsigned char)s[-1]) &&
				 isdigit((unsigned char)s[1]);
			spaced += *s == ' ' && isdigit((unsigned char)s[1]) &&
				  s > sample && isdigit((unsigned char)s[-1]);
		}
		if (inner && spaced) {
			t->separator = ' ';
			t->comma = 1;
		}
	}
}

int is_gap(const char *s)
{
	static const char *const words[] = { "", "nan", "NaN", "NAN", "NA", "BAD", "bad",
		"***", "---", "-", "null", NULL };

	for (int i = 0; words[i]; i++)
		if (strcmp(s, words[i]) == 0)
			return 1;
	return 0;
}

/* Reads one cell; 0 if it is not a number. */
static int cell(const struct text *t, char *s, double *v)
{
	char *end = s + strlen(s);

	while (end > s && isspace((unsigned char)end[-1]))
		*--end = '\0';
	s += strspn(s, " \t\"");
	if (end > s && end[-1] == '"')
		*--end = '\0';
	if (is_gap(s)) {
		*v = NAN;
		return 1;
	}
	/* among decimal commas a point separates thousands */
	if (t->comma && strchr(s, '.'))
		return 0;
	if (t->comma && strchr(s, ','))
		*strchr(s, ',') = '.';
	*v = sample_parse(s, &end);
	return end != s && !*end;
}

static void look_at(struct pairs *p, const char *s, int second)
{
	int minus = *s == '-';

	if (is_gap(s))
		return;
	s += minus;
	p->other |= s[strspn(s, "0123456789")] != '\0' || (minus && second);
	p->minus += minus;
	p->minus_zero += minus && strcmp(s, "0") == 0;
	p->padded[second] += *s == '0' && isdigit((unsigned char)s[1]);
}

/* No height is written 05, or 000.5 behind thousands, and hardly -0; of twenty negative
 * ones in four columns none is in the second or fourth by a chance of 1e-6. */
static int are_decimals(const struct text *t)
{
	const struct pairs *p = &t->pairs;

	return t->separator == ',' && t->columns % 2 == 0 &&
	       ((p->padded[1] && !p->padded[0]) ||
		       (!p->other &&
			       (p->minus_zero || (t->columns >= 4 && p->minus >= 20))));
}

static void keep(struct text *t, double v)
{
	if (t->n == t->room) {
		t->room = t->room ? 2 * t->room : 1024;
		t->value = xrealloc(t->value, t->room, sizeof *t->value);
	}
	t->value[t->n++] = v;
}

/* Reads a row; returns the number of cells, -1 if one is not a number. */
static int read_row(struct text *t, char *line)
{
	size_t before = t->n;
	int n = 0;

	for (char *s = line; s;) {
		char *next = NULL;
		double v;

		if (t->separator == ' ') {
			s += strspn(s, " ");
			if (!*s)
				break;
			next = strchr(s, ' ');
		} else {
			next = strchr(s, t->separator);
		}
		if (next)
			*next++ = '\0';
		/* a separator at the end of a whole row separates nothing */
		if (!next && !*s && n > 0 && (!t->rows || n == t->columns))
			break;
		if (!cell(t, s, &v)) {
			t->n = before;
			return -1;
		}
		look_at(&t->pairs, s, n % 2);
		keep(t, v == t->missing ? NAN : v);
		n++;
		s = next;
	}
	return n;
}

static _Noreturn void no_row(const struct text *t, long line, const char *content)
{
	die(EXIT_RUN, "%s: line %ld: not a row of numbers: %.40s", t->c->name, line,
		content);
}

/* A line that has as many cells as the first row, of which half or more begin like
 * numbers, is no heading, whatever follows them. */
static int is_torn_row(const struct text *t, const char *line)
{
	const char by[2] = { t->separator, '\0' };
	int n = 0, numbers = 0;

	for (const char *s = line; *s && n < t->columns;
		s += strcspn(s, by), s += *s != '\0') {
		s += strspn(s, " \"");
		if (!*s)
			break;
		n++;
		numbers += isdigit((unsigned char)s[strspn(s, "+-.")]) != 0;
	}
	return n == t->columns && 2 * numbers >= n;
}

/* What follows a name; NULL if the text does not begin with it. */
static const char *behind(const char *s, const char *name)
{
	size_t n = strlen(name);

	return strncmp(s, name, n) == 0 ? s + n + strspn(s + n, " \t") : NULL;
}

/* A length such as "5.00 um"; NAN if it is none. */
static double length_of(const char *s)
{
	char *unit;
	double v = decimal_parse(s, &unit);

	unit += strspn(unit, " ");
	return v * unit_named(unit, strlen(unit));
}

/* Lines such as "NODATA_value  -9999", the headings of an Arc/Info grid. */
static void read_heading(struct text *t, const char *s)
{
	const struct {
		const char *name;
		double *value;
	} known[] = { { "nodata_value", &t->missing }, { "ncols", &t->nx },
		{ "nrows", &t->ny } };

	for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
		size_t n = strlen(known[i].name);
		char *end;
		double v;

		if (strncasecmp(s, known[i].name, n) != 0)
			continue;
		v = decimal_parse(s + n + strspn(s + n, " \t"), &end);
		if (!end[strspn(end, " \t")])
			*known[i].value = v;
	}
}

static void read_comment(struct text *t, const char *s)
{
	const char *value;

	s += strspn(s, " \t");
	if ((value = behind(s, "doubtful:")) && *value)
		reasons_add(&t->doubts, value);
	else if ((value = behind(s, "Width:")))
		t->width = length_of(value);
	else if ((value = behind(s, "Height:")))
		t->height = length_of(value);
	else if ((value = behind(s, "Value units:"))) {
		t->unit = unit_named(value, strlen(value));
		if (isnan(t->unit))
			die(EXIT_RUN, "%s: line %ld: '%.20s' is not a unit of length",
				t->c->name, t->line, value);
	}
}

static void read_rows(struct text *t, char *text)
{
	char *rest = text;
	long missing = 0; /* rows before the first number */

	while (rest && *rest) {
		char *line = rest, *end = strpbrk(line, "\r\n"), *copy;
		int n;

		rest = end ? end + 1 + (*end == '\r' && end[1] == '\n') : NULL;
		if (end)
			*end = '\0';
		t->line++;
		if (!end)
			warn("%s: line %ld: no newline at the end: the last row may be truncated",
				t->c->name, t->line);
		if (*line == '#') {
			read_comment(t, line + 1);
			continue;
		}
		/* Empty cells alone are a row of missing samples, below a heading none.
		 */
		if (!line[strspn(line, " \t;,")] &&
			(!t->rows || t->separator == ' ' ||
				!strchr(line, t->separator))) {
			missing += !t->rows && !t->header && strpbrk(line, ";,\t");
			t->empty = t->rows ? t->line : t->empty;
			continue;
		}
		if (!t->rows)
			find_separator(t, line);
		copy = xstrdup(line);
		n = read_row(t, line);
		if (n < 0 && t->rows)
			no_row(t, t->line, copy);
		if (n < 0) {
			free(t->header);
			t->header = copy;
			t->header_line = t->line;
			read_heading(t, copy);
			continue;
		}
		free(copy);
		if (t->rows && n != t->columns)
			die(EXIT_RUN, "%s: line %ld: want %d heights, got %d", t->c->name,
				t->line, t->columns, n);
		t->columns = n;
		t->inner = t->inner ? t->inner : t->empty;
		t->gaps += t->empty > 0;
		t->empty = 0;
		for (; missing > 0; missing--, t->rows++)
			for (int i = 0; i < n; i++) {
				keep(t, t->value[t->n - (size_t)n]);
				t->value[t->n - 1 - (size_t)n] = NAN;
			}
		if (t->rows++ == 0 && t->header && is_torn_row(t, t->header))
			no_row(t, t->header_line, t->header);
	}
}

/* The separator that makes as many cells of the heading as there are columns, which need
 * not be that of the rows; '\0' if none does. */
static char heading_separator(const struct text *t)
{
	for (const char *by = (char[]){ t->separator, ';', '\t', ',', '\0' }; *by; by++) {
		int n = 1;

		for (const char *s = t->header; s && *s; s++)
			n += *s == *by;
		if (n == t->columns)
			return *by;
	}
	return '\0';
}

/* The unit in the heading of a column from its end: "(microns)", "[um]", "in um", "x/mm".
 * A heading without cells may state a single unit, of all columns. */
static double unit_of(const struct text *t, int from_end)
{
	char *copy, *part, *s, *end, by = heading_separator(t);
	double unit = NAN;
	int mixed = 0;

	if (!t->header)
		return from_end ? NAN : t->unit;
	part = copy = xstrdup(t->header);
	for (int k = t->columns - 1 - from_end; by && k > 0; k--)
		part = strchr(part, by) + 1;
	if (by && strchr(part, by))
		*strchr(part, by) = '\0';
	/* the last word that is a unit */
	for (s = part; *s; s = end) {
		static const char between[] = " \t,;()[]/_\"";
		double u;

		s += strspn(s, between);
		end = s + strcspn(s, between);
		u = unit_named(s, (size_t)(end - s));
		mixed |= !by && u != unit && !isnan(u) && !isnan(unit);
		if (!isnan(u))
			unit = u;
		if (*end)
			end++;
	}
	free(copy);
	return mixed ? NAN : unit;
}

/* Positions must be equally spaced: to a thousandth of a step, or to their rounding.
 */
static void profile_read(const struct text *t, const struct told *told, struct record *r)
{
	double dx, dy, unit, x_unit, *z;
	size_t n = (size_t)t->rows, w = (size_t)t->columns, first;
	const double *x = t->value + w - 2;

	if (t->columns < 2 || t->rows < 2)
		die(EXIT_RUN,
			"%s: %d columns of %ld rows, want two: positions and heights",
			t->c->name, t->columns, t->rows);
	x_unit = unit_of(t, 1);
	unit = settle_unit(t->c, told, unit_of(t, 0));
	dx = (x[(n - 1) * w] - x[0]) / (double)(n - 1);
	/* Positions may be rounded to a 25th of the spacing. */
	for (size_t i = 0; i < n; i++)
		if (!(fabs(x[i * w] - x[0] - (double)i * dx) <= 0.02 * fabs(dx)))
			die(EXIT_RUN,
				"%s: row %zu: position %g, want %g: positions must be equally spaced",
				t->c->name, i + 1, x[i * w], x[0] + (double)i * dx);
	first = dx < 0 ? n - 1 : 0; /* from the lowest position on */
	dx = fabs(dx) * x_unit;     /* nan if no heading states the unit */
	dy = dx;
	settle_pixel(t->c, told, &dx, &dy);
	z = new_heights(t->c, (double)n, 1, dx, dx, r);
	for (size_t i = 0; i < n; i++) {
		double height = x[(first ? first - i : i) * w + 1];

		z[i] = height == told->missing ? NAN : height * unit;
	}
}

/* 1 if no number of the column is less, or none is more, than the one above, and not all
 * are the same. */
static int is_sorted(const struct text *t, int column)
{
	const double *x = t->value + column;
	long up = 0, down = 0;

	for (long i = 1; i < t->rows; i++) {
		double step = x[i * t->columns] - x[(i - 1) * t->columns];

		up += step > 0;
		down += step < 0;
		if (isnan(step))
			return 0;
	}
	return (up > 0) != (down > 0);
}

/* Rows from which on a sorted column holds positions: eight random heights are sorted by
 * a chance of 2 / 8!. */
enum { SORTED_ROWS = 8 };

/* 1 if n > 2 numbers are equally spaced, as positions are, and not all the same. */
static int is_ramp(const double *x, long n, long stride)
{
	double step = (x[(n - 1) * stride] - x[0]) / (double)(n - 1);

	for (long i = 0; i < n; i++)
		if (!(fabs(x[i * stride] - x[0] - (double)i * step) <= 0.02 * fabs(step)))
			return 0;
	return n > 2 && step != 0;
}

/* 1 if two columns may be a profile: the first is sorted, or equally spaced and the
 * second is not, which few heights are seldom by chance. */
static int is_profile(const struct text *t)
{
	if (t->columns != 2)
		return 0;
	return (t->rows >= SORTED_ROWS && is_sorted(t, 0)) ||
	       (is_ramp(t->value, t->rows, 2) && !is_ramp(t->value + 1, t->rows, 2));
}

/* Positions and heights are no matrix of heights. */
static void refuse_points(const struct text *t)
{
	if (is_profile(t))
		die(EXIT_RUN,
			"%s: two columns, positions and heights, are not a matrix: --profile "
			"reads them",
			t->c->name);
	if (t->columns == 2 && t->rows == 2)
		warn("%s: two rows of two columns are read as heights: --profile reads "
		     "positions and heights",
			t->c->name);
	if (t->columns == 3 && t->rows >= SORTED_ROWS &&
		(is_sorted(t, 0) || is_sorted(t, 1)))
		die(EXIT_RUN,
			"%s: three columns look like points x, y, z that fill no grid: want a "
			"matrix of heights, or --profile for the last two",
			t->c->name);
	if (t->columns == 3 && t->rows >= SORTED_ROWS)
		warn("%s: three columns are read as heights: points x, y, z would be those of a "
		     "grid",
			t->c->name);
}

/* 1 if the heading names columns x and y; column: these, and the third one. */
static int named_points(const struct text *t, int column[3])
{
	const char by[2] = { heading_separator(t), '\0' };
	const char *s = t->header && *by ? t->header : "";

	column[0] = column[1] = -1;
	for (int k = 0; *s; k++, s += *s != '\0') {
		int name;

		s += strspn(s, " \"");
		name = tolower((unsigned char)*s) - 'x';
		if ((name == 0 || name == 1) && !isalnum((unsigned char)s[1]))
			column[name] = k;
		s += strcspn(s, by);
	}
	column[2] = 3 - column[0] - column[1];
	return column[0] >= 0 && column[1] >= 0;
}

/* Puts the columns in the order x, y, z. */
static void sort_columns(struct text *t, const int column[3])
{
	for (double *row = t->value; row < t->value + t->n; row += 3) {
		double in_order[3];

		for (int k = 0; k < 3; k++)
			in_order[k] = row[column[k]];
		memcpy(row, in_order, sizeof in_order);
	}
}

/* Points x, y, z of a grid, in any order; 0 if the rows are none. */
static int points_read(struct text *t, const struct told *told, struct record *r)
{
	int column[3], named = named_points(t, column) &&
			       (t->columns > 3 || (column[0] < 3 && column[1] < 3));
	struct grid g;
	enum points found;
	double dx, dy, unit, *z;
	size_t n = (size_t)t->rows;

	if (t->columns < 3)
		return 0;
	if (t->columns == 3 && named)
		sort_columns(t, column);
	else
		column[0] = 0, column[1] = 1, column[2] = 2;
	found = points_find(t->value, n, (size_t)t->columns, &g);
	if (found == POINTS_FEW && t->columns > 3 && !named) {
		free(g.at);
		return 0;
	}
	if (found == POINTS_NONE && !named)
		return 0;
	if (t->columns > 3)
		die(EXIT_RUN,
			"%s: %d columns look like points x, y, z and more: want these three, "
			"or a matrix of heights",
			t->c->name, t->columns);
	if (found == POINTS_NONE)
		die(EXIT_RUN,
			"%s: points x, y, z that fill no grid: want each point of a grid once",
			t->c->name);
	if (found == POINTS_PART)
		die(EXIT_RUN,
			"%s: %zu points x, y, z of a grid of %zu x %zu: want all of them",
			t->c->name, n, g.nx, g.ny);
	if (found == POINTS_FEW && !named)
		die(EXIT_RUN,
			"%s: three columns look like points x, y, z: want a heading of these "
			"names, or a matrix of heights",
			t->c->name);
	dx = g.dx * unit_of(t, 2 - column[0]);
	dy = g.dy * unit_of(t, 2 - column[1]);
	if (isnan(dx) && fabs(told->dx * g.dy - told->dy * g.dx) > 1e-3 * told->dy * g.dx)
		die(EXIT_RUN,
			"%s: points are %g and %g apart, which no unit makes --pixel %g x %g m",
			t->c->name, g.dx, g.dy, told->dx, told->dy);
	settle_pixel(t->c, told, &dx, &dy);
	unit = settle_unit(t->c, told, unit_of(t, 2 - column[2]));
	z = new_heights(t->c, (double)g.nx, (double)g.ny, dx, dy, r);
	for (size_t i = 0; i < n; i++) {
		double height = t->value[3 * i + 2];

		z[g.at[i]] = height == told->missing ? NAN : height * unit;
	}
	free(g.at);
	return 1;
}

/* 1 if the first of the lines of n samples is equally spaced and the second one is not.
 * The corner, which may hold anything, is left out. */
static int is_edge(const double *z, long n, long along, long across)
{
	return n > 4 && is_ramp(z + along, n - 1, along) &&
	       !is_ramp(z + along + across, n - 1, along);
}

/* Positions above or beside the heights.  Few heights may be equally spaced by chance: up
 * to eight of them are positions only if those of the other edge are. */
static void refuse_positions(const struct text *t)
{
	int above, beside;

	if (t->rows < 2 || t->columns < 2)
		return;
	above = is_edge(t->value, t->columns, 1, t->columns);
	beside = is_edge(t->value, t->rows, t->columns, 1);
	if ((above && beside) || (above && t->columns > 8) || (beside && t->rows > 8))
		die(EXIT_RUN,
			"%s: the first %s equally spaced: want heights alone, without "
			"positions",
			t->c->name,
			above && beside ? "row and column are"
			: above         ? "row is"
					: "column is");
}

void text_read(const struct content *c, const struct told *told, struct record *r)
{
	struct text t = { .c = c,
		.separator = ' ',
		.width = NAN,
		.height = NAN,
		.unit = NAN,
		.missing = NAN,
		.nx = NAN,
		.ny = NAN };
	char *text = plain(c);
	double dx, dy, unit, *z;

	read_rows(&t, text);
	if (!t.rows)
		die(EXIT_RUN, "%s: no row of numbers", c->name);
	if (are_decimals(&t))
		die(EXIT_RUN,
			"%s: commas separate decimals or thousands, and heights as well: want "
			"semicolons, TABs or blanks between the heights",
			c->name);
	if (told->profile) {
		profile_read(&t, told, r);
	} else if (!points_read(&t, told, r)) {
		/* all rows may be two lines apart */
		if (t.gaps > 0 && t.gaps < t.rows - 1)
			die(EXIT_RUN,
				"%s: line %ld: an empty line between rows: want a single matrix",
				c->name, t.inner);
		t.nx = isnan(t.nx) ? t.columns : t.nx;
		t.ny = isnan(t.ny) ? (double)t.rows : t.ny;
		if (t.nx != t.columns || t.ny != (double)t.rows)
			die(EXIT_RUN,
				"%s: want %g x %g heights, as ncols and nrows state, got %d x %ld",
				c->name, t.nx, t.ny, t.columns, t.rows);
		refuse_points(&t);
		refuse_positions(&t);
		dx = isnan(t.height) ? NAN : t.width / t.columns;
		dy = t.height / (double)t.rows;
		settle_pixel(c, told, &dx, &dy);
		unit = settle_unit(c, told, t.unit);
		/* --pixel confirms it.  Rounded lengths have three digits. */
		if (isnan(told->dx) && fabs(dx / dy - 1) > 0.01)
			warn("%s: heights are %g m apart along x and %g m along y: are all rows there?",
				c->name, dx, dy);
		z = new_heights(c, t.columns, (double)t.rows, dx, dy, r);
		for (size_t i = 0; i < t.n; i++)
			z[i] = t.value[i] == told->missing ? NAN : t.value[i] * unit;
	}
	if (reasons_text(&t.doubts))
		record_set(r, "doubtful", "%s", reasons_text(&t.doubts));
	reasons_free(&t.doubts);
	free(t.value);
	free(t.header);
	free(text);
}
