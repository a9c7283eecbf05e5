#include "cli/opt.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/program.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include <ctype.h>
#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

enum { ROWS_MAX = 128, LETTERLESS = 256 };

static int verbose_flag, follow;
static const char *stats_path;

static const struct opt heading[] = { OPT_HEADING("All programs"), OPT_END };

static const struct opt common[] = {
	{ 'S', "stats", OPT_TEXT, UNIT_NONE, &stats_path, 0, 0, "FILE",
		"write one row of work counters to FILE", 0, 1 },
	{ 'v', "verbose", OPT_FLAG, UNIT_NONE, &verbose_flag, 0, 0, 0,
		"report on standard error", 0, 1 },
	{ 'h', "help", OPT_FLAG, UNIT_NONE, 0, 0, 0, 0, "print this help and exit", 0,
		1 },
	{ 'V', "version", OPT_FLAG, UNIT_NONE, 0, 0, 0, 0, "print the version and exit",
		0, 1 },
	OPT_END,
};

static const struct opt reading[] = {
	{ 0, "follow", OPT_FLAG, UNIT_NONE, &follow, 0, 0, 0,
		"wait for the end of an input that is still being written", 0, 1 },
	OPT_END,
};

/* The command line that was parsed: what opt_cmd() and shell_done() need. */
static const struct prog *prog;
static char *recorded; /* " --word value ..." */
static char **operand; /* NULL-ended */
static const struct opt *rows[ROWS_MAX];
static const char *given[ROWS_MAX]; /* text, "" of a flag, or NULL */
static int nrows;

/* Shell quoting.  A blank after a colon is put outside of the quoted piece before
 * it, since ParaView's NRRD reader stumbles over ": ". */
static char *quote(const char *s)
{
	const char *safe =
		"abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
		"%+,-./:=@_";
	char *quoted = xcalloc(strlen(s) + 1, 5), *q = quoted;

	if (*s && strspn(s, safe) == strlen(s))
		return strcpy(quoted, s);
	*q++ = '\'';
	for (; *s; s++) {
		if (*s == '\'')
			q = strcpy(q, "'\\''") + 4;
		else if (*s == ':' && s[1] == ' ')
			q = strcpy(q, ":''") + 3;
		else
			*q++ = *s;
	}
	*q = '\'';
	return quoted;
}

static void append(char **text, const char *more)
{
	size_t old = *text ? strlen(*text) : 0;

	*text = xrealloc(*text, old + strlen(more) + 1, 1);
	strcpy(*text + old, more);
}

static void append_word(char **text, const char *word)
{
	char *q = quote(word);

	append(text, " ");
	append(text, q);
	free(q);
}

/* The separator of the members of a list; NUL if it has one member. */
static char separator_of(const struct opt *o)
{
	for (const char *p = ":x,"; *p; p++)
		if (strchr(o->arg, *p))
			return *p;
	return '\0';
}

/* The unit of the numbers; fractions are not in per cent. */
static const char *unit_shown(enum unit unit)
{
	return unit == UNIT_FRACTION ? "" : unit_name(unit);
}

/* An initial value outside the allowed range means that there is no default. */
static void print_default(const struct opt *o)
{
	char text[NUMBER_TEXT];
	double whole;

	switch (o->kind) {
	case OPT_INT:
		whole = (double)*(long *)o->var;
		if (whole >= o->min && whole <= o->max)
			printf(" (default %ld)", *(long *)o->var);
		break;
	case OPT_NUM:
		if (isfinite(*(double *)o->var))
			printf(" (default %s)",
				quantity_text(*(double *)o->var, o->unit, text));
		break;
	case OPT_WORD:
		printf(" (default %s)", o->words[*(int *)o->var]);
		break;
	case OPT_WORDS:
		for (int i = 0, n = 0; o->words[i]; i++)
			if (*(int *)o->var & 1 << i)
				printf("%s%s", n++ ? "," : " (default ", o->words[i]);
		if (*(int *)o->var)
			putchar(')');
		break;
	case OPT_TEXT:
		if (*(const char **)o->var)
			printf(" (default %s)", *(const char **)o->var);
		break;
	case OPT_CHOICE: {
		const struct opt_choice *c = o->var;

		if (c->word >= 0)
			printf(" (default %s)", o->words[c->word]);
		else if (!isnan(c->value))
			printf(" (default %s)", quantity_text(c->value, o->unit, text));
		break;
	}
	case OPT_LIST: {
		const struct opt_list *l = o->var;
		const char separator[2] = { separator_of(o) };

		for (int i = 0; i < l->n; i++)
			printf("%s%.*s%s", i ? "" : " (default ", i > 0, separator,
				quantity_text(l->v[i], o->unit, text));
		if (l->n)
			putchar(')');
		break;
	}
	case OPT_FLAG:
	case OPT_TEXTS:
	case OPT_ROWS:
	case OPT_GROUP:
		break;
	}
}

