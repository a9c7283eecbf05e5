#include "instrument.h"
#include "shell/msg.h"
#include <math.h>

struct instrument instrument = { .false_alarm = 1e-9 };

static const char *const pulses[] = { "auto", "sine", "gauss", "lorentz", NULL };
static const char *const automatic[] = { "auto", NULL };

struct opt instrument_rows[] = { { 'p', "shape", OPT_WORD, UNIT_NONE, &instrument.pulse,
					 0, 0, "auto|sine|gauss|lorentz",
					 "shape of a pulse", pulses, 0 },
	{ 't', "pulse-duration", OPT_CHOICE, UNIT_TIME, &instrument.duration, 1e-12, 1e9,
		"auto|T", "duration of a pulse of the mean particle", automatic, 0 },
	{ 'g', "gain", OPT_CHOICE, UNIT_NONE, &instrument.gain, 1e-6, 1e6, "auto|G",
		"of sensor 2 over sensor 1", automatic, 0 },
	{ 'l', "lines", OPT_LIST, UNIT_FREQUENCY, &instrument.lines, 0, 1e12, "F,F,...",
		"interfering lines to fit (0: none) instead of those found", 0, 0 },
	{ 'A', "false-alarm", OPT_NUM, UNIT_NONE, &instrument.false_alarm, 1e-15, 0.01,
		"P", "false particles per sample of noise", 0, 0 },
	{ 'x', "spread", OPT_CHOICE, UNIT_FRACTION, &instrument.spread, 0, 0.9, "auto|S",
		"transit times within this share of --align", automatic, 0 },
	OPT_END };

static double number(const struct opt_choice *c)
{
	return c->word < 0 ? c->value : NAN;
}

double instrument_align(void)
{
	return number(&instrument.align);
}

struct calibrate_par instrument_par(double rate)
{
	const struct opt_list *lines = &instrument.lines;
	struct calibrate_par par = { .lag = instrument_align() * rate,
		.duration = number(&instrument.duration) * rate,
		.gain = number(&instrument.gain),
		.pulse = instrument.pulse - 1,
		.spread = number(&instrument.spread),
		.false_alarm = instrument.false_alarm,
		.tones = CALIBRATE_FIND_TONES };

	if (lines->n > TONES_MAX)
		die(EXIT_USAGE, "--lines: at most %d", TONES_MAX);
	if (lines->n)
		par.tones = 0;
	for (int i = 0; i < lines->n; i++) {
		if (lines->v[i] > rate / 2)
			die(EXIT_RUN, "--lines: %g Hz is above half the rate, %g Hz",
				lines->v[i], rate / 2);
		if (lines->v[i] > 0)
			par.omega[par.tones++] = 2 * acos(-1) * lines->v[i] / rate;
	}
	return par;
}

void instrument_note(const struct calibration *c, double rate)
{
	note("align %g s, pulse %s of %g s, gain %g, noise %g and %g V, %d lines, learned from "
	     "%d pulses",
		(double)c->shift / rate, pulses[c->pulse + 1], c->duration / rate,
		c->gain, c->noise[0], c->noise[1], c->tones, c->events);
}
