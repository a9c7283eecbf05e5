/* signals.c - Sun AU; see wearpipe-streams(5)
 *
 * Chosen because its length may be unknown (0xffffffff), so that it streams, and
 * because sox, libsndfile, Octave and numpy read it.
 */
#include "io/signals.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/text.h"
#include "cli/unit.h"
#include "io/ends.h"
#include "io/input.h"
#include "io/kinds.h"
#include "io/reasons.h"
#include "num/bytes.h"
#include "num/crc32.h"
#include <ctype.h>
#include <float.h>
#include <math.h>
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
	struct input *in;
	const char *name;
	int encoding;         /* 0: raw little-endian float64 */
	size_t width, frame;  /* bytes per sample, per frame */
	uint64_t left, total; /* bytes of data still declared; UINT64_MAX: unknown */
	int promised;         /* the last frame is an end */
	uint32_t checksum; /* checksum of the bytes returned, where an end is announced */
	uint64_t frames;   /* handed out */
	double huge, tiny; /* samples of magnitudes that no signal has */
	int done;          /* no more frames to return */
	unsigned char buffer[BUFFER];
	size_t begin, end; /* unread bytes of buffer */
};

struct signal_out {
	FILE *f;
	const char *name;
	int channels, single;
	uint32_t checksum;
	uint64_t frames;
	unsigned char buffer[BUFFER]; /* capacity of a pipe */
};

/* A subnormal number, which every tool treats as silence: a bit that marks it, the lowest
 * bits of the number of frames, and those of the checksum of all bytes before. */
static void make_end(unsigned char *b, int single, uint64_t frames, uint32_t checksum)
{
	if (single) {
		bytes_put_u32_big(b, 0x400000u | (checksum & 0x3fffffu));
		return;
	}
	bytes_put_u32_big(b, 0x80000u | (uint32_t)(frames & 0x7ffff));
	bytes_put_u32_big(b + 4, checksum);
}

/* Reads the bytes available, at least one; 0 at the end. */
static size_t fill(struct signal_in *in)
{
	size_t n;

	if (in->begin > 0) {
		memmove(in->buffer, in->buffer + in->begin, in->end - in->begin);
		in->end -= in->begin;
		in->begin = 0;
	}
	n = input_some(in->in, in->buffer + in->end, BUFFER - in->end);
	in->end += n;
	return n;
}

static char *read_annotation(struct signal_in *in, size_t size)
{
	char *text = xcalloc(size + 1, 1);

	if (input_read(in->in, text, size) < size)
		die(EXIT_RUN, "%s: the stream ends inside the header", in->name);
	in->checksum = crc32_add(in->checksum, text, size);
	return text;
}

/* Value of the line "key value" of an annotation, fresh memory; NULL if none. */
static char *annotated(const char *text, const char *key)
{
	size_t n = strlen(key);

	while (*text) {
		size_t length = strcspn(text, "\n");

		if (length > n && strncmp(text, key, n) == 0 && text[n] == ' ') {
			char *value = xcalloc(length - n, 1), *escaped;

			memcpy(value, text + n + 1, length - n - 1);
			escaped = text_escape(value);
			free(value);
			return escaped;
		}
		text += length + (text[length] == '\n');
	}
	return NULL;
}

/* The header has room only for whole numbers: signals of the suite have other rates in
 * the annotation too. */
static uint32_t whole_rate(double rate)
{
	return rate < 1 ? 1 : (uint32_t)(rate + 0.5);
}

static void take_rate(struct signal_in *in, const char *text)
{
	char *told = annotated(text, "rate"), *end = told;
	double rate = told ? strtod(told, &end) : NAN;

	if (told) {
		if (end == told || *end || !(rate > 0) ||
			whole_rate(rate) != (uint32_t)in->format.rate)
			die(EXIT_RUN, "%s: rate '%.40s' in a signal of %g Hz", in->name,
				told, in->format.rate);
		in->format.rate = rate;
	}
	free(told);
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
	unsigned char b[HEADER_MIN];
	size_t got = input_read(in->in, b, HEADER_MIN);
	char *text, *promise;
	int own; /* a signal of the suite */

	if (got < HEADER_MIN || memcmp(b, ".snd", 4) != 0)
		kind_refuse(in->name, b, got, KIND_SIGNAL);
	if (got == 0)
		die(EXIT_RUN, "%s: empty, want a signal", in->name);
	if (got < HEADER_MIN)
		die(EXIT_RUN, "%s: want an AU header of at least %d bytes, got %zu",
			in->name, HEADER_MIN, got);
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
	in->checksum = crc32_add(0, b, HEADER_MIN);
	in->encoding = (int)encoding;
	in->width = widths[encoding];
	in->left = in->total = size == unknown ? UINT64_MAX : size;
	in->format.rate = (double)rate;
	in->format.channels = (int)channels;
	in->format.single = encoding != FLOAT64 && encoding != PCM32;
	text = read_annotation(in, header - HEADER_MIN);
	promise = annotated(text, "stream");
	own = promise && !strcmp(promise, ENDS_PROMISE);
	in->promised = own && size == unknown && encoding >= FLOAT32;
	free(promise);
	in->format.cmd = annotated(text, "cmd");
	in->format.units = annotated(text, "units");
	in->format.seed = annotated(text, "seed");
	in->format.filter = annotated(text, "filter");
	in->format.start = annotated(text, "start");
	in->format.doubt = annotated(text, "doubtful");
	if (own)
		take_rate(in, text);
	free(text);
}

