/* signals.c - Sun AU; see wearpipe-streams(5)
 *
 * Chosen because its length may be unknown (0xffffffff), so that it streams, and
 * because sox, libsndfile, Octave and numpy read it.
 */
#include "io/signals.h"
#include "io/bytes.h"
#include "io/kinds.h"
#include "cli/files.h"
#include "cli/msg.h"
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
	HEADER_MIN = 24,
	HEADER_MAX = 1 << 20,
	BUFFER = 1 << 16,
	CHANNELS_MAX = 64,
	PCM8 = 2,
	PCM16 = 3,
	PCM24 = 4,
	PCM32 = 5,
	FLOAT32 = 6,
	FLOAT64 = 7
};

static const uint32_t unknown = 0xffffffff;

struct signal_in {
	struct signal_format format;
	const char *name;
	FILE *f;
	int fd;               /* of f: what is there is read, however little */
	int encoding;         /* 0: raw little-endian float64 */
	size_t width;         /* bytes per sample */
	uint64_t left, total; /* bytes of data still declared; UINT64_MAX: unknown */
	unsigned char buffer[BUFFER];
	size_t begin, end; /* unread bytes of buffer */
	int at_end;
};

struct signal_out {
	FILE *f;
	const char *name;
	int channels, single;
};

/* Reads what is there, at least one byte; 0 at the end. */
static size_t fill(struct signal_in *in)
{
	ssize_t n;

	if (in->begin > 0) {
		memmove(in->buffer, in->buffer + in->begin, in->end - in->begin);
		in->end -= in->begin;
		in->begin = 0;
	}
	do
		n = read(in->fd, in->buffer + in->end, BUFFER - in->end);
	while (n < 0 && errno == EINTR);
	if (n < 0)
		die(EXIT_RUN, "%s:", in->name);
	in->end += (size_t)n;
	in->at_end = n == 0;
	return (size_t)n;
}

static int have(struct signal_in *in, size_t bytes)
{
	while (in->end - in->begin < bytes)
		if (!fill(in))
			return 0;
	return 1;
}

static char *read_annotation(struct signal_in *in, size_t size)
{
	char *text = xcalloc(size + 1, 1);

	for (size_t i = 0; i < size; i++) {
		if (!have(in, 1))
			die(EXIT_RUN, "%s: the stream ends inside the header", in->name);
		text[i] = (char)in->buffer[in->begin++];
	}
	return text;
}

/* Value of the line "key value" of an annotation, fresh memory; NULL if none. */
static char *annotated(const char *text, const char *key)
{
	size_t n = strlen(key);

	while (*text) {
		size_t length = strcspn(text, "\n");

		if (length > n && strncmp(text, key, n) == 0 && text[n] == ' ') {
			char *value = xcalloc(length - n, 1);

			return memcpy(value, text + n + 1, length - n - 1);
		}
		text += length + (text[length] == '\n');
	}
	return NULL;
}

