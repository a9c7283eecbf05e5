#include "io/kinds.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include <string.h>

static const char converted[] = ": sigconvert converts it";

static const struct {
	const char *begin;
	enum stream_kind kind;
	const char *text;
	const char *hint;
} kinds[] = {
	{ "NRRD000", KIND_FIELD, "a field (NRRD)", "" },
	{ "Gwyddion Simple Field", KIND_FIELD, "a field (GSF)", "" },
	{ ".snd", KIND_SIGNAL, "a signal (AU)", "" },
	{ "RIFF", KIND_OTHER, "WAV audio", converted },
	{ "fLaC", KIND_OTHER, "FLAC audio", converted },
	{ "\x1f\x8b", KIND_OTHER, "compressed by gzip", ": gunzip first" },
	{ "PK\x03\x04", KIND_OTHER, "a zip archive", ": surfunzip reads .x3p and .plux" },
	{ "\x93NUMPY", KIND_OTHER, "a numpy array", ": surfimport converts heights" },
	{ "\x89PNG", KIND_OTHER, "a picture", "" },
	{ "GIF8", KIND_OTHER, "a picture", "" },
	{ "%PDF", KIND_OTHER, "a PDF document", "" },
};

/* Text up to the first newline, or all of it. */
static int is_text(const unsigned char *b, size_t n)
{
	for (size_t i = 0; i < n && b[i] != '\n'; i++)
		if ((b[i] < ' ' && b[i] != '\t' && b[i] != '\r') || b[i] == 127)
			return 0;
	return n > 0;
}

void kind_refuse(const char *name, const void *bytes, size_t n, enum stream_kind wanted)
{
	const char *text = NULL, *hint = "";
	enum stream_kind kind = KIND_OTHER;

	for (size_t i = 0; !text && i < sizeof kinds / sizeof *kinds; i++) {
		size_t length = strlen(kinds[i].begin);

		if (n >= length && memcmp(bytes, kinds[i].begin, length) == 0) {
			kind = kinds[i].kind;
			text = kinds[i].text;
			hint = kinds[i].hint;
		}
	}
	if (!text && is_text(bytes, n)) {
		kind = KIND_TABLE;
		text = "text";
		hint = wanted == KIND_SIGNAL  ? converted
		       : wanted == KIND_FIELD ? ": surfimport converts heights"
					      : "";
	}
	if (text && kind != wanted)
		die(EXIT_RUN, "%s: this is %s, want %s%s", name, text, opt_reads(), hint);
}
