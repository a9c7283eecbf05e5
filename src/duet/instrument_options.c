#include "instrument_options.h"
#include "cli/msg.h"
#include "io/tables.h"
#include "signal/filter/fir.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct instrument_given instrument = { .false_alarm = 1e-9 };

static const char *const automatic[] = { "auto", NULL };

struct opt instrument_rows[] = {
	OPT_HEADING("Instrument, where it is known"),
	{ 0, "pulse", OPT_WORD, UNIT_NONE, &instrument.pulse, 0, 0, "auto|" PULSE_WORDS,
		"shape of a pulse", pulse_names, 0 },
	{ 0, "pulse-duration", OPT_CHOICE, UNIT_TIME, &instrument.duration, 1e-12, 1e9,
		"auto|T", "duration of a pulse of the mean particle", automatic, 0 },
	{ 0, "gain", OPT_CHOICE, UNIT_NONE, &instrument.gain, 1e-6, 1e6, "auto|G",
		"ratio of the gains of sensor 2 and sensor 1", automatic, 0 },
	{ 0, "lines", OPT_LIST, UNIT_FREQUENCY, &instrument.lines, 0, 1e12, "F,F,...",
		"interfering lines to fit (0: none) instead of those found", 0, 0 },
	{ 0, "false-alarm", OPT_NUM, UNIT_NONE, &instrument.false_alarm, 1e-15, 0.01, "P",
		"false particles per sample of noise", 0, 0 },
	{ 0, "spread", OPT_CHOICE, UNIT_FRACTION, &instrument.spread, 0, 0.9, "auto|S",
		"transit times within this share of --align", automatic, 0 },
	{ 0, "undo", OPT_TEXT, UNIT_NONE, &instrument.undo, 0, 0, "auto|none|FILE",
		"taps of the filter the record has passed (auto: as it says itself)", 0,
		0 },
	OPT_END,
};

static double number(const struct opt_choice *c)
{
	return c->word < 0 ? c->value : NAN;
}

double instrument_align(void)
{
	return number(&instrument.align);
}

/* Convolves a[0..*n) with b[0..m) of another filter; NULL is no filter. */
static double *cascade(double *a, size_t *n, double *b, size_t m)
{
	double *both;

	if (!a) {
		*n = m;
		return b;
	}
	both = xcalloc(*n + m - 1, sizeof *both);
	for (size_t i = 0; i < *n; i++)
		for (size_t k = 0; k < m; k++)
			both[i + k] += a[i] * b[k];
	free(a);
	free(b);
	*n += m - 1;
	return both;
}

/* Taps of the filters named in the header of the record. */
static double *filter_passed(const char *text, double rate, size_t *n)
{
	double *taps = NULL;

	while (*text) {
		struct fir_band band;
		const char *rest = fir_parse(text, rate, &band);
		double *one;

		if (!rest) {
			warn("a filter that is not known: '%s'", text);
			free(taps);
			return NULL;
		}
		one = xcalloc((size_t)band.order + 1, sizeof *one);
		fir_design(&band, one);
		taps = cascade(taps, n, one, (size_t)band.order + 1);
		text = rest;
	}
	return taps;
}

/* Column tap of a table, as bpfilter --taps writes it. */
static double *read_taps(const char *path, size_t *n)
{
	struct table_in *t = table_open(path);
	int column = table_need(t, "tap");
	double *taps = NULL, most = 0;

	*n = 0;
	while (table_next(t)) {
		taps = xrealloc(taps, *n + 1, sizeof *taps);
		taps[(*n)++] = table_number(t, column);
		if (!isfinite(taps[*n - 1]))
			die(EXIT_RUN, "%s: line %ld: tap is not a finite number", path,
				table_line(t));
		most = fmax(most, fabs(taps[*n - 1]));
	}
	for (size_t i = 0; i < *n / 2; i++)
		if (fabs(taps[i] - taps[*n - 1 - i]) > 1e-6 * fabs(taps[*n / 2]))
			die(EXIT_RUN,
				"%s: tap %zu is not equal to tap %zu from the end: want a "
				"filter of linear phase",
				path, i + 1, i + 1);
	if (*n == 0)
		die(EXIT_RUN, "%s: no taps", path);
	if (!(most > 1e-100 && most < 1e100)) /* its square must be a number, too */
		die(EXIT_RUN, "%s: the largest tap is %g: nothing to undo", path, most);
	table_close(t);
	return taps;
}

static double *known_filter(const char *passed, double rate, size_t *n)
{
	const char *given = instrument.undo;

	*n = 0;
	if (given && strcmp(given, "none") == 0)
		return NULL;
	if (given && strcmp(given, "auto") != 0)
		return read_taps(given, n);
	return passed ? filter_passed(passed, rate, n) : NULL;
}

struct calibrate_par instrument_par(double rate, const char *passed)
{
	const struct opt_list *lines = &instrument.lines;
	struct calibrate_par par = { .lag = instrument_align() * rate,
		.duration = number(&instrument.duration) * rate,
		.gain = number(&instrument.gain),
		.pulse = instrument.pulse - 1,
		.spread = number(&instrument.spread),
		.false_alarm = instrument.false_alarm,
		.tones = CALIBRATE_FIND_TONES };

	par.filter = known_filter(passed, rate, &par.filter_taps);
	if (lines->n > TONES_MAX)
		die(EXIT_USAGE, "--lines: at most %d", TONES_MAX);
	if (lines->n)
		par.tones = 0;
	for (int i = 0; i < lines->n; i++) {
		if (lines->v[i] > rate / 2)
			die(EXIT_RUN, "--lines: %g Hz is above half the rate, %g Hz",
				lines->v[i], rate / 2);
		if (lines->v[i] > 0)
			par.omega[par.tones++] = 2 * M_PI * lines->v[i] / rate;
	}
	return par;
}

void instrument_note(const struct calibration *c, double rate)
{
	note("align %g s, pulse %s%s of %g s%s%s, gain %g, width %g, crosstalk %g and %g, noise %g and %g V, %d lines, learned from "
	     "%d pulses",
		(double)c->shift / rate, pulse_names[c->pulse + 1],
		c->reversed ? ", reversed," : "", c->duration / rate,
		c->measured ? ", taken from the record" : "",
		c->corrected ? ", corrected" : "", c->gain, c->width, c->crosstalk[0],
		c->crosstalk[1], c->noise[0], c->noise[1], c->tones, c->events);
}
