#include "recording.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/text.h"
#include "cli/unit.h"
#include "io/tables.h"
#include "num/bytes.h"
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
	struct table_in *table;
	long long row; /* of the table */
	SNDFILE *sound;
	/* Frames of the sound that are announced and not read; SF_COUNT_MAX, some 1e19,
	 * less those read: none are announced. */
	double left;
	const char *name;
	struct signal_format format;
};

struct recording_out {
	enum recording_to to;
	struct signal_out *signal;
	struct table_out *table;
	SNDFILE *sound;
	FILE *file; /* that libsndfile writes; it seeks back to the header */
	int failed; /* a write failed, which libsndfile does not always report */
	int channels;
	double frame, rate;
	char *doubt; /* that of the header, or NULL */
};

/* ---- sound files ---- */

#ifdef WITH_SNDFILE
/* libsndfile seeks: the input is copied to a temporary file first. */
static FILE *put_aside(struct input *in)
{
	static char block[1 << 16];
	FILE *copy = tmpfile();
	size_t n;

	if (!copy)
		die(EXIT_RUN, "%s: no temporary file:", input_name(in));
	while ((n = input_some(in, block, sizeof block)) > 0)
		if (fwrite(block, 1, n, copy) != n)
			die(EXIT_RUN, "%s: temporary file:", input_name(in));
	if (fflush(copy) || lseek(fileno(copy), 0, SEEK_SET))
		die(EXIT_RUN, "%s: temporary file:", input_name(in));
	return copy;
}

/* Bytes of a frame, 0 if its samples are compressed. */
static double frame_bytes(const SF_INFO *info)
{
	switch (info->format & SF_FORMAT_SUBMASK) {
	case SF_FORMAT_PCM_S8:
	case SF_FORMAT_PCM_U8:
	case SF_FORMAT_ULAW:
	case SF_FORMAT_ALAW:
		return info->channels;
	case SF_FORMAT_PCM_16:
		return 2 * info->channels;
	case SF_FORMAT_PCM_24:
		return 3 * info->channels;
	case SF_FORMAT_PCM_32:
	case SF_FORMAT_FLOAT:
		return 4 * info->channels;
	case SF_FORMAT_DOUBLE:
		return 8 * info->channels;
	default:
		return 0;
	}
}

/* libsndfile reads a truncated file without an error, but notes the size of the samples
 * in its log, as in "data : 20000 (should be 11956)", or that the file is truncated.  Of
 * other types than these it notes nothing, or not always. */
static void check_whole(struct recording *r, const SF_INFO *info)
{
	/* Behind what the size stands, and how many of its bytes are no samples.  Without
	 * a chunk a truncated file is an error of reading. */
	static const struct {
		int format;
		const char *chunk;
		int head;
	} known[] = { { SF_FORMAT_WAV, "\ndata :", 0 },
		{ SF_FORMAT_WAVEX, "\ndata :", 0 },
		{ SF_FORMAT_RF64, "  Data size :", 0 }, { SF_FORMAT_W64, "\ndata :", 24 },
		{ SF_FORMAT_CAF, "\ndata :", 4 }, { SF_FORMAT_AIFF, "\n SSND :", 8 },
		{ SF_FORMAT_AU, "\n  Data Size   :", 0 },
		{ SF_FORMAT_MAT5, "Name : wavedata\n", 0 },
		{ SF_FORMAT_MAT4, "seems to be truncated", 0 },
		{ SF_FORMAT_VOC, "Seems to be a truncated", 0 },
		{ SF_FORMAT_FLAC, NULL, 0 }, { SF_FORMAT_OGG, NULL, 0 } };
	/* Recorders that cannot seek announce 2^32 - 1 bytes or, as sox does, 0x7ffff000
	 * or 0x7f000000 less a part of a frame. */
	const double streamed = 0x7effff00;
	double whole = (double)info->frames * frame_bytes(info), told, there;
	char log[1 << 14] = "";
	const char *at = NULL;
	int head = 0, type = info->format & SF_FORMAT_TYPEMASK, checked = 0, n;

	sf_command(r->sound, SFC_GET_LOG_INFO, log, sizeof log);
	if (strstr(log, "without an End-Of-Stream flag"))
		die(EXIT_RUN, "%s: the recording ends before its end mark", r->name);
	for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
		if (type != known[i].format)
			continue;
		head = known[i].head;
		at = known[i].chunk ? strstr(log, known[i].chunk) : NULL;
		at = at ? at + strlen(known[i].chunk) : NULL;
		checked = at || !known[i].chunk || type == SF_FORMAT_MAT4 ||
			  type == SF_FORMAT_VOC;
	}
	if (at && type == SF_FORMAT_MAT5 && (at = strstr(at, "Size :")))
		at += strlen("Size :");
	if (!checked) {
		r->format.doubt =
			xstrdup("whether the recording is truncated is unknown");
		warn("%s: %s", r->name, r->format.doubt);
	}
	if (at && (type == SF_FORMAT_MAT4 || type == SF_FORMAT_VOC))
		die(EXIT_RUN, "%s: the recording is truncated", r->name);
	n = at ? sscanf(at, "%lf (should be %lf)", &told, &there) : 0;
	if (n == 2 && told >= streamed) {
		told = there; /* may be padded to an even number */
		told -= fmod(whole, 2) == 1 && fmod(told, 2) == 0;
	} else if (n == 1 && !(whole > 0)) {
		return;
	}
	if (whole > 0)
		there = whole + head;
	if (n > 0 && told > there && told < 1e18)
		die(EXIT_RUN, "%s: want %.0f bytes of samples, got %.0f", r->name,
			told - head, there - head);
}