static void read_header(struct signal_in *in)
{
	static const size_t widths[] = { [PCM8] = 1,
		[PCM16] = 2,
		[PCM24] = 3,
		[PCM32] = 4,
		[FLOAT32] = 4,
		[FLOAT64] = 8 };
	uint32_t header, size, encoding, rate, channels;
	const unsigned char *b;
	char *text;

	if (!have(in, HEADER_MIN) || memcmp(in->buffer + in->begin, ".snd", 4) != 0)
		kind_refuse(in->name, in->buffer + in->begin, in->end - in->begin,
			KIND_SIGNAL);
	if (!have(in, HEADER_MIN))
		die(EXIT_RUN, "%s: want an AU header of at least %d bytes, got %zu",
			in->name, HEADER_MIN, in->end - in->begin);
	b = in->buffer + in->begin;
	if (memcmp(b, ".snd", 4) != 0) {
		int shown = 0;

		while (shown < 4 && isprint(b[shown]))
			shown++;
		die(EXIT_RUN, "%s: want AU ('.snd'), got '%.*s'", in->name, shown,
			(const char *)b);
	}
	header = bytes_u32_big(b + 4);
	size = bytes_u32_big(b + 8);
	encoding = bytes_u32_big(b + 12);
	rate = bytes_u32_big(b + 16);
	channels = bytes_u32_big(b + 20);
	if (header < HEADER_MIN || header > HEADER_MAX)
		die(EXIT_RUN, "%s: AU header of %lu bytes, want %d to %d", in->name,
			(unsigned long)header, HEADER_MIN, HEADER_MAX);
	if (encoding < PCM8 || encoding > FLOAT64)
		die(EXIT_RUN, "%s: AU encoding %lu, want 2 to 7 (linear PCM or float)",
			in->name, (unsigned long)encoding);
	if (rate < 1 || rate > 2000000000)
		die(EXIT_RUN, "%s: rate %lu Hz, want 1 to 2e9", in->name,
			(unsigned long)rate);
	if (channels < 1 || channels > CHANNELS_MAX)
		die(EXIT_RUN, "%s: %lu channels, want 1 to %d", in->name,
			(unsigned long)channels, CHANNELS_MAX);
	in->begin += HEADER_MIN;
	in->encoding = (int)encoding;
	in->width = widths[encoding];
	in->left = in->total = size == unknown ? UINT64_MAX : size;
	in->format.rate = (long)rate;
	in->format.channels = (int)channels;
	in->format.single = encoding != FLOAT64 && encoding != PCM32;
	text = read_annotation(in, header - HEADER_MIN);
	in->format.cmd = annotated(text, "cmd");
	in->format.units = annotated(text, "units");
	in->format.seed = annotated(text, "seed");
	in->format.filter = annotated(text, "filter");
	free(text);
}

struct signal_in *signal_open(const char *path, const struct signal_raw *raw)
{
	struct signal_in *in = xcalloc(1, sizeof *in);

	in->f = file_open(path, &in->name);
	in->fd = fileno(in->f);
	if (raw) {
		in->format.rate = raw->rate;
		in->format.channels = raw->channels;
		in->width = 8;
		in->left = in->total = UINT64_MAX;
	} else {
		read_header(in);
	}
	return in;
}

const struct signal_format *signal_format(const struct signal_in *in)
{
	return &in->format;
}

const char *signal_name(const struct signal_in *in)
{
	return in->name;
}

static int32_t pcm(const unsigned char *b, size_t width)
{
	uint32_t v = 0;

	for (size_t i = 0; i < width; i++)
		v |= (uint32_t)b[i] << (24 - 8 * i);
	return (int32_t)v;
}

static void decode(
	const struct signal_in *in, const unsigned char *b, double *x, size_t n)
{
	switch (in->encoding) {
	case 0:
		for (size_t i = 0; i < n; i++)
			x[i] = bytes_double_little(b + 8 * i);
		break;
	case FLOAT64:
		for (size_t i = 0; i < n; i++)
			x[i] = bytes_double_big(b + 8 * i);
		break;
	case FLOAT32:
		for (size_t i = 0; i < n; i++)
			x[i] = (double)bytes_float(bytes_u32_big(b + 4 * i));
		break;
	default:
		for (size_t i = 0; i < n; i++)
			x[i] = pcm(b + in->width * i, in->width) / 2147483648.0;
	}
}

static void check_end(const struct signal_in *in, size_t frame)
{
	if (in->total != UINT64_MAX && in->left > 0)
		die(EXIT_RUN, "%s: want %llu bytes of samples, got %llu", in->name,
			(unsigned long long)in->total,
			(unsigned long long)(in->total - in->left + in->end - in->begin));
	if (in->end - in->begin > 0 && in->left > 0)
		die(EXIT_RUN,
			"%s: the stream ends inside a frame: want %zu bytes, got %zu",
			in->name, frame, in->end - in->begin);
}

/* Decodes what the buffer holds, at most nframes. */
static size_t take(struct signal_in *in, double *x, size_t nframes)
{
	size_t channels = (size_t)in->format.channels, frame = in->width * channels;
	uint64_t bytes = in->end - in->begin;
	size_t n;

	if (in->left < bytes)
		bytes = in->left;
	n = (size_t)bytes / frame;
	if (n > nframes)
		n = nframes;
	decode(in, in->buffer + in->begin, x, n * channels);
	in->begin += n * frame;
	if (in->left != UINT64_MAX)
		in->left -= n * frame;
	return n;
}

