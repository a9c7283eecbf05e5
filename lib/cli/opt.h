/* opt.h - one table of options per program
 *
 * The table drives parsing (getopt_long), units and ranges, --help with defaults,
 * the check of the man page, shell completion and the recorded command line.
 * Defaults are the initial values of the variables the rows point at.
 *
 *	static struct opt_list band = { 2, { 70, 130 } };
 *	static long order = 200;
 *	static const struct opt opts[] = {
 *		{ 'b', "band", OPT_LIST, UNIT_FREQUENCY, &band, 0, 1e12, "LO:HI",
 *			"pass band" },
 *		{ 0, "order", OPT_INT, UNIT_COUNT, &order, 2, 1e6, "N", "taps" },
 *		OPT_END,
 *	};
 *
 * Every program also has -h --help, -V --version, -v --verbose, -S --stats FILE and,
 * unless it reads nothing, --follow.
 * A number that was not given stays at its initial value; use NAN for "not given".
 */
#ifndef CLI_OPT_H
#define CLI_OPT_H

#include "cli/unit.h"

enum opt_kind {
	OPT_FLAG,   /* int: set to 1 */
	OPT_INT,    /* long; unit UNIT_COUNT */
	OPT_NUM,    /* double */
	OPT_LIST,   /* struct opt_list: as many numbers as arg shows, separated by one of
		     * ':' 'x' ','; "A:B" two, "A[:B]" one or two, "A,A,..." any */
	OPT_TEXT,   /* const char *: a file or free text */
	OPT_TEXTS,  /* struct opt_texts: may be repeated */
	OPT_WORD,   /* int: index into words */
	OPT_WORDS,  /* int: words separated by commas, bit k for words[k] */
	OPT_CHOICE, /* struct opt_choice: one of words, or a number */
	OPT_ROWS,   /* struct opt []: a further table in this place; letter 0, word "" */
	OPT_GROUP   /* no option: word is a heading of --help for the rows that follow */
};

enum { OPT_LIST_MAX = 64, OPT_TEXTS_MAX = 64 };

struct opt_list {
	int n; /* values present */
	double v[OPT_LIST_MAX];
};

struct opt_texts {
	int n;
	const char *v[OPT_TEXTS_MAX];
};

struct opt_choice {
	int word; /* index into words, or -1: see value */
	double value;
};

struct opt {
	int letter; /* 0: none.  A letter means one word in the whole suite. */
	const char *word;
	enum opt_kind kind;
	enum unit unit;
	void *var;
	double min, max;          /* inclusive range of numbers, or of each list member */
	const char *arg;          /* placeholder: "N[xM]", "FILE", "gauss|exp" */
	const char *help;         /* a phrase without a full stop */
	const char *const *words; /* OPT_WORD, OPT_WORDS, OPT_CHOICE: NULL-ended */
	int unrecorded;           /* 1: cannot change the output, keep out of cmd */
};

#define OPT_END                                                \
	{                                                      \
		0, 0, OPT_FLAG, UNIT_NONE, 0, 0, 0, 0, 0, 0, 0 \
	}
/* The rows of a table that several programs share. */
#define OPT_TABLE(rows)                                            \
	{                                                          \
		0, "", OPT_ROWS, UNIT_NONE, rows, 0, 0, 0, 0, 0, 0 \
	}

/* A heading of --help. */
#define OPT_HEADING(text)                                          \
	{                                                          \
		0, text, OPT_GROUP, UNIT_NONE, 0, 0, 0, 0, 0, 0, 0 \
	}

struct prog {
	const char *name;
	const char *gist;     /* one sentence, with full stop */
	const char *operands; /* "[file]", "[file ...]" or "" */
	const char *reads;    /* "fields: height" */
	const char *writes;   /* "table: one row per wear particle" */
	const struct opt *opts;
};

/* Parses and checks; leaves with status 2 on misuse, 0 after --help and --version.
 * Returns the index of the first operand; dies if there are more operands than
 * the program takes. */
int opt_parse(const struct prog *prog, int argc, char **argv);

/* 1 if the option with this word was on the command line. */
int opt_given(const char *word);
/* 1 if it was, and none of its numbers has a unit. */
int opt_given_bare(const char *word);
/* Dies if an option of these words, separated by blanks, was given without the other one,
 * which it needs to have an effect. */
void opt_require(const char *other, const char *words);
/* The word of the first of these rows whose option was given, or NULL. */
const char *opt_any_given(const struct opt *table);

/* What the program reads, for messages: "fields: height". */
const char *opt_reads(void);

/* The recorded command line, fresh memory: upstream, " | ", program, the options
 * given in long form and shell-quoted, then extra (may be NULL).  The operands are
 * recorded only where upstream is NULL, since otherwise upstream rebuilds the input. */
char *opt_cmd(const char *upstream, const char *extra);

/* The same for the file that --option FILE writes: a pipeline that writes it to standard
 * output.  The option itself must be unrecorded. */
char *opt_cmd_side(const char *upstream, const char *option);

/* Last call of main: writes --stats, checks that standard output was written
 * whole, and returns status (or leaves with EXIT_RUN). */
int shell_done(int status);

#endif