static struct signal_in *new_signal(struct input *input, const struct signal_raw *raw)
{
	struct signal_in *in = xcalloc(1, sizeof *in);

	in->in = input;
	in->name = input_name(input);
	if (raw) {
		in->format.rate = raw->rate;
		in->format.channels = raw->channels;
		in->width = 8;
		in->left = in->total = UINT64_MAX;
	} else {
		read_header(in);
	}
	in->frame = in->width * (size_t)in->format.channels;
	return in;
}

struct signal_in *signal_open(const char *path, const struct signal_raw *raw)
{
	return new_signal(input_open(path), raw);
}

struct signal_in *signal_from(struct input *in)
{
	return new_signal(in, NULL);
}

int signal_marked(const struct signal_in *in)
{
	return in->promised || in->total != UINT64_MAX;
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

/* Floating-point numbers of the other byte order have random exponents, of which 30 % are
 * above 1e15 in 32 bits and above 1e100 in 64, or if their last bytes are 0 the least
 * ones.
 */
static void note_magnitudes(struct signal_in *in, const double *x, size_t n)
{
	const double most = in->encoding == FLOAT32 ? 1e15 : 1e100;

	for (size_t i = 0; i < n; i++) {
		double magnitude = fabs(x[i]);

		in->huge += magnitude > most && magnitude <= DBL_MAX;
		in->tiny += magnitude > 0 && magnitude < 1 / most / most;
	}
}

/* Returns n frames of the buffer. */
static void take(struct signal_in *in, double *x, size_t n)
{
	const unsigned char *b = in->buffer + in->begin;

	decode(in, b, x, n * (size_t)in->format.channels);
	if (!in->promised && in->encoding >= FLOAT32)
		note_magnitudes(in, x, n * (size_t)in->format.channels);
	if (in->promised)
		in->checksum = crc32_add(in->checksum, b, n * in->frame);
	in->begin += n * in->frame;
	in->frames += n;
	if (in->left != UINT64_MAX)
		in->left -= n * in->frame;
}

/* Frames of the buffer that can be returned: one that may be the end is kept. */
static size_t ready(const struct signal_in *in)
{
	uint64_t bytes = in->end - in->begin;

	if (in->left < bytes)
		bytes = in->left;
	return (size_t)(bytes / in->frame) - (in->promised && bytes >= in->frame);
}

/* 1 if the last frame is the end mark; torn: whether it has the form of one at all. */
static int is_end(const struct signal_in *in, int *torn)
{
	const unsigned char *b = in->buffer + in->begin;
	unsigned char want[8];
	int same = 1;

	*torn = 0;
	make_end(want, in->width == 4, in->frames, in->checksum);
	for (int c = 0; c < in->format.channels; c++, b += in->width) {
		same &= memcmp(b, want, in->width) == 0;
		*torn |= (bytes_u32_big(b) >> (in->width == 4 ? 22 : 19)) != 1;
	}
	return same;
}

/* Reads more; under --follow a frame that may be the end mark is treated as one. */
static size_t fill_past(struct signal_in *in)
{
	int torn;

	input_whole(in->in,
		in->promised && in->end - in->begin == in->frame && is_end(in, &torn));
	return fill(in);
}

/* At the end of the bytes of a signal with an end mark: the last frame is the mark, or a
 * frame of a truncated signal, which is returned. */
static size_t finish_promised(struct signal_in *in, double *x)
{
	size_t rest = in->end - in->begin, n = 0;
	int torn = 1;

	if (rest == in->frame && is_end(in, &torn))
		return 0;
	if (rest >= in->frame && torn) {
		n = 1;
		take(in, x, 1);
	}
	if (!torn)
		ends_miss("%s: the checksum of its end does not fit its %llu frames: "
			  "damaged, or signals joined",
			in->name, (unsigned long long)in->frames);
	else if (!file_followed())
		ends_miss("%s: the signal has no end after %llu frames: what wrote it "
			  "did not finish",
			in->name, (unsigned long long)in->frames);
	return n;
}

static void check_end(const struct signal_in *in)
{
	size_t rest = in->end - in->begin;
	unsigned long long got = in->total - in->left + rest;

	if (in->total != UINT64_MAX && in->left > 0)
		ends_miss("%s: want %llu bytes of samples, got %llu", in->name,
			(unsigned long long)in->total, got);
	else if (rest > 0 && !file_followed())
		ends_miss("%s: the stream ends inside a frame: want %zu bytes, got %zu",
			in->name, in->frame, rest);
}

/* More than half are huge only where a signal is so on purpose. */
static void check_order(const struct signal_in *in)
{
	double samples = (double)in->frames * in->format.channels;

	if ((in->huge > 0.01 * samples && in->huge < 0.5 * samples) ||
		in->tiny > 0.5 * samples)
		ends_miss(
			"%s: samples of impossible magnitudes: want them big-endian, as the "
			"format AU has them",
			in->name);
}

/* All declared bytes were returned, or less than a frame of them is left. */
static void check_declared(struct signal_in *in)
{
	if (in->left > 0)
		ends_miss("%s: %llu bytes of samples are no whole frames of %zu",
			in->name, (unsigned long long)in->total, in->frame);
	else if (in->end > in->begin || input_peek(in->in) >= 0)
		ends_miss("%s: want %llu bytes of samples, got more", in->name,
			(unsigned long long)in->total);
}

size_t signal_read_some(struct signal_in *in, double *x, size_t nframes)
{
	size_t n;

	if (in->done)
		ends_check();
	while (!in->done) {
		n = ready(in);
		if (n > nframes)
			n = nframes;
		if (n > 0) {
			take(in, x, n);
			return n;
		}
		in->done = 1;
		check_order(in);
		if (in->left < in->frame)
			check_declared(in);
		else if (fill_past(in))
			in->done = 0;
		else if (in->promised)
			return finish_promised(in, x);
		else
			check_end(in);
	}
	return 0;
}

size_t signal_read(struct signal_in *in, double *x, size_t nframes)
{
	size_t n = 0, got;

	while (n < nframes && !(in->done && n) &&
		(got = signal_read_some(
			 in, x + n * (size_t)in->format.channels, nframes - n)))
		n += got;
	return n;
}

const char *signal_doubted(const struct signal_in *in)
{
	return reasons_tell(in->name, in->format.doubt);
}

void signal_close(struct signal_in *in)
{
	if (in->done)
		ends_check();
	input_close(in->in);
	free(in->format.cmd);
	free(in->format.units);
	free(in->format.seed);
	free(in->format.filter);
	free(in->format.start);
	free(in->format.doubt);
	free(in);
}

/* One line for each property that is known. */
static char *annotation(const struct signal_format *format)
{
	char rate[NUMBER_TEXT];
	const char *fraction = format->rate != floor(format->rate)
				       ? number_text(format->rate, rate)
				       : NULL;
	const char *line[][2] = { { "stream", ENDS_PROMISE }, { "cmd", format->cmd },
		{ "units", format->units }, { "seed", format->seed },
		{ "filter", format->filter }, { "rate", fraction },
		{ "start", format->start }, { "doubtful", format->doubt } };
	char *text = xprintf("%s", "");

	for (size_t i = 0; i < sizeof line / sizeof *line; i++)
		if (line[i][1])
			text = xappend(text, "%s %s\n", line[i][0], line[i][1]);
	return text;
}

static void put_bytes(struct signal_out *out, const void *bytes, size_t n)
{
	out->checksum = crc32_add(out->checksum, bytes, n);
	if (fwrite(bytes, 1, n, out->f) != n)
		die(EXIT_RUN, "%s:", out->name);
}

static void write_header(struct signal_out *out, const struct signal_format *format)
{
	unsigned char b[HEADER_MIN] = ".snd";
	char *text = annotation(format);
	size_t length = strlen(text), padded = (length + 1 + 7) / 8 * 8;

	bytes_put_u32_big(b + 4, (uint32_t)(HEADER_MIN + padded));
	bytes_put_u32_big(b + 8, unknown);
	bytes_put_u32_big(b + 12, format->single ? FLOAT32 : FLOAT64);
	bytes_put_u32_big(b + 16, whole_rate(format->rate));
	bytes_put_u32_big(b + 20, (uint32_t)format->channels);
	text = xrealloc(text, padded, 1);
	memset(text + length, 0, padded - length);
	put_bytes(out, b, sizeof b);
	put_bytes(out, text, padded);
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
	enum { CHUNK = BUFFER / 8 };
	size_t n = nframes * (size_t)out->channels, width = out->single ? 4 : 8;
	unsigned char *bytes = out->buffer;

	out->frames += nframes;
	while (n > 0) {
		size_t m = n < CHUNK ? n : CHUNK;

		for (size_t i = 0; i < m; i++) {
			if (out->single)
				bytes_put_float_big(bytes + 4 * i, (float)x[i]);
			else
				bytes_put_double_big(bytes + 8 * i, x[i]);
		}
		put_bytes(out, bytes, m * width);
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
	unsigned char end[8];

	ends_check();
	make_end(end, out->single, out->frames, out->checksum);
	for (int c = 0; c < out->channels; c++)
		fwrite(end, out->single ? 4 : 8, 1, out->f);
	signal_flush(out);
	if (ferror(out->f))
		die(EXIT_RUN, "%s:", out->name);
	if (out->f != stdout && fclose(out->f))
		die(EXIT_RUN, "%s:", out->name);
	free(out);
}
