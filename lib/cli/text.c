#include "cli/text.h"
#include "cli/escape.h"
#include "cli/msg.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void text_add(struct text *t, const char *format, ...)
{
	va_list ap;
	int n;

	va_start(ap, format);
	n = vsnprintf(NULL, 0, format, ap);
	va_end(ap);
	if (n < 0)
		die(EXIT_RUN, "cannot format text");
	if (t->n + (size_t)n + 1 > t->room) {
		t->room = 2 * (t->n + (size_t)n + 1);
		t->s = xrealloc(t->s, t->room, 1);
	}
	va_start(ap, format);
	vsnprintf(t->s + t->n, (size_t)n + 1, format, ap);
	va_end(ap);
	t->n += (size_t)n;
}

char *text_escape(const char *s)
{
	char *escaped = xcalloc(strlen(s) + 1, 4);

	escape_to(escaped, s);
	return escaped;
}

const char *text_file_name(const char *path)
{
	char *escaped = text_escape(path), *quoted;

	if (*path && !path[strcspn(path, " \t\n'\":")] && strcmp(escaped, path) == 0) {
		free(escaped);
		return path;
	}
	quoted = xprintf("'%s'", escaped);
	free(escaped);
	return quoted;
}
