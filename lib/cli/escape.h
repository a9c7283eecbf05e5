/* escape.h - escaping of text from outside for a line of output, without allocation */
#ifndef CLI_ESCAPE_H
#define CLI_ESCAPE_H

/* Control characters as in C, "\n", "\t" or "\x1b", the rest as it is; to holds four
 * times as many bytes as s. */
void escape_to(char *to, const char *s);

#endif
