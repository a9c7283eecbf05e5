/* msg.h - messages, exit statuses and checked allocation
 *
 * All programs fail in one way: die() prints a single line "program: what" and ends the
 * program.  A format that ends in ':' gets the reason from errno appended, as in
 * die(EXIT_RUN, "%s:", path)  ->  "bemcontact: surf.nrrd: No such file".
 * Only lib/cli, lib/io and src may call these; the numerics return statuses.
 */
#ifndef CLI_MSG_H
#define CLI_MSG_H

#include <stdarg.h>
#include <stddef.h>

enum {
	EXIT_RUN = 1,    /* the run failed: bad input, no memory, disk full */
	EXIT_USAGE = 2,  /* the command line is wrong */
	EXIT_NOCONV = 3, /* did not converge; the best result was written */
	EXIT_ALARM = 4   /* an alarm is active after the last rows */
};

/* Level of -v: 0 silent, 1 a line per record, 2 more. */
extern int verbose;

_Noreturn void die(int status, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
/* Prints one line and continues; for warnings. */
void warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* Prints one line when -v was given. */
void note(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* These die without memory.  count * size is checked for overflow; memory is zeroed. */
void *xcalloc(size_t count, size_t size);
void *xrealloc(void *p, size_t count, size_t size);
char *xstrdup(const char *s);
/* printf into fresh memory. */
char *xprintf(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* printf behind a text, which is moved, or NULL. */
char *xappend(char *text, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The same behind its first *length characters, in memory of *room. */
char *xvappend(char *text, size_t *length, size_t *room, const char *format, va_list ap)
	__attribute__((format(printf, 4, 0)));

#endif
