/* text.h - growing strings, and escaping of text from outside for a line of output
 *
 *	struct text t = { 0 };
 *	text_add(&t, "%d of %d", 3, 4);
 *	puts(t.s);
 *	free(t.s);
 */
#ifndef CLI_TEXT_H
#define CLI_TEXT_H

#include <stddef.h>

struct text {
	char *s;  /* NULL until something was added */
	size_t n; /* its length */
	size_t room;
};

void text_add(struct text *t, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

/* Fresh memory: control characters as in C, "\n", "\t" or "\x1b", so that the text stays
 * within its line and cell; the rest as it is. */
char *text_escape(const char *s);

/* The name of a file as messages show it: between single quotes and escaped where it has
 * blanks, quotes, colons or control characters, else path itself. */
const char *text_file_name(const char *path);

#endif
