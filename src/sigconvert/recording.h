/* recording.h - signals in the formats of other programs
 *
 * Text: one row per frame, cells separated by TAB, semicolon, comma or blanks; with any
 * but commas decimal commas are read, too.  Text written by sigconvert is a table that
 * states rate, units, start, seed and filters and has an end line.  Raw: little-endian
 * float64, interleaved.  Sound: the formats of libsndfile, if the program was built with
 * it.
 */
#ifndef RECORDING_H
#define RECORDING_H

#include "io/input.h"
#include "io/signals.h"
#include <stddef.h>

#define RATE_LEAST 1e-9
#define RATE_MOST 2e9

enum recording_from { FROM_AUTO, FROM_AU, FROM_TEXT, FROM_RAW, FROM_SOUND };
enum recording_to { TO_AU, TO_TEXT, TO_RAW, TO_WAV, TO_FLAC };

struct recording_par {
	enum recording_from from;
	double rate; /* Hz; nan: unknown */
	int channels;
	const char *columns, *time; /* headings; NULL: all, "time" or "t" */
	const char *start;          /* moment of the first sample; NULL: not told */
	long skip;                  /* lines before the heading */
	int table; /* text is for a table: there is no rate, and NAME=HEADING renames */
};

struct recording;
struct recording_out;

/* All of them die if the file is invalid. */
struct recording *recording_open(const char *path, const struct recording_par *par);
const struct signal_format *recording_format(const struct recording *r);
size_t recording_read(struct recording *r, double *x, size_t frames);
/* Why what has been read so far is doubtful by its own account; NULL: it is not.  Valid
 * until the next call. */
const char *recording_doubt(struct recording *r);
const char *recording_doubted(struct recording *r); /* the same with a warning */
void recording_close(struct recording *r);

struct recording_out *recording_create(
	enum recording_to to, const struct signal_format *format);
/* Returns the samples beyond full scale, which the format cuts off. */
double recording_write(struct recording_out *o, const double *x, size_t frames);
/* At the end: whether the output states the doubt, in its header or now. */
int recording_state(struct recording_out *o, const char *doubt);
void recording_done(struct recording_out *o);

/* Text, for recording.c. */
struct text_in;
struct text_in *text_open(struct input *in, const struct recording_par *par);
const struct signal_format *text_format(const struct text_in *t);
/* Writes all rows to a table on standard output; returns their number. */
double text_to_table(struct text_in *t, const char *start);
size_t text_read(struct text_in *t, double *x, size_t frames);
void text_close(struct text_in *t);

#endif