static void sound_open(struct recording *r, struct input *in)
{
	SF_INFO info = { 0 };

	r->name = input_name(in);
	r->sound = sf_open_fd(fileno(put_aside(in)), SFM_READ, &info, SF_FALSE);
	if (!r->sound)
		die(EXIT_RUN, "%s: %s", r->name, sf_strerror(NULL));
	check_whole(r, &info);
	if (info.frames == 0)
		die(EXIT_RUN, "%s: the header announces no frames", r->name);
	r->left = (double)info.frames;
	r->format.rate = info.samplerate;
	r->format.channels = info.channels;
	input_close(in);
}

static size_t sound_read(struct recording *r, double *x, size_t frames)
{
	sf_count_t n = sf_readf_double(r->sound, x, (sf_count_t)frames);

	if (sf_error(r->sound))
		die(EXIT_RUN, "%s: %s", r->name, sf_strerror(r->sound));
	r->left -= (double)n;
	if (n < (sf_count_t)frames && r->left > 0 && r->left < 1e15)
		die(EXIT_RUN, "%s: the recording ends %.0f frames before its end",
			r->name, r->left);
	return (size_t)n;
}

static sf_count_t file_length(void *context)
{
	FILE *f = ((struct recording_out *)context)->file;
	off_t here = ftello(f), end;

	if (fseeko(f, 0, SEEK_END))
		return -1;
	end = ftello(f);
	return fseeko(f, here, SEEK_SET) ? -1 : end;
}

static sf_count_t file_seek(sf_count_t offset, int whence, void *context)
{
	FILE *f = ((struct recording_out *)context)->file;

	return fseeko(f, offset, whence) ? -1 : ftello(f);
}

static sf_count_t file_read(void *bytes, sf_count_t n, void *context)
{
	return (sf_count_t)fread(
		bytes, 1, (size_t)n, ((struct recording_out *)context)->file);
}

static sf_count_t file_write(const void *bytes, sf_count_t n, void *context)
{
	struct recording_out *o = context;
	size_t put = fwrite(bytes, 1, (size_t)n, o->file);

	o->failed |= put != (size_t)n;
	return (sf_count_t)put;
}

static sf_count_t file_tell(void *context)
{
	return ftello(((struct recording_out *)context)->file);
}

static void sound_create(struct recording_out *o, const struct signal_format *format)
{
	SF_VIRTUAL_IO io = { file_length, file_seek, file_read, file_write, file_tell };
	SF_INFO info = { .samplerate = (int)format->rate, .channels = format->channels };
	char rate[NUMBER_TEXT];

	if (format->rate != info.samplerate)
		die(EXIT_RUN, "%s Hz: WAV and FLAC require a whole number of hertz",
			number_text(format->rate, rate));
	info.format = o->to == TO_WAV ? SF_FORMAT_WAV | SF_FORMAT_DOUBLE
				      : SF_FORMAT_FLAC | SF_FORMAT_PCM_24;
	if (isatty(STDOUT_FILENO))
		die(EXIT_USAGE, "a recording is not written to a terminal");
	o->file = tmpfile();
	if (!o->file)
		die(EXIT_RUN, "no temporary file:");
	o->sound = sf_open_virtual(&io, SFM_WRITE, &info, o);
	if (!o->sound)
		die(EXIT_RUN, "%d channels at %g Hz: %s", format->channels, format->rate,
			sf_strerror(NULL));
	/* without that chunk, which holds the time of day, the same input gives the same
	 * bytes */
	sf_command(o->sound, SFC_SET_ADD_PEAK_CHUNK, NULL, SF_FALSE);
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

	if (sf_close(o->sound) || fflush(o->file) || o->failed)
		die(EXIT_RUN, "the recording could not be finished: temporary file:");
	rewind(o->file);
	while ((n = fread(block, 1, sizeof block, o->file)) > 0)
		if (fwrite(block, 1, n, stdout) != n)
			die(EXIT_RUN, "standard output:");
	if (ferror(o->file))
		die(EXIT_RUN, "temporary file:");
	fclose(o->file);
}
#else
static _Noreturn void no_sound(void)
{
	die(EXIT_RUN, "built without libsndfile: WAV, FLAC and the like are not read or "
		      "written");
}