static void print_rows(void)
{
	for (int i = 0; i < nrows; i++) {
		const struct opt *o = rows[i];
		int column;

		if (o->kind == OPT_GROUP) {
			printf("\n%s:\n", o->word);
			continue;
		}
		column = o->letter ? printf("  -%c, --", o->letter) : printf("      --");
		column += printf(
			"%s%s%s", o->word, o->arg ? " " : "", o->arg ? o->arg : "");
		printf(column < 30 ? "%*s" : "\n%*s", column < 30 ? 32 - column : 32, "");
		printf("%s", o->help);
		if (o->var)
			print_default(o);
		putchar('\n');
	}
}

static _Noreturn void help(void)
{
	printf("usage: %s [option ...]%s%s\n%s\n", prog->name, *prog->operands ? " " : "",
		prog->operands, prog->gist);
	printf("reads: %s\nwrites: %s\n", prog->reads, prog->writes);
	if (nrows && rows[0]->kind != OPT_GROUP)
		putchar('\n');
	print_rows();
	exit(shell_done(EXIT_SUCCESS));
}

static void check_range(const struct opt *o, const char *text, double value)
{
	char least[NUMBER_TEXT], most[NUMBER_TEXT];

	if (value < o->min && o->max >= 1e15)
		die(EXIT_USAGE, "--%s %s: want at least %s", o->word, text,
			quantity_text(o->min, o->unit, least));
	if (value < o->min || value > o->max)
		die(EXIT_USAGE, "--%s %s: want %s to %s", o->word, text,
			quantity_text(o->min, o->unit, least),
			quantity_text(o->max, o->unit, most));
}

/* "1,5" */
static int has_decimal_comma(const char *text)
{
	const char *comma = strchr(text, ',');

	return comma && comma > text && isdigit((unsigned char)comma[-1]) &&
	       isdigit((unsigned char)comma[1]);
}

static double parse_number(const struct opt *o, const char *text)
{
	const char *end, *wrong;
	double value;

	wrong = unit_parse(text, o->unit, "", &value, &end);
	if (wrong && unit_meant(text, o->unit))
		die(EXIT_USAGE, "--%s %s: did you mean %s?", o->word, text,
			unit_meant(text, o->unit));
	if (wrong && has_decimal_comma(text))
		die(EXIT_USAGE, "--%s %s: write decimals with a point", o->word, text);
	if (wrong)
		die(EXIT_USAGE, "--%s %s: '%s' %s%s%s", o->word, text, text, wrong,
			*unit_shown(o->unit) ? ", want " : "", unit_shown(o->unit));
	check_range(o, text, value);
	return value;
}

const char *opt_reads(void)
{
	static const char otherwise[] = "nothing, or ";
	const char *reads = prog ? prog->reads : "another stream";

	return strncmp(reads, otherwise, strlen(otherwise)) ? reads
							    : reads + strlen(otherwise);
}

/* "mm" after "--length 1": a unit, not a file. */
static void check_operand(const char *text)
{
	char *one = xprintf("1%s", text);
	const char *end;
	double value;

	if (*text && unit_parse(one, UNIT_ANY, "", &value, &end) == NULL &&
		access(text, F_OK) != 0)
		die(EXIT_USAGE,
			"'%s' is taken for a file, which is not there; a unit stands "
			"behind its number without a blank",
			text);
	free(one);
}

/* An integer; in plain digits it may exceed the precision of a double. */
static long parse_whole(const struct opt *o, const char *text)
{
	const double exact = 9007199254740992; /* 2^53 */
	double value = parse_number(o, text);
	const char *digits = text + (*text == '+' || *text == '-');
	long long whole;

	if (fabs(value) < exact)
		return (long)value;
	errno = 0;
	whole = strtoll(text, NULL, 10);
	if (digits[strspn(digits, "0123456789")] || errno || whole > LONG_MAX ||
		whole < LONG_MIN)
		die(EXIT_USAGE, "--%s %s: write a number above 2^53 with all its digits",
			o->word, text);
	return (long)whole;
}

static int count(const char *text, const char *end, char c)
{
	int n = 0;

	for (; text < end; text++)
		n += *text == c;
	return n;
}

