#include "actions.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/text.h"
#include "io/fields.h"
#include "io/signals.h"
#include "io/tables.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { WORDS_MAX = 512, STAGES_MAX = 64 };

/* The text of a pipeline and the position of the reader. */
struct parser {
	const char *name; /* of the stream */
	const char *s;
};

static _Noreturn void refuse(const struct parser *p, const char *why)
{
	die(EXIT_RUN, "%s: its cmd is not replayed: %s at '%.40s'", p->name, why, p->s);
}

static void skip_blanks(struct parser *p)
{
	p->s += strspn(p->s, " ");
}

static int begins(const struct parser *p, const char *what)
{
	return strncmp(p->s, what, strlen(what)) == 0;
}

/* A word as opt_cmd() quotes it, fresh memory. */
static char *take_word(struct parser *p)
{
	char *word = xcalloc(strlen(p->s) + 1, 1), *to = word;

	while (*p->s && !strchr(" |;", *p->s)) {
		if (*p->s == '\'') {
			size_t n = strcspn(++p->s, "'");

			if (!p->s[n])
				refuse(p, "an unterminated quote");
			memcpy(to, p->s, n);
			to += n;
			p->s += n + 1;
		} else if (*p->s == '\\' && p->s[1]) {
			*to++ = p->s[1];
			p->s += 2;
		} else if (strchr("`$\"<>&(){}*?[]~#!\\", *p->s)) {
			refuse(p, "a special character of the shell");
		} else {
			*to++ = *p->s++;
		}
	}
	return word;
}

static const char *folder(void)
{
	static char path[PATH_MAX];
	ssize_t n = readlink("/proc/self/exe", path, sizeof path - 1);
	char *slash;

	if (n < 0)
		die(EXIT_RUN, "cannot tell where the programs are:");
	path[n] = '\0';
	slash = strrchr(path, '/');
	if (slash)
		*slash = '\0';
	return path;
}

static void check_program(const struct parser *p, const char *name)
{
	const char *programs = " " WEARPIPE_PROGRAMS " ";
	char *padded = xprintf(" %s ", name);

	if (strchr(name, ' ') || !*name || !strstr(programs, padded))
		die(EXIT_RUN,
			"%s: its cmd is not replayed: '%s' is not a program of wearpipe",
			p->name, name);
	free(padded);
}

static pid_t start(void (*run)(void *), void *context, int in, int out)
{
	pid_t pid = fork();

	if (pid < 0)
		die(EXIT_RUN, "cannot start a process:");
	if (pid > 0)
		return pid;
	if ((in != STDIN_FILENO && dup2(in, STDIN_FILENO) < 0) ||
		(out != STDOUT_FILENO && dup2(out, STDOUT_FILENO) < 0))
		die(EXIT_RUN, "cannot connect a process:");
	for (int fd = 3; fd < 16; fd++)
		close(fd);
	run(context);
	_exit(127);
}

/* One program, its arguments and the destination of its output. */
struct command {
	char *word[WORDS_MAX + 1];
	int side; /* descriptor 3 is the output, standard output goes nowhere */
};

static void run_command(void *context)
{
	struct command *c = context;
	char *path = xprintf("%s/%s", folder(), c->word[0]);

	if (c->side) {
		int moved = dup2(STDOUT_FILENO, 3), nowhere = open("/dev/null", O_WRONLY);

		if (moved < 0 || nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0)
			die(EXIT_RUN, "cannot connect a process:");
		close(nowhere);
	}
	execv(path, c->word);
	die(EXIT_RUN, "%s:", path);
}

static void parse_command(struct parser *p, struct command *c)
{
	int n = 0;

	c->side = 0;
	for (skip_blanks(p); *p->s && !strchr("|;", *p->s); skip_blanks(p)) {
		static const char turn[] = "3>&1 >/dev/null";

		if (begins(p, turn)) {
			p->s += sizeof turn - 1;
			c->side = 1;
			continue;
		}
		if (n == WORDS_MAX)
			refuse(p, "too many words");
		c->word[n++] = take_word(p);
	}
	if (!n)
		refuse(p, "a program name is missing");
	c->word[n] = NULL;
	check_program(p, c->word[0]);
}

static int run_pipeline(struct parser *p, int in, int out);

/* Pipelines between braces, one after another. */
struct group {
	struct parser at;
};

static void skip_group(struct parser *p)
{
	for (p->s++; *p->s && *p->s != '}';) {
		skip_blanks(p);
		if (*p->s == '{') {
			skip_group(p);
		} else if (*p->s == '|' || *p->s == ';') {
			p->s++;
		} else if (*p->s && *p->s != '}') {
			struct command c;

			parse_command(p, &c);
			for (int i = 0; c.word[i]; i++)
				free(c.word[i]);
		}
	}
	if (!*p->s)
		refuse(p, "an unterminated brace");
	p->s++;
}

static void run_group(void *context)
{
	struct group *g = context;
	struct parser *p = &g->at;
	int status = 0;

	p->s++;
	for (skip_blanks(p); !status && *p->s && *p->s != '}'; skip_blanks(p)) {
		status = run_pipeline(p, STDIN_FILENO, STDOUT_FILENO);
		p->s += *p->s == ';';
	}
	_exit(status);
}

