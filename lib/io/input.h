/* input.h - the bytes of an input: a file, a pipe, or a file that is still being written
 *
 * Reads die where the system reports an error.  With --follow (file_follow()) a regular
 * file that ends is waited for: another process is writing it.
 */
#ifndef IO_INPUT_H
#define IO_INPUT_H

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct input;

/* path NULL or "-" is standard input. */
struct input *input_open(const char *path);
const char *input_name(const struct input *in); /* for messages */
void input_close(struct input *in);

/* With --follow: states whether the stream read so far is complete, so that the end of
 * the file is the end of the stream, or whether to wait. */
void input_whole(struct input *in, int whole);

/* The next byte, which input_peek() does not consume; -1 at the end. */
int input_get(struct input *in);
int input_peek(struct input *in);
/* 1 if the next bytes are these, at most 16; does not consume them. */
int input_begins(struct input *in, const char *bytes);
/* Up to n bytes: fewer only at the end. */
size_t input_read(struct input *in, void *bytes, size_t n);
/* The bytes available, at least one; 0 at the end. */
size_t input_some(struct input *in, void *bytes, size_t n);
/* A line with its newline, which only the last may lack, and a NUL after it, in memory
 * that grows.  Returns its length, 0 at the end, or most + 1 if it is longer than most
 * bytes; the first most bytes are stored then. */
size_t input_line(struct input *in, char **line, size_t *room, size_t most);
/* The same for the lines of a text, counted from 1 in *number: dies if a line is longer
 * than most or if the first line begins a stream of another kind. */
size_t input_text_line(
	struct input *in, char **line, size_t *room, size_t most, long *number);
/* Bytes that a regular file still holds; UINT64_MAX if unknown. */
uint64_t input_left(const struct input *in);

/* A bound on what is read, lowered by "NAME=N" in WEARPIPE_LIMITS; see
 * wearpipe-streams(5). */
size_t input_limit(const char *name, size_t standard);

#endif