static void sound_open(struct recording *r, struct input *in)
{
	(void)r, (void)in;
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

static enum recording_from recognise(struct input *in)
{
	static const char *const sounds[] = { "RIFF", "RIFX", "fLaC", "FORM", "RF64",
		"caff", "OggS", "riff", "dns.", "Creative Voice File", "MATLAB 5.0" };

	for (size_t i = 0; i < sizeof sounds / sizeof *sounds; i++)
		if (input_begins(in, sounds[i]))
			return FROM_SOUND;
	return input_begins(in, ".snd") ? FROM_AU : FROM_TEXT;
}

/* ---- text that sigconvert wrote: a table ---- */

static char *copy(const char *text)
{
	return text ? xstrdup(text) : NULL;
}

static void table_begin(struct recording *r, struct input *in)
{
	const char *rate, *units;
	char *end;

	r->table = table_from(in);
	rate = table_key(r->table, "rate");
	r->name = table_name(r->table);
	r->format.channels = table_columns(r->table) - 1;
	if (!rate || r->format.channels < 1 || table_find(r->table, "time") != 0)
		die(EXIT_RUN,
			"%s: a table of wearpipe that holds no signal: want '# rate:', "
			"time and channels",
			r->name);
	r->format.rate = strtod(rate, &end);
	if (end == rate || *end ||
		!(r->format.rate >= RATE_LEAST && r->format.rate <= RATE_MOST))
		die(EXIT_RUN, "%s: rate '%.40s', want %g to %g", r->name, rate,
			RATE_LEAST, RATE_MOST);
	units = table_key(r->table, "units");
	if (units && strncmp(units, "s ", 2) == 0)
		r->format.units = xstrdup(units + 2);
	r->format.seed = copy(table_key(r->table, "seed"));
	r->format.filter = copy(table_key(r->table, "filter"));
	r->format.start = copy(table_key(r->table, "start"));
	r->format.doubt = copy(table_doubt(r->table));
	if (table_upstream(r->table))
		r->format.cmd = xstrdup(table_upstream(r->table));
}

static size_t table_read(struct recording *r, double *x, size_t frames)
{
	size_t n = 0;

	for (; n < frames && table_next(r->table); n++, r->row++) {
		double time = table_number(r->table, 0);

		if (!(fabs(time * r->format.rate - (double)r->row) < 0.5))
			die(EXIT_RUN, "%s: line %ld: time %g s, want %g s", r->name,
				table_line(r->table), time,
				(double)r->row / r->format.rate);
		for (int c = 0; c < r->format.channels; c++)
			*x++ = table_number(r->table, c + 1);
	}
	return n;
}

static int takes_columns(const struct recording_par *par)
{
	return par->columns || par->time || par->skip || !isnan(par->rate);
}

struct recording *recording_open(const char *path, const struct recording_par *par)
{
	struct recording *r = xcalloc(1, sizeof *r);
	struct signal_raw raw = { par->rate, par->channels };
	struct input *in = par->from == FROM_RAW ? NULL : input_open(path);

	r->from = par->from == FROM_AUTO ? recognise(in) : par->from;
	if (r->from == FROM_RAW)
		r->signal = signal_open(path, &raw);
	else if (r->from == FROM_AU)
		r->signal = signal_from(in);
	else if (r->from == FROM_SOUND)
		sound_open(r, in);
	else if (!takes_columns(par) && input_begins(in, "# stream: "))
		table_begin(r, in);
	else
		r->text = text_open(in, par);
	if (takes_columns(par) && !r->text && r->from != FROM_RAW)
		die(EXIT_USAGE, "--%s is for text",
			par->columns ? "columns"
			: par->time  ? "time"
			: par->skip  ? "skip-lines"
				     : "rate");
	if (r->text)
		r->format = *text_format(r->text);
	if (r->signal)
		r->format = *signal_format(r->signal);
	if (par->start && r->format.start && strcmp(par->start, r->format.start) != 0)
		die(EXIT_USAGE, "--start %s: the recording began at %s", par->start,
			r->format.start);
	if (par->start)
		r->format.start = xstrdup(par->start);
	return r;
}

const struct signal_format *recording_format(const struct recording *r)
{
	return &r->format;
}

const char *recording_doubt(struct recording *r)
{
	return r->table ? table_doubt(r->table) : r->format.doubt;
}

const char *recording_doubted(struct recording *r)
{
	return r->table    ? table_doubted(r->table)
	       : r->signal ? signal_doubted(r->signal)
			   : NULL;
}

size_t recording_read(struct recording *r, double *x, size_t frames)
{
	if (r->text)
		return text_read(r->text, x, frames);
	if (r->table)
		return table_read(r, x, frames);
	return r->signal ? signal_read(r->signal, x, frames) : sound_read(r, x, frames);
}

void recording_close(struct recording *r)
{
	if (r->text)
		text_close(r->text);
	if (r->table)
		table_close(r->table);
	if (r->signal)
		signal_close(r->signal);
	free(r);
}

/* ---- writing ---- */

static struct table_out *create_text(const struct signal_format *f)
{
	struct text columns = { 0 }, units = { 0 };
	const char *left = f->units ? f->units : "";
	struct table_out *t;
	char rate[NUMBER_TEXT];
	const struct {
		const char *key, *value;
	} more[] = { { "seed", f->seed }, { "filter", f->filter }, { "start", f->start },
		{ "doubtful", f->doubt } };

	text_add(&columns, "time");
	text_add(&units, "s");
	for (int c = 0; c < f->channels; c++) {
		size_t n;

		left += strspn(left, " ");
		n = strcspn(left, " ");
		text_add(&columns, " channel%d", c + 1);
		text_add(&units, " %.*s", n ? (int)n : 1, n ? left : "1");
		left += n;
	}
	t = table_create(NULL, f->cmd, units.s, columns.s);
	table_comment(t, "rate", "%s", number_text(f->rate, rate));
	for (size_t i = 0; i < sizeof more / sizeof *more; i++)
		if (more[i].value)
			table_comment(t, more[i].key, "%s", more[i].value);
	free(columns.s);
	free(units.s);
	return t;
}

struct recording_out *recording_create(
	enum recording_to to, const struct signal_format *format)
{
	struct recording_out *o = xcalloc(1, sizeof *o);

	o->to = to;
	o->channels = format->channels;
	o->rate = format->rate;
	o->doubt = copy(format->doubt);
	if (to == TO_AU)
		o->signal = signal_create(NULL, format);
	else if (to == TO_WAV || to == TO_FLAC)
		sound_create(o, format);
	else if (to == TO_RAW && isatty(STDOUT_FILENO))
		die(EXIT_USAGE, "a recording is not written to a terminal");
	if (to == TO_TEXT)
		o->table = create_text(format);
	return o;
}

static void put_text(struct recording_out *o, const double *x)
{
	table_put(o->table, o->frame++ / o->rate);
	table_put_row(o->table, x, o->channels);
}

static void put_raw(const double *x, size_t n)
{
	unsigned char bytes[8];

	for (size_t i = 0; i < n; i++) {
		bytes_put_double_little(bytes, x[i]);
		if (fwrite(bytes, 1, 8, stdout) != 8)
			die(EXIT_RUN, "standard output:");
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

int recording_state(struct recording_out *o, const char *doubt)
{
	if ((o->to == TO_AU || o->to == TO_TEXT) && o->doubt && !strcmp(o->doubt, doubt))
		return 1;
	if (o->to == TO_TEXT)
		table_comment(o->table, "doubtful", "%s", doubt);
	return o->to == TO_TEXT;
}

void recording_done(struct recording_out *o)
{
	if (o->to == TO_AU)
		signal_done(o->signal);
	if (o->table)
		table_done(o->table);
	if (o->to == TO_WAV || o->to == TO_FLAC)
		sound_done(o);
	if (ferror(stdout))
		die(EXIT_RUN, "standard output:");
	free(o->doubt);
	free(o);
}
