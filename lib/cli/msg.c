#include "cli/msg.h"
#include "cli/escape.h"
#include "cli/program.h"
#include "cli/progress.h"
#include <errno.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int verbose;

static void say(const char *format, va_list ap)
{
	/* Allocates no memory: the message may be about that. */
	static char text[4096], line[4 * sizeof text];
	int reason = errno;
	size_t length = strlen(format);

	progress_clear();
	fflush(stdout);
	vsnprintf(text, sizeof text, format, ap);
	escape_to(line, text);
	if (length && format[length - 1] == ':')
		fprintf(stderr, "%s: %s %s\n", program_name(), line, strerror(reason));
	else
		fprintf(stderr, "%s: %s\n", program_name(), line);
}

void die(int status, const char *format, ...)
{
	va_list ap;

	va_start(ap, format);
	say(format, ap);
	va_end(ap);
	exit(status);
}

void warn(const char *format, ...)
{
	va_list ap;

	va_start(ap, format);
	say(format, ap);
	va_end(ap);
}

void note(const char *format, ...)
{
	va_list ap;

	if (!verbose)
		return;
	va_start(ap, format);
	say(format, ap);
	va_end(ap);
}

void *xrealloc(void *p, size_t count, size_t size)
{
	if (size && count > SIZE_MAX / size)
		die(EXIT_RUN, "%zu values of %zu bytes do not fit in memory", count,
			size);
	p = realloc(p, count && size ? count * size : 1);
	if (!p)
		die(EXIT_RUN, "out of memory: wanted %zu bytes", count * size);
	return p;
}

void *xcalloc(size_t count, size_t size)
{
	void *p = calloc(count ? count : 1, size ? size : 1);

	if (!p)
		die(EXIT_RUN, "out of memory: wanted %zu values of %zu bytes", count,
			size);
	return p;
}

char *xstrdup(const char *s)
{
	size_t size = strlen(s) + 1;

	return memcpy(xcalloc(size, 1), s, size);
}

char *xvappend(char *text, size_t *length, size_t *room, const char *format, va_list ap)
{
	va_list again;
	int n;

	va_copy(again, ap);
	n = vsnprintf(NULL, 0, format, again);
	va_end(again);
	if (n < 0)
		die(EXIT_RUN, "cannot format text");
	if (*length + (size_t)n + 1 > *room) {
		*room = 2 * (*length + (size_t)n + 1);
		text = xrealloc(text, *room, 1);
	}
	vsnprintf(text + *length, (size_t)n + 1, format, ap);
	*length += (size_t)n;
	return text;
}

char *xprintf(const char *format, ...)
{
	size_t length = 0, room = 0;
	va_list ap;
	char *s;

	va_start(ap, format);
	s = xvappend(NULL, &length, &room, format, ap);
	va_end(ap);
	return s;
}

char *xappend(char *text, const char *format, ...)
{
	size_t length = text ? strlen(text) : 0, room = 0;
	va_list ap;

	va_start(ap, format);
	text = xvappend(text, &length, &room, format, ap);
	va_end(ap);
	return text;
}
