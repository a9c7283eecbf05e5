/* check.h - is a stream whole?  Of any format */
#ifndef CHECK_H
#define CHECK_H

/* Reads the stream to its end and prints a line with its contents; dies if it is damaged
 * or truncated.  Returns the exit status: Returns EXIT_NOCONV if the stream has no end
 * mark, so that completeness is unknown. */
int check_stream(const char *path);

#endif