/* A list has the members shown in its placeholder; those in brackets are optional, and
 * "..." means any number. */
static void check_members(const struct opt *o, const char *text)
{
	const char *end = o->arg + strlen(o->arg), *optional = strchr(o->arg, '[');
	char c = separator_of(o);
	int n = count(text, text + strlen(text), c);

	if (strstr(o->arg, "..."))
		return;
	if (n > count(o->arg, end, c) || n < count(o->arg, optional ? optional : end, c))
		die(EXIT_USAGE, "--%s %s: want %s", o->word, text, o->arg);
}

static void parse_list(const struct opt *o, const char *text)
{
	struct opt_list *l = o->var;
	const char separator[2] = { separator_of(o) }, *s = text, *wrong;

	check_members(o, text);
	l->n = 0;
	for (;;) {
		if (l->n == OPT_LIST_MAX)
			die(EXIT_USAGE, "--%s %s: more than %d numbers", o->word, text,
				OPT_LIST_MAX);
		wrong = unit_parse(s, o->unit, separator, &l->v[l->n], &s);
		if (wrong && unit_meant(s, o->unit))
			die(EXIT_USAGE, "--%s %s: did you mean %s?", o->word, text,
				unit_meant(s, o->unit));
		if (wrong && *separator != ',' && has_decimal_comma(s))
			die(EXIT_USAGE, "--%s %s: write decimals with a point", o->word,
				text);
		if (wrong)
			die(EXIT_USAGE, "--%s %s: '%s' %s, want %s%s%s", o->word, text, s,
				wrong, o->arg, *unit_shown(o->unit) ? " in " : "",
				unit_shown(o->unit));
		check_range(o, text, l->v[l->n++]);
		if (!*s)
			break;
		s++;
	}
}

static int find_word(const struct opt *o, const char *text, size_t length)
{
	for (int i = 0; o->words[i]; i++)
		if (strlen(o->words[i]) == length &&
			strncmp(o->words[i], text, length) == 0)
			return i;
	return -1;
}

static int parse_word(const struct opt *o, const char *text, size_t length)
{
	int i = find_word(o, text, length);
	char *choices = NULL;

	if (i >= 0)
		return i;
	for (i = 0; o->words[i]; i++) {
		append(&choices, i ? "|" : "");
		append(&choices, o->words[i]);
	}
	die(EXIT_USAGE, "--%s %.*s: want %s", o->word, (int)length, text, choices);
}

static int parse_words(const struct opt *o, const char *text)
{
	int bits = 0;

	for (const char *s = text;; s++) {
		size_t length = strcspn(s, ",");

		bits |= 1 << parse_word(o, s, length);
		s += length;
		if (!*s)
			return bits;
	}
}

static void store(const struct opt *o, const char *text)
{
	for (const char *p = text; p && *p; p++)
		if (iscntrl((unsigned char)*p))
			die(EXIT_USAGE, "--%s: control character in the argument",
				o->word);
	switch (o->kind) {
	case OPT_FLAG:
		*(int *)o->var = 1;
		break;
	case OPT_INT:
		*(long *)o->var = parse_whole(o, text);
		break;
	case OPT_NUM:
		*(double *)o->var = parse_number(o, text);
		break;
	case OPT_LIST:
		parse_list(o, text);
		break;
	case OPT_TEXT:
		if (!*text)
			die(EXIT_USAGE, "--%s: empty argument, want %s", o->word, o->arg);
		*(const char **)o->var = text;
		break;
	case OPT_TEXTS: {
		struct opt_texts *t = o->var;

		if (t->n == OPT_TEXTS_MAX)
			die(EXIT_USAGE, "--%s: given more than %d times", o->word,
				OPT_TEXTS_MAX);
		t->v[t->n++] = text;
		break;
	}
	case OPT_WORD:
		*(int *)o->var = parse_word(o, text, strlen(text));
		break;
	case OPT_WORDS:
		*(int *)o->var = parse_words(o, text);
		break;
	case OPT_CHOICE: {
		struct opt_choice *c = o->var;

		c->word = find_word(o, text, strlen(text));
		if (c->word < 0 && isalpha((unsigned char)*text))
			die(EXIT_USAGE, "--%s %s: want %s", o->word, text, o->arg);
		if (c->word < 0)
			c->value = parse_number(o, text);
		break;
	}
	case OPT_ROWS:
	case OPT_GROUP:
		break;
	}
}

