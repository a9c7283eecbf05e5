#include "report.h"
#include "signal/separate/early.h"
#include "signal/separate/sizing.h"
#include <math.h>
#include <stdlib.h>
#include <wearpipe/separate.h>

struct wp_separate {
	struct early *early;
	struct wp_separate_par par;
	const char *reason;
};

static double or_nan(double x)
{
	return x > 0 ? x : NAN;
}

struct wp_separate *wp_separate_new(
	const struct wp_separate_par *par, enum wp_status *status)
{
	const double *all[] = { &par->delay, &par->pulse_duration, &par->gain,
		&par->spacing, &par->calibration, &par->false_alarm, &par->learn };
	struct separate_par inner = { .method = SEPARATE_FIT, .rate = par->rate };
	struct wp_separate *s;

	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		if (!(*all[i] >= 0) || isinf(*all[i]))
			return report(status, WP_DOMAIN);
	if (!(par->rate > 0) || isinf(par->rate) || par->false_alarm > 0.01 ||
		!(par->learn * par->rate < 1e15))
		return report(status, WP_DOMAIN);
	s = calloc(1, sizeof *s);
	if (!s)
		return report(status, WP_NO_MEMORY);
	s->par = *par;
	s->reason = "";
	if (par->spacing == 0)
		s->par.spacing = 0.25;
	if (par->calibration == 0)
		s->par.calibration = M_PI / 4 * 1e11;
	inner.learn = (size_t)(par->learn * par->rate);
	if (par->learn > 0 && inner.learn == 0)
		inner.learn = 1;
	inner.known = (struct calibrate_par){ .lag = or_nan(par->delay * par->rate),
		.duration = or_nan(par->pulse_duration * par->rate),
		.gain = or_nan(par->gain),
		.pulse = CALIBRATE_ANY_PULSE,
		.spread = NAN,
		.false_alarm = par->false_alarm > 0 ? par->false_alarm : 1e-9,
		.tones = CALIBRATE_FIND_TONES };
	s->early = early_new(&inner);
	if (!s->early) {
		free(s);
		return report(status, WP_NO_MEMORY);
	}
	report(status, WP_OK);
	return s;
}

void wp_separate_free(struct wp_separate *s)
{
	if (s)
		early_free(s->early);
	free(s);
}

static enum wp_status outcome(struct wp_separate *s, enum separate_status status)
{
	static const char *const why[] = {
		[SEPARATE_OK] = "",
		[SEPARATE_MEMORY] = "out of memory",
		[SEPARATE_SHORT] = "fewer than 64 frames",
		[SEPARATE_NOT_FINITE] = "a sample is not a finite number",
		[SEPARATE_SILENT_1] = "channel 1 is constant: a dead sensor",
		[SEPARATE_SILENT_2] = "channel 2 is constant: a dead sensor",
		[SEPARATE_NO_LAG] =
			"channels with nothing in common: no particle, or give the delay",
		[SEPARATE_SWAPPED] = "pulses reach channel 2 first",
		[SEPARATE_FAR] = "the delay is as long as what is learned from",
		[SEPARATE_HARD] = "not described by a reasonable number of pulses",
		[SEPARATE_AT_ONCE] = "both channels have the same at once",
		[SEPARATE_NARROW] = "a filter has left too narrow a band",
		[SEPARATE_FAST] = "no pulse of at least 8 samples",
		[SEPARATE_SLOW] = "pulses as long as what is learned from",
		[SEPARATE_TONES] = "lines too near each other",
		[SEPARATE_WINDOW] = "a window shorter than half a pulse",
		[SEPARATE_WIDE] = "transit times too far apart",
	};

	s->reason = why[status];
	switch (status) {
	case SEPARATE_OK:
		return WP_OK;
	case SEPARATE_MEMORY:
		return WP_NO_MEMORY;
	case SEPARATE_NOT_FINITE:
		return WP_NUMBERS;
	case SEPARATE_NO_LAG:
		return WP_NOT_CONVERGED;
	default:
		return WP_IMPOSSIBLE;
	}
}

enum wp_status wp_separate_push(struct wp_separate *s, const double *x, size_t frames)
{
	return outcome(s, early_push(s->early, x, frames));
}

enum wp_status wp_separate_end(struct wp_separate *s)
{
	enum wp_status status = outcome(s, early_end(s->early));

	enum separate_doubt doubt = separate_doubtful(renewal_now(early_whole(s->early)));

	if (status != WP_OK && status != WP_NOT_CONVERGED)
		return status;
	if (doubt == SEPARATE_UNEXPLAINED)
		s->reason = "a channel stands out of its noise, but they have nothing in "
			    "common";
	else if (doubt == SEPARATE_COVERED)
		s->reason = "events that are no particles hide some of them";
	else if (doubt == SEPARATE_LINES)
		s->reason =
			"what interfering lines leave is taken for noise: particles may "
			"be missing";
	else if (doubt == SEPARATE_WIDTHS)
		s->reason =
			"widths of pulses differ by more than those of particles: they may "
			"be bubbles";
	else if (doubt == SEPARATE_UNLIKE)
		s->reason = "what is unresolved differs from the pulse in spectrum";
	else if (doubt == SEPARATE_COUNTLESS)
		s->reason = "number and size of what is unresolved are not known";
	else if (doubt == SEPARATE_UNLEARNED)
		s->reason = "particles may be lost before the instrument was learned";
	else if (doubt)
		s->reason = "many pulses fit no particle (misfit): the others are "
			    "doubtful, too";
	return doubt ? WP_NOT_CONVERGED : status;
}

int wp_separate_next(struct wp_separate *s, struct wp_transit *p)
{
	struct transit t;
	struct sizing z;

	if (!early_next(s->early, &t))
		return 0;
	sizing_of(&t, s->par.rate, s->par.spacing, s->par.calibration, &z);
	*p = (struct wp_transit){ z.time[0], z.time[1], z.diameter, z.amplitude, z.delay,
		z.velocity, z.time_se[0], z.time_se[1], z.diameter_se, z.amplitude_se,
		z.delay_se, z.velocity_se, (double)t.section, t.sources, t.chi2,
		(int)t.verdict, z.most };
	return 1;
}

const char *wp_separate_reason(const struct wp_separate *s)
{
	return s->reason;
}
