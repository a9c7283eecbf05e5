#include "recording.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/unit.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifdef WITH_SNDFILE
#include <sndfile.h>
#else
typedef struct no_sndfile SNDFILE;
#endif

struct recording {
	enum recording_from from;
	struct signal_in *signal;
	struct text_in *text;
	SNDFILE *sound;
	const char *name;
	struct signal_format format;
};

struct recording_out {
	enum recording_to to;
	struct signal_out *signal;
	SNDFILE *sound;
	FILE *file; /* that libsndfile writes, which goes back to its header */
	int channels;
	double frame, rate;
};

/* ---- sound files ---- */

#ifdef WITH_SNDFILE
/* libsndfile seeks: what comes through a pipe is put aside first. */
static FILE *seekable(FILE *f, const char *name)
{
	static char block[1 << 16];
	FILE *copy;
	size_t n;

	if (fseeko(f, 0, SEEK_END) == 0 && fseeko(f, 0, SEEK_SET) == 0)
		return f;
	copy = tmpfile();
	if (!copy)
		die(EXIT_RUN, "%s: no temporary file:", name);
	while ((n = fread(block, 1, sizeof block, f)) > 0)
		if (fwrite(block, 1, n, copy) != n)
			die(EXIT_RUN, "%s: temporary file:", name);
	if (ferror(f) || fflush(copy) || fseeko(copy, 0, SEEK_SET))
		die(EXIT_RUN, "%s:", name);
	return copy;
}

static void sound_open(struct recording *r, const char *path)
{
	SF_INFO info = { 0 };
	FILE *f = seekable(file_open(path, &r->name), r->name);

	lseek(fileno(f), 0, SEEK_SET);
	r->sound = sf_open_fd(fileno(f), SFM_READ, &info, SF_FALSE);
	if (!r->sound)
		die(EXIT_RUN, "%s: %s", r->name, sf_strerror(NULL));
	r->format.rate = info.samplerate;
	r->format.channels = info.channels;
}

static size_t sound_read(struct recording *r, double *x, size_t frames)
{
	sf_count_t n = sf_readf_double(r->sound, x, (sf_count_t)frames);

	if (sf_error(r->sound))
		die(EXIT_RUN, "%s: %s", r->name, sf_strerror(r->sound));
	return (size_t)n;
}

static void sound_create(struct recording_out *o, const struct signal_format *format)
{
	SF_INFO info = { .samplerate = (int)format->rate, .channels = format->channels };

	info.format = o->to == TO_WAV ? SF_FORMAT_WAV | SF_FORMAT_DOUBLE
				      : SF_FORMAT_FLAC | SF_FORMAT_PCM_24;
	if (isatty(STDOUT_FILENO))
		die(EXIT_USAGE, "a recording is not written to a terminal");
	o->file = tmpfile();
	if (!o->file)
		die(EXIT_RUN, "no temporary file:");
	o->sound = sf_open_fd(fileno(o->file), SFM_WRITE, &info, SF_FALSE);
	if (!o->sound)
		die(EXIT_RUN, "%d channels at %ld Hz: %s", format->channels, format->rate,
			sf_strerror(NULL));
	sf_command(o->sound, SFC_SET_CLIPPING, NULL, SF_TRUE);
}

static double sound_write(struct recording_out *o, const double *x, size_t frames)
{
	double clipped = 0;

	for (size_t i = 0; o->to == TO_FLAC && i < frames * (size_t)o->channels; i++) {
		if (isnan(x[i]))
			die(EXIT_RUN, "a missing sample cannot be written to FLAC");
		clipped += fabs(x[i]) > 1;
	}
	if (sf_writef_double(o->sound, x, (sf_count_t)frames) != (sf_count_t)frames)
		die(EXIT_RUN, "%s", sf_strerror(o->sound));
	return clipped;
}

static void sound_done(struct recording_out *o)
{
	static char block[1 << 16];
	size_t n;

	if (sf_close(o->sound))
		die(EXIT_RUN, "the recording could not be finished");
	rewind(o->file);
	while ((n = fread(block, 1, sizeof block, o->file)) > 0)
		if (fwrite(block, 1, n, stdout) != n)
			die(EXIT_RUN, "standard output:");
	fclose(o->file);
}
#else
static _Noreturn void no_sound(void)
{
	die(EXIT_RUN, "built without libsndfile: WAV, FLAC and the like are not read or "
		      "written");
}

static void sound_open(struct recording *r, const char *path)
{
	(void)r, (void)path;
	no_sound();
}

static size_t sound_read(struct recording *r, double *x, size_t frames)
{
	(void)r, (void)x, (void)frames;
	no_sound();
}

