/* signals.h - streams of multi-channel signals: Sun AU
 *
 * Writes 64-bit float big-endian of unknown length, so that it streams; reads 8, 16,
 * 24, 32-bit PCM (scaled to +-1), float and double, and headerless little-endian
 * float64 when a raw layout is given.  Frames are interleaved: x[frame * channels + c].
 */
#ifndef IO_SIGNALS_H
#define IO_SIGNALS_H

#include "io/input.h"
#include <stddef.h>

struct signal_format {
	double rate; /* frames per second, Hz */
	int channels;
	int single;   /* writer: 32-bit float */
	char *cmd;    /* pipeline that made it; NULL if unknown */
	char *units;  /* one per channel, "V V"; NULL if unknown */
	char *seed;   /* NULL if none */
	char *filter; /* linear-phase filters applied, as printed by fir_print(),
			 separated by " | "; NULL if none */
	char *start;  /* moment of the first frame, ISO 8601; NULL if unknown */
	char *doubt;  /* why what it shows is doubtful; NULL if it is not */
};

struct signal_raw {
	double rate; /* Hz */
	int channels;
};

struct signal_in;
struct signal_out;

struct signal_in *signal_open(const char *path, const struct signal_raw *raw);
struct signal_in *signal_from(struct input *in); /* takes ownership of an open input */
/* 1 if it promises an end or declares its length. */
int signal_marked(const struct signal_in *in);
const struct signal_format *signal_format(const struct signal_in *in);
const char *signal_name(const struct signal_in *in);
/* Reads up to nframes frames; blocks until it has that many or the input ends.  Returns
 * the number of frames, 0 at the end.  If a stream ends too early its complete frames are
 * returned; the next call, signal_close() or the end of an output dies.  Samples may be
 * nan; the caller checks them. */
size_t signal_read(struct signal_in *in, double *x, size_t nframes);
/* The same, but returns as soon as at least one frame is available. */
size_t signal_read_some(struct signal_in *in, double *x, size_t nframes);
/* Why it is doubtful, with a warning; NULL if it is not. */
const char *signal_doubted(const struct signal_in *in);
void signal_close(struct signal_in *in);

/* path NULL is standard output, which must not be a terminal. */
struct signal_out *signal_create(const char *path, const struct signal_format *format);
void signal_write(struct signal_out *out, const double *x, size_t nframes);
void signal_flush(struct signal_out *out);
/* Writes the end and checks that all was written; frees. */
void signal_done(struct signal_out *out);

#endif
