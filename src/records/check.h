/* check.h - is a stream whole?  Of any format */
#ifndef CHECK_H
#define CHECK_H

/* Reads the stream to its end and prints a line that says what it holds; dies where it is
 * damaged or cut off.  Returns the exit status: EXIT_NOCONV where the stream has no mark
 * of its end, so that nobody can tell. */
int check_stream(const char *path);

#endif
