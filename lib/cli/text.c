#include "cli/text.h"
#include "cli/escape.h"
#include "cli/msg.h"
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void text_add(struct text *t, const char *format, ...)
{
	va_list ap;

	va_start(ap, format);
	t->s = xvappend(t->s, &t->n, &t->room, format, ap);
	va_end(ap);
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
