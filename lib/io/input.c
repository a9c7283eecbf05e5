#include "io/input.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/progress.h"
#include "io/kinds.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { BUFFER = 1 << 16 };

struct input {
	FILE *f; /* holds the descriptor; reads bypass its buffer */
	int fd;
	int regular, whole;
	double size, taken; /* bytes: of a regular file, else 0; read so far */
	const char *name;
	size_t begin, end; /* unread bytes of buffer */
	unsigned char buffer[BUFFER];
};

struct input *input_open(const char *path)
{
	struct input *in = xcalloc(1, sizeof *in);
	struct stat s;

	in->f = file_open(path, &in->name);
	in->fd = fileno(in->f);
	in->regular = fstat(in->fd, &s) == 0 && S_ISREG(s.st_mode);
	in->size = in->regular ? (double)s.st_size : 0;
	return in;
}

const char *input_name(const struct input *in)
{
	return in->name;
}

void input_close(struct input *in)
{
	if (in->f != stdin)
		fclose(in->f);
	free(in);
}

void input_whole(struct input *in, int whole)
{
	in->whole = whole;
}

static int waits(const struct input *in)
{
	return file_followed() && in->regular && !in->whole;
}

/* What is in the buffer is still to be used. */
static void tell(const struct input *in)
{
	progress_read(in->taken - (double)(in->end - in->begin),
		file_followed() ? 0 : in->size);
}

static size_t read_some(struct input *in, void *bytes, size_t n)
{
	static const struct timespec pause = { 0, 50000000 };
	ssize_t got;

	for (;;) {
		got = read(in->fd, bytes, n);
		if (got > 0) {
			in->taken += (double)got;
			tell(in);
		}
		if (got > 0 || (got == 0 && !waits(in)))
			return (size_t)got;
		if (got == 0)
			nanosleep(&pause, NULL);
		else if (errno != EINTR)
			die(EXIT_RUN, "%s:", in->name);
	}
}

/* 0 at the end. */
static int fill(struct input *in)
{
	in->begin = 0;
	in->end = read_some(in, in->buffer, BUFFER);
	return in->end > 0;
}

int input_peek(struct input *in)
{
	return in->begin < in->end || fill(in) ? in->buffer[in->begin] : -1;
}

int input_get(struct input *in)
{
	return in->begin < in->end || fill(in) ? in->buffer[in->begin++] : -1;
}

int input_begins(struct input *in, const char *bytes)
{
	size_t n = strlen(bytes), more;

	while (in->end - in->begin < n) {
		memmove(in->buffer, in->buffer + in->begin, in->end - in->begin);
		in->end -= in->begin;
		in->begin = 0;
		more = read_some(in, in->buffer + in->end, BUFFER - in->end);
		if (!more)
			return 0;
		in->end += more;
	}
	return memcmp(in->buffer + in->begin, bytes, n) == 0;
}

size_t input_some(struct input *in, void *bytes, size_t n)
{
	size_t have;

	if (in->begin == in->end && n >= BUFFER)
		return read_some(in, bytes, n);
	if (in->begin == in->end && !fill(in))
		return 0;
	have = in->end - in->begin;
	if (have > n)
		have = n;
	memcpy(bytes, in->buffer + in->begin, have);
	in->begin += have;
	return have;
}

size_t input_read(struct input *in, void *bytes, size_t n)
{
	unsigned char *b = bytes;
	size_t done = 0, got;

	while (done < n && (got = input_some(in, b + done, n - done)) > 0)
		done += got;
	return done;
}

size_t input_line(struct input *in, char **line, size_t *room, size_t most)
{
	size_t n = 0;
	int over = 0;

	while (!over && input_peek(in) >= 0) {
		const unsigned char *from = in->buffer + in->begin, *newline;
		size_t piece = in->end - in->begin;

		newline = memchr(from, '\n', piece);
		if (newline)
			piece = (size_t)(newline - from) + 1;
		over = piece > most - n;
		if (over)
			piece = most - n;
		if (n + piece + 1 > *room) {
			*room = 2 * (n + piece + 1);
			*line = xrealloc(*line, *room, 1);
		}
		memcpy(*line + n, from, piece);
		n += piece;
		in->begin += piece;
		(*line)[n] = '\0';
		if (newline)
			break;
	}
	tell(in);
	return over ? most + 1 : n;
}

size_t input_text_line(
	struct input *in, char **line, size_t *room, size_t most, long *number)
{
	size_t n = input_line(in, line, room, most);

	if (n > 0 && ++*number == 1)
		kind_refuse(in->name, *line, n < most ? n : most, KIND_TABLE);
	if (n > most)
		die(EXIT_RUN, "%s: line %ld: longer than %zu bytes", in->name, *number,
			most);
	return n;
}

uint64_t input_left(const struct input *in)
{
	struct stat s;
	off_t here;

	if (file_followed() || !in->regular || fstat(in->fd, &s))
		return UINT64_MAX;
	here = lseek(in->fd, 0, SEEK_CUR);
	if (here < 0)
		return UINT64_MAX;
	return (s.st_size > here ? (uint64_t)(s.st_size - here) : 0) + in->end -
	       in->begin;
}

size_t input_limit(const char *name, size_t standard)
{
	const char *s = getenv("WEARPIPE_LIMITS");
	size_t length = strlen(name);

	while (s && *s) {
		if (strncmp(s, name, length) == 0 && s[length] == '=') {
			unsigned long long n = strtoull(s + length + 1, NULL, 10);

			return n < standard ? (size_t)n : standard;
		}
		s = strchr(s, ',');
		s += s != NULL;
	}
	return standard;
}