size_t signal_read_some(struct signal_in *in, double *x, size_t nframes)
{
	size_t frame = in->width * (size_t)in->format.channels, n;

	while ((n = take(in, x, nframes)) == 0) {
		if (in->left == 0)
			return 0;
		if (in->left < frame)
			die(EXIT_RUN,
				"%s: %llu bytes of samples are no whole frames of %zu",
				in->name, (unsigned long long)in->total, frame);
		if (in->at_end || !fill(in)) {
			check_end(in, frame);
			return 0;
		}
	}
	return n;
}

size_t signal_read(struct signal_in *in, double *x, size_t nframes)
{
	size_t n = 0, got;

	while (n < nframes && (got = signal_read_some(in,
				       x + n * (size_t)in->format.channels, nframes - n)))
		n += got;
	return n;
}

void signal_close(struct signal_in *in)
{
	if (in->f != stdin)
		fclose(in->f);
	free(in->format.cmd);
	free(in->format.units);
	free(in->format.seed);
	free(in->format.filter);
	free(in);
}

/* A line for each thing that is known. */
static char *annotation(const struct signal_format *format)
{
	const char *line[][2] = { { "cmd", format->cmd }, { "units", format->units },
		{ "seed", format->seed }, { "filter", format->filter } };
	char *text = xprintf("%s", "");

	for (size_t i = 0; i < sizeof line / sizeof *line; i++) {
		char *longer;

		if (!line[i][1])
			continue;
		longer = xprintf("%s%s %s\n", text, line[i][0], line[i][1]);
		free(text);
		text = longer;
	}
	return text;
}

static void write_header(struct signal_out *out, const struct signal_format *format)
{
	unsigned char b[HEADER_MIN] = ".snd";
	char *text = annotation(format);
	size_t length = strlen(text), padded = (length + 1 + 7) / 8 * 8;

	bytes_put_u32_big(b + 4, (uint32_t)(HEADER_MIN + padded));
	bytes_put_u32_big(b + 8, unknown);
	bytes_put_u32_big(b + 12, format->single ? FLOAT32 : FLOAT64);
	bytes_put_u32_big(b + 16, (uint32_t)format->rate);
	bytes_put_u32_big(b + 20, (uint32_t)format->channels);
	fwrite(b, 1, sizeof b, out->f);
	fwrite(text, 1, length, out->f);
	for (; length < padded; length++)
		putc(0, out->f);
	free(text);
}

struct signal_out *signal_create(const char *path, const struct signal_format *format)
{
	struct signal_out *out = xcalloc(1, sizeof *out);

	out->f = file_create(path, &out->name);
	out->channels = format->channels;
	out->single = format->single;
	if (isatty(fileno(out->f)))
		die(EXIT_USAGE, "not writing binary data to a terminal");
	write_header(out, format);
	return out;
}

void signal_write(struct signal_out *out, const double *x, size_t nframes)
{
	enum { CHUNK = 8192 }; /* 64 KiB, what a pipe holds */
	size_t n = nframes * (size_t)out->channels, width = out->single ? 4 : 8;
	unsigned char bytes[8 * CHUNK];

	while (n > 0) {
		size_t m = n < CHUNK ? n : CHUNK;

		for (size_t i = 0; i < m; i++) {
			if (out->single)
				bytes_put_float_big(bytes + 4 * i, (float)x[i]);
			else
				bytes_put_double_big(bytes + 8 * i, x[i]);
		}
		if (fwrite(bytes, width, m, out->f) != m)
			die(EXIT_RUN, "%s:", out->name);
		x += m;
		n -= m;
	}
}

void signal_flush(struct signal_out *out)
{
	if (fflush(out->f))
		die(EXIT_RUN, "%s:", out->name);
}

void signal_done(struct signal_out *out)
{
	signal_flush(out);
	if (out->f != stdout && fclose(out->f))
		die(EXIT_RUN, "%s:", out->name);
	free(out);
}