static void record(const struct opt *o, const char *text)
{
	if (o->unrecorded)
		return;
	append(&recorded, " --");
	append(&recorded, o->word);
	if (o->kind != OPT_FLAG)
		append_word(&recorded, text);
}

/* Takes in the rows of a table and of those it contains.  Two options with the same
 * letter or word, or too many rows, are a programming error. */
static void gather(const struct opt *table)
{
	for (const struct opt *o = table; o->word; o++) {
		if (o->kind == OPT_ROWS) {
			gather(o->var);
			continue;
		}
		if (nrows == ROWS_MAX)
			die(EXIT_RUN, "more than %d options in the table", ROWS_MAX);
		for (int i = 0; i < nrows && o->kind != OPT_GROUP; i++)
			if (rows[i]->kind != OPT_GROUP &&
				((o->letter && rows[i]->letter == o->letter) ||
					strcmp(rows[i]->word, o->word) == 0))
				die(EXIT_RUN, "--%s and --%s: one letter or word twice",
					rows[i]->word, o->word);
		rows[nrows++] = o;
	}
}

/* What getopt_long() returns for row i. */
static int code_of(int i)
{
	return rows[i]->letter ? rows[i]->letter : LETTERLESS + i;
}

static void getopt_tables(char *letters, struct option *words)
{
	*letters++ = ':';
	for (int i = 0; i < nrows; i++) {
		int takes = rows[i]->kind != OPT_FLAG;

		if (rows[i]->kind == OPT_GROUP)
			continue;
		if (rows[i]->letter) {
			*letters++ = (char)rows[i]->letter;
			if (takes)
				*letters++ = ':';
		}
		*words++ = (struct option){ rows[i]->word,
			takes ? required_argument : no_argument, NULL, code_of(i) };
	}
	*letters = '\0';
}

static int smaller(int a, int b)
{
	return a < b ? a : b;
}

/* Letters to insert, delete, change or exchange with the next to make b of a, at most
 * most + 1 of them. */
static int distance(const char *a, const char *b, int most)
{
	int least;

	while (*a && *a == *b) {
		a++;
		b++;
	}
	if (!*a && !*b)
		return 0;
	if (most == 0)
		return 1;
	least = 1 + (*a && *b ? distance(a + 1, b + 1, most - 1) : most);
	if (*a)
		least = smaller(least, 1 + distance(a + 1, b, most - 1));
	if (*b)
		least = smaller(least, 1 + distance(a, b + 1, most - 1));
	if (*a && *b && a[0] == b[1] && a[1] == b[0])
		least = smaller(least, 1 + distance(a + 2, b + 2, most - 1));
	return least;
}

/* The word of the option that is most like "--word" or "--word=value", if one of them is
 * by two letters or less. */
static const char *likely_option(const char *text)
{
	char word[32] = "";
	const char *likely = NULL;
	int best = 3;

	if (strncmp(text, "--", 2) == 0)
		snprintf(
			word, sizeof word, "%.*s", (int)strcspn(text + 2, "="), text + 2);
	for (int i = 0; strlen(word) > 3 && i < nrows; i++) {
		int d = rows[i]->kind == OPT_GROUP ? best
						   : distance(word, rows[i]->word, 2);

		if (d < best) {
			best = d;
			likely = rows[i]->word;
		}
	}
	return likely;
}

static _Noreturn void misuse(int problem, char **argv)
{
	char *shown = optopt >= LETTERLESS
			      ? xprintf("--%s", rows[optopt - LETTERLESS]->word)
		      : optopt && !strncmp(argv[optind - 1], "--", 2)
			      ? xstrdup(argv[optind - 1])
		      : optopt ? xprintf("-%c", optopt)
			       : xstrdup(argv[optind - 1]);

	const char *likely;

	if (problem == ':')
		die(EXIT_USAGE, "%s: needs an argument; see %s --help", shown,
			prog->name);
	likely = likely_option(shown);
	if (likely)
		die(EXIT_USAGE, "%s: no such option: did you mean --%s?", shown, likely);
	die(EXIT_USAGE, "%s: no such option; see %s --help", shown, prog->name);
}

static void check_operands(int argc, char **argv)
{
	int most = strstr(prog->operands, "...") ? argc : *prog->operands != '\0';

	for (int i = optind; i < argc; i++)
		check_operand(argv[i]);
	if (argc - optind > most)
		die(EXIT_USAGE, "%s: %s", argv[optind + most],
			most ? "one file at most" : "takes no file");
	/* Called without arguments on a terminal: print a hint instead of waiting for
	 * input. */
	if (argc == 1 && *prog->operands && strncmp(prog->reads, "nothing", 7) != 0 &&
		isatty(STDIN_FILENO))
		die(EXIT_USAGE,
			"nothing to read: usage: %s [option ...] %s; see %s --help",
			prog->name, prog->operands, prog->name);
}