static void sound_create(struct recording_out *o, const struct signal_format *format)
{
	(void)o, (void)format;
	no_sound();
}

static double sound_write(struct recording_out *o, const double *x, size_t frames)
{
	(void)o, (void)x, (void)frames;
	no_sound();
}

static void sound_done(struct recording_out *o)
{
	(void)o;
	no_sound();
}
#endif

/* ---- reading ---- */

/* By the first bytes of a file; a pipe cannot be looked into and is AU. */
static enum recording_from recognise(const char *path)
{
	static const char *const sounds[] = { "RIFF", "fLaC", "FORM", "RF64", "caff",
		"OggS" };
	char magic[4] = "";
	FILE *f;
	size_t n;

	if (!path || strcmp(path, "-") == 0 || !(f = fopen(path, "rb")))
		return FROM_AU;
	n = fread(magic, 1, 4, f);
	fclose(f);
	for (size_t i = 0; n == 4 && i < sizeof sounds / sizeof *sounds; i++)
		if (memcmp(magic, sounds[i], 4) == 0)
			return FROM_SOUND;
	return n == 4 && memcmp(magic, ".snd", 4) == 0 ? FROM_AU : FROM_TEXT;
}

struct recording *recording_open(const char *path, const struct recording_par *par)
{
	struct recording *r = xcalloc(1, sizeof *r);
	struct signal_raw raw = { isnan(par->rate) ? 0 : (long)par->rate, par->channels };

	r->from = par->from == FROM_AUTO ? recognise(path) : par->from;
	if (r->from == FROM_TEXT) {
		r->text = text_open(path, par);
		r->format = *text_format(r->text);
	} else if (r->from == FROM_SOUND) {
		sound_open(r, path);
	} else {
		r->signal = signal_open(path, r->from == FROM_RAW ? &raw : NULL);
		r->format = *signal_format(r->signal);
	}
	return r;
}

const struct signal_format *recording_format(const struct recording *r)
{
	return &r->format;
}

size_t recording_read(struct recording *r, double *x, size_t frames)
{
	if (r->text)
		return text_read(r->text, x, frames);
	return r->signal ? signal_read(r->signal, x, frames) : sound_read(r, x, frames);
}

void recording_close(struct recording *r)
{
	if (r->text)
		text_close(r->text);
	if (r->signal)
		signal_close(r->signal);
	free(r);
}

/* ---- writing ---- */

struct recording_out *recording_create(
	enum recording_to to, const struct signal_format *format)
{
	struct recording_out *o = xcalloc(1, sizeof *o);

	o->to = to;
	o->channels = format->channels;
	o->rate = (double)format->rate;
	if (to == TO_AU)
		o->signal = signal_create(NULL, format);
	else if (to == TO_WAV || to == TO_FLAC)
		sound_create(o, format);
	else if (to == TO_RAW && isatty(STDOUT_FILENO))
		die(EXIT_USAGE, "a recording is not written to a terminal");
	if (to == TO_TEXT) {
		if (format->cmd)
			printf("# cmd: %s\n", format->cmd);
		printf("# rate: %ld\ntime", format->rate);
		for (int c = 0; c < o->channels; c++)
			printf("\tchannel%d", c + 1);
		putchar('\n');
	}
	return o;
}

static void put_text(struct recording_out *o, const double *x)
{
	char text[NUMBER_TEXT];

	fputs(number_text(o->frame++ / o->rate, text), stdout);
	for (int c = 0; c < o->channels; c++)
		printf("\t%s", number_text(x[c], text));
	putchar('\n');
}

static void put_raw(const double *x, size_t n)
{
	for (size_t i = 0; i < n; i++) {
		unsigned long long bits;
		unsigned char byte[8];

		memcpy(&bits, &x[i], sizeof bits);
		for (int k = 0; k < 8; k++)
			byte[k] = (unsigned char)(bits >> 8 * k);
		fwrite(byte, 1, 8, stdout);
	}
}

double recording_write(struct recording_out *o, const double *x, size_t frames)
{
	size_t c = (size_t)o->channels;

	if (o->to == TO_AU)
		signal_write(o->signal, x, frames);
	else if (o->to == TO_RAW)
		put_raw(x, frames * c);
	else if (o->to == TO_TEXT)
		for (size_t i = 0; i < frames; i++)
			put_text(o, x + i * c);
	else
		return sound_write(o, x, frames);
	return 0;
}

void recording_done(struct recording_out *o)
{
	if (o->to == TO_AU)
		signal_done(o->signal);
	if (o->to == TO_WAV || o->to == TO_FLAC)
		sound_done(o);
	if (ferror(stdout))
		die(EXIT_RUN, "standard output:");
	free(o);
}