/* Collects the statuses of all stages; the first that is not 0 counts. */
static int wait_for(const pid_t *stage, int n)
{
	int status = 0, s;

	for (int i = 0; i < n; i++) {
		while (waitpid(stage[i], &s, 0) < 0)
			if (errno != EINTR)
				die(EXIT_RUN, "cannot wait for a process:");
		s = WIFEXITED(s) ? WEXITSTATUS(s) : EXIT_RUN;
		status = status ? status : s;
	}
	return status;
}

static int run_pipeline(struct parser *p, int in, int out)
{
	pid_t stage[STAGES_MAX];
	int n = 0, from = in;

	for (;;) {
		struct group g;
		struct command c;
		int ends[2] = { -1, out }, group, more;

		skip_blanks(p);
		group = *p->s == '{';
		g.at = *p;
		if (group)
			skip_group(p);
		else
			parse_command(p, &c);
		skip_blanks(p);
		more = *p->s == '|';
		p->s += more;
		if (n == STAGES_MAX)
			refuse(p, "too many programs");
		if (more && pipe(ends))
			die(EXIT_RUN, "cannot open a pipe:");
		stage[n++] = group ? start(run_group, &g, from, ends[1])
				   : start(run_command, &c, from, ends[1]);
		if (from != in)
			close(from);
		if (!more)
			break;
		close(ends[1]);
		from = ends[0];
	}
	return wait_for(stage, n);
}

static char *copy(const char *cmd)
{
	return cmd ? xstrdup(cmd) : NULL;
}

/* The pipeline of a whole table, of the first record, or of a signal. */
static char *read_cmd(struct input *input)
{
	char *cmd = NULL;

	if (input_begins(input, "NRRD") || input_begins(input, "Gwyddion")) {
		struct fields_in *in = fields_from(input);
		struct record r = { 0 };
		struct text all = { 0 };
		char *last = NULL;
		long n = 0;

		while (fields_read(in, &r)) {
			if (!r.cmd)
				die(EXIT_RUN, "%s: record %ld has no cmd",
					fields_name(in), fields_count(in));
			/* one pipeline may make several records */
			if (last && strcmp(last, r.cmd) == 0)
				continue;
			text_add(&all, "%s; ", r.cmd);
			free(last);
			last = xstrdup(r.cmd);
			n++;
		}
		cmd = n > 1 ? xprintf("{ %s} | records --join", all.s)
			    : xprintf("%.*s", (int)(all.n - 2), all.s);
		free(all.s);
		free(last);
		record_free(&r);
		fields_close(in);
	} else if (input_begins(input, ".snd")) {
		struct signal_in *in = signal_from(input);

		cmd = copy(signal_format(in)->cmd);
		signal_close(in);
	} else {
		struct table_in *in = table_from(input);

		while (table_columns(in) && table_next(in))
			;
		cmd = copy(table_upstream(in));
		table_close(in);
	}
	return cmd;
}

static void copy_out(int fd)
{
	char buffer[1 << 14];
	ssize_t n;

	while ((n = read(fd, buffer, sizeof buffer)) > 0 || (n < 0 && errno == EINTR))
		if (n > 0 && fwrite(buffer, 1, (size_t)n, stdout) != (size_t)n)
			die(EXIT_RUN, "standard output:");
	if (n < 0)
		die(EXIT_RUN, "cannot read from a pipe:");
}

struct whole {
	struct parser at;
};

/* The whole pipeline is checked before anything is run. */
static void check_whole(struct parser p)
{
	for (;;) {
		struct command c;

		skip_blanks(&p);
		if (*p.s == '{') {
			skip_group(&p);
		} else {
			parse_command(&p, &c);
			for (int i = 0; c.word[i]; i++)
				free(c.word[i]);
		}
		skip_blanks(&p);
		if (!*p.s)
			return;
		if (*p.s++ != '|')
			refuse(&p, "another command");
	}
}

static void run_whole(void *context)
{
	struct whole *w = context;

	_exit(run_pipeline(&w->at, STDIN_FILENO, STDOUT_FILENO));
}

int replay_stream(const char *path)
{
	struct input *input = input_open(path);
	struct whole w = { { input_name(input), NULL } };
	char *cmd = read_cmd(input);
	int ends[2], nowhere = open("/dev/null", O_RDONLY), status;
	pid_t child;

	if (!cmd)
		die(EXIT_RUN, "%s: no cmd: the stream does not state how it was made",
			w.at.name);
	w.at.s = cmd;
	note("%s: %s", w.at.name, cmd);
	if (nowhere < 0 || setenv(FILE_REPLAY, "1", 1) || pipe(ends))
		die(EXIT_RUN, "cannot open a pipe:");
	fflush(stdout);
	check_whole(w.at);
	child = start(run_whole, &w, nowhere, ends[1]);
	close(ends[1]);
	copy_out(ends[0]);
	status = wait_for(&child, 1);
	free(cmd);
	return status;
}