/* A stack that is too small would overflow. */
static void check_stack(void)
{
	enum { WANT = 256 }; /* kB; the deepest calls take about 100 */
	struct rlimit limit;

	if (getrlimit(RLIMIT_STACK, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
		limit.rlim_cur < 1024 * WANT)
		die(EXIT_RUN, "the stack may have %lu kB, want %d: see ulimit -s",
			(unsigned long)(limit.rlim_cur / 1024), WANT);
}

int opt_parse(const struct prog *program, int argc, char **argv)
{
	struct option words[ROWS_MAX + 1] = { { 0 } };
	char letters[2 * ROWS_MAX + 2];
	int c;

	files_start();
	prog = program;
	program_set_name(program->name);
	progress_begin();
	check_stack();
	stats_start();
	gather(program->opts);
	gather(heading);
	if (strcmp(program->reads, "nothing") != 0)
		gather(reading);
	gather(common);
	getopt_tables(letters, words);
	opterr = 0;
	while ((c = getopt_long(argc, argv, letters, words, NULL)) != -1) {
		if (c == 'h')
			help();
		if (c == 'V') {
			printf("%s (wearpipe) %s\n", program->name, WEARPIPE_VERSION);
			exit(shell_done(EXIT_SUCCESS));
		}
		if (c == '?' || c == ':')
			misuse(c, argv);
		for (int i = 0; i < nrows; i++) {
			if (rows[i]->kind == OPT_GROUP || code_of(i) != c)
				continue;
			store(rows[i], optarg);
			record(rows[i], optarg);
			given[i] = optarg ? optarg : "";
		}
	}
	verbose = verbose_flag;
	if (follow)
		file_follow();
	check_operands(argc, argv);
	file_claim_output();
	if (stats_path)
		stats_open(stats_path);
	operand = argv + optind;
	return optind;
}

int opt_given(const char *word)
{
	for (int i = 0; i < nrows; i++)
		if (given[i] && strcmp(rows[i]->word, word) == 0)
			return 1;
	return 0;
}

int opt_given_bare(const char *word)
{
	for (int i = 0; i < nrows; i++)
		if (given[i] && *given[i] && strcmp(rows[i]->word, word) == 0)
			return !given[i][strspn(given[i], "0123456789+-.eE,:x")];
	return 0;
}

void opt_require(const char *other, const char *words)
{
	if (opt_given(other))
		return;
	for (const char *w = words; *w; w += strcspn(w, " "), w += *w == ' ') {
		char *word = xprintf("%.*s", (int)strcspn(w, " "), w);

		if (opt_given(word))
			die(EXIT_USAGE, "--%s requires --%s", word, other);
		free(word);
	}
}

const char *opt_any_given(const struct opt *table)
{
	const char *word = NULL;

	for (const struct opt *o = table; o->word && !word; o++)
		if (o->kind == OPT_ROWS)
			word = opt_any_given(o->var);
		else if (o->kind != OPT_GROUP && opt_given(o->word))
			word = o->word;
	return word;
}

char *opt_cmd(const char *upstream, const char *extra)
{
	char *cmd = NULL;

	if (upstream) {
		append(&cmd, upstream);
		append(&cmd, " | ");
	}
	append(&cmd, prog->name);
	append(&cmd, recorded ? recorded : "");
	if (extra) {
		append(&cmd, " ");
		append(&cmd, extra);
	}
	for (char **p = operand; !upstream && *p; p++)
		if (strcmp(*p, "-") != 0)
			append_word(&cmd, *p);
	return cmd;
}

char *opt_cmd_side(const char *upstream, const char *option)
{
	char *extra = xprintf("--%s /dev/fd/3 3>&1 >/dev/null", option);
	char *cmd = opt_cmd(upstream, extra);

	free(extra);
	return cmd;
}

int shell_done(int status)
{
	errno = 0;
	/* Some file systems report a failure only when a descriptor is closed; standard
	 * output itself stays open, for messages flush it. */
	if (ferror(stdout) || fflush(stdout) || close(dup(STDOUT_FILENO)))
		die(EXIT_RUN,
			errno ? "standard output:" : "standard output: write error");
	progress_clear();
	stats_write(prog->name);
	return status;
}
