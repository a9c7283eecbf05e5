#include "cli/text.h"
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

void text_escape_to(char *to, const char *s)
{
	for (; *s; s++) {
		unsigned char c = (unsigned char)*s, next = (unsigned char)s[1];

		if (c == '\n' || c == '\t' || c == '\r') {
			*to++ = '\\';
			*to++ = c == '\n' ? 'n' : c == '\t' ? 't' : 'r';
		} else if (c < 32 || c == 127) {
			to += sprintf(to, "\\x%02x", c);
		} else if (c == 0xc2 && next >= 0x80 && next < 0xa0) {
			to += sprintf(to, "\\x%02x", next); /* U+0080 to U+009f */
			s++;
		} else {
			*to++ = (char)c;
		}
	}
	*to = '\0';
}

char *text_escape(const char *s)
{
	char *escaped = xcalloc(strlen(s) + 1, 4);

	text_escape_to(escaped, s);
	return escaped;
}

const char *text_file_name(const char *path)
{
	char *escaped, *quoted;

	if (*path && !path[strcspn(path, " \t\n'\":")]) {
		escaped = text_escape(path);
		if (!strcmp(escaped, path)) {
			free(escaped);
			return path;
		}
	} else {
		escaped = text_escape(path);
	}
	quoted = xprintf("'%s'", escaped);
	free(escaped);
	return quoted;
}
