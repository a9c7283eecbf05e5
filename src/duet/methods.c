#include "methods.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "components.h"
#include "instrument_file.h"
#include "instrument_options.h"
#include "signal/separate/early.h"
#include <math.h>
#include <stdlib.h>
#include <unistd.h>

enum { BLOCK = 4096 };

static void check_status(
	enum separate_status status, const struct separate *s, const char *name)
{
	static const char *const why[] = {
		[SEPARATE_MEMORY] = "no memory",
		[SEPARATE_SHORT] = "want at least 64 frames to learn from",
		[SEPARATE_SILENT_1] = "sensor 1 is constant: a dead sensor",
		[SEPARATE_SILENT_2] = "sensor 2 is constant: a dead sensor",
		[SEPARATE_AT_ONCE] =
			"both channels have the same at once: shocks or crosstalk, no "
			"particles; give --align 0 if they are aligned",
		[SEPARATE_SWAPPED] = "pulses reach channel 2 first: the sensors are "
				     "swapped, or the oil flows backwards",
		[SEPARATE_HARD] = "what it is learned from is not described by a "
				  "reasonable number of pulses",
		[SEPARATE_FAR] = "--align is as long as what is learned from: --learn "
				 "from more of the record",
		[SEPARATE_NARROW] = "the filter it has passed leaves too narrow a band "
				    "to tell pulses",
		[SEPARATE_FAST] = "no pulse of at least 8 samples found: give "
				  "--pulse-duration or sample faster",
		[SEPARATE_SLOW] = "pulses as long as the record: --learn from more of it",
		[SEPARATE_TONES] =
			"--lines: too many, or too near each other, to be told "
			"apart in so short a record",
		[SEPARATE_WIDE] = "the transit times lie too far apart: give a smaller "
				  "--spread",
	};
	int channel;
	long long frame = separate_bad_sample(s, &channel);

	if (status == SEPARATE_NOT_FINITE)
		die(EXIT_RUN, "%s: channel %d, frame %lld: not a finite number", name,
			channel + 1, frame);
	if (status == SEPARATE_NO_LAG && !separate_doubtful(s))
		warn("%s: nothing in common of both channels to learn from: no particle, or "
		     "give --align and --pulse-duration",
			name);
	else if (status == SEPARATE_WINDOW)
		die(EXIT_RUN,
			"%s: pulses of %.0f samples want a --window of at least half of that",
			name, separate_calibration(s)->duration);
	else if (status != SEPARATE_OK && status != SEPARATE_NO_LAG)
		die(EXIT_RUN, "%s: %s", name, why[status]);
}

static void report(const struct separate *s, double rate)
{
	double ratio = separate_ratio(s);
	const struct separate_counters *c = separate_counters(s);
	const struct calibration *known = separate_calibration(s);

	stats_set("samples", ratio * c->samples);
	stats_set("samples_missing", ratio * (c->missing[0] + c->missing[1]));
	stats_set("samples_passed_over", ratio * c->passed_over);
	stats_set("samples_active", ratio * c->active);
	stats_set("sections", c->sections);
	stats_set("sections_single", c->singles);
	stats_set("sections_unresolved", c->unresolved);
	stats_set("misfits", c->misfits);
	stats_set("together", c->together);
	stats_set("reversed", c->negative);
	stats_set("misfits_by_velocity", c->foreign);
	stats_set("shocks", c->events[SEPARATE_SHOCK]);
	stats_set("bubbles", c->events[SEPARATE_BUBBLE]);
	stats_set("impulses", c->events[SEPARATE_IMPULSE]);
	stats_set("transients", c->events[SEPARATE_TRANSIENT]);
	stats_set("fits", c->fits);
	stats_set("fit_steps", c->steps);
	stats_set("searches", c->searches);
	stats_set("demixings", c->masks);
	stats_set("demixings_skipped", c->masks_skipped);
	stats_set("calibrations", known ? known->attempts : 0);
	if (known)
		instrument_note(known, rate / ratio);
}

static void tell_polarity(const struct separate *s, const char *name)
{
	const struct calibration *known = separate_calibration(s);

	if (known && known->gain < 0)
		warn("%s: the pulses of channel 2 have the sign opposite to those of "
		     "channel 1: the channel is negated",
			name);
}

static int put_ready(struct early *e, struct found *out)
{
	struct transit p;
	int any = 0;

	for (; early_next(e, &p); any = 1)
		found_particle(out, &p);
	return any;
}

/* Why the record is doubtful. */
static char *reason(
	const struct separate *s, enum separate_doubt doubt, const struct found *out)
{
	const struct separate_counters *c = separate_counters(s);
	double share[2];

	switch (doubt) {
	case SEPARATE_BELIEVED:
		return NULL;
	case SEPARATE_FOREIGN:
		return xprintf("%.0f of %.0f rows fit no particle", separate_misfits(c),
			separate_tested(c));
	case SEPARATE_NOISE:
		separate_noise(s, share);
		return xprintf("the noise is %.3g and %.3g times that of the instrument",
			share[0], share[1]);
	case SEPARATE_CHANGED:
		return xprintf("more than a tenth of the rows before the instrument was "
			       "learned again are doubted: the others there are "
			       "doubtful, too");
	case SEPARATE_COVERED:
		return xprintf("events that are no particles cover %.2g %% of it, and "
			       "hide the particles there",
			100 * c->covered / c->samples);
	case SEPARATE_UNLEARNED:
		return xprintf("nothing could be learned from its first %.3g s, in which "
			       "a channel stands out of its noise: particles there, if "
			       "any, are missing",
			c->passed_over * separate_ratio(s) / (double)out->rate);
	case SEPARATE_UNEXPLAINED:
		return xprintf("a channel stands out of its noise, but they have nothing "
			       "in common");
	case SEPARATE_LINES:
		return xprintf(
			"its interfering lines change too fast to be followed, and "
			"what they leave is taken for noise: particles may be "
			"missing");
	case SEPARATE_WIDTHS:
		return xprintf("the widths of its pulses differ from those of their "
			       "velocities by more than those of particles: they may be "
			       "bubbles");
	case SEPARATE_UNLIKE:
		return xprintf("what is unresolved differs from the pulse in spectrum, "
			       "by %.0f %%: number and size there are not known",
			100 * sqrt(c->unlike / c->compared));
	case SEPARATE_COUNTLESS:
		return xprintf(
			"number and size of the particles in %.0f %% of it are not "
			"known: it is unresolved, and too short or too much like "
			"noise to count them",
			100 * c->countless / c->samples);
	case SEPARATE_REVERSED:
		return xprintf("%.0f of %.0f pulses are reversed", c->negative, c->rows);
	case SEPARATE_CROWD:
		return xprintf(
			"%.0f %% of it is unresolved, unlike the record of the instrument",
			100 * c->dense / c->samples);
	}
	return NULL;
}

/* Says so, and so do the tables. */
static int is_doubtful(
	const struct separate *s, struct found *out, const char *name, const char *kept)
{
	enum separate_doubt doubt = separate_doubtful(s);
	char *why = reason(s, doubt, out);

	if (!why)
		return 0;
	if (doubt == SEPARATE_FOREIGN && !kept)
		warn("%s: %s (misfit): the others are doubtful, too", name, why);
	else if (kept && (doubt == SEPARATE_FOREIGN || doubt == SEPARATE_NOISE ||
				 doubt == SEPARATE_REVERSED || doubt == SEPARATE_CROWD))
		warn("%s: this instrument does not fit %s: %s", kept, name, why);
	else
		warn("%s: %s", name, why);
	found_doubt(out, why);
	free(why);
	return 1;
}

/* Says so where most phases are of no material: the classes of the others are doubtful,
 * too. */
static int is_out_of_phase(struct found *out, const char *name)
{
	char *why;

	if (2 * out->strange <= out->phases)
		return 0;
	warn("%s: %ld of %ld phases are of no material: is --phase, --excitation or "
	     "--material wrong?",
		name, out->strange, out->phases);
	why = xprintf("%ld of %ld phases are of no material", out->strange, out->phases);
	found_doubt(out, why);
	free(why);
	return 1;
}

/* Says how many rows may be two particles each. */
static void tell_together(const struct separate *s, struct found *out, const char *name)
{
	const struct separate_counters *c = separate_counters(s);

	if (c->together == 0)
		return;
	warn("%s: %.0f of %.0f rows may be two particles that arrived together (misfit)",
		name, c->together, c->rows);
	table_comment(out->particles, "together",
		"%.0f of %.0f rows may be two particles that arrived together",
		c->together, c->rows);
}

/* Says how many samples the converter has not measured. */
static void tell_missing(const struct separate *s, struct found *out, const char *name)
{
	static const char text[] =
		"%.0f samples of sensor 1 and %.0f of sensor 2 were not measured: they "
		"are nan, at a limit of the converter, or constant";
	const double *missing = separate_counters(s)->missing, ratio = separate_ratio(s);
	char *what;

	if (missing[0] + missing[1] == 0)
		return;
	what = xprintf(text, ratio * missing[0], ratio * missing[1]);
	warn("%s: %s", name, what);
	table_comment(out->particles, "missing", "%s", what);
	free(what);
}

/* Says where the instrument was learned again. */
static void tell_changes(const struct renewal *r, struct found *out, const char *name)
{
	size_t n;
	const long long *change = renewal_changes(r, &n);

	for (size_t i = 0; i < n; i++) {
		double at = (double)change[i] / (double)out->rate;

		warn("%s: the instrument changed: it is learned again from %.3g s on",
			name, at);
		table_comment(out->particles, "changed",
			"the instrument is learned again from %.3g s on", at);
	}
}

/* Says how many rows are events that are no particles. */
static void tell_events(const struct separate *s, struct found *out)
{
	const double *n = separate_counters(s)->events;
	double sum = n[SEPARATE_SHOCK] + n[SEPARATE_BUBBLE] + n[SEPARATE_IMPULSE] +
		     n[SEPARATE_TRANSIENT];

	if (sum > 0)
		table_comment(out->particles, "events",
			"%.0f shocks, %.0f bubbles, %.0f impulses, %.0f transients",
			n[SEPARATE_SHOCK], n[SEPARATE_BUBBLE], n[SEPARATE_IMPULSE],
			n[SEPARATE_TRANSIENT]);
}

/* Writes the instrument that was learned, once its rows are believed. */
static void keep(const struct separate *s, const struct instrument_place *place)
{
	struct instrument view;

	enum separate_doubt doubt = separate_doubtful(s);

	if (separate_instrument(s, &view) &&
		(doubt == SEPARATE_BELIEVED || doubt == SEPARATE_COVERED ||
			doubt == SEPARATE_UNLEARNED))
		instrument_write(place, &view);
}

int separate_record(struct signal_in *in, struct found *out,
	const struct separate_par *given, const char *file)
{
	static double frame[4 * BLOCK];
	struct separate_par par = *given;
	struct instrument_place place = { .path = file,
		.angle = out->components ? components_angle() : NAN,
		.rate = (double)out->rate,
		.spacing = out->spacing,
		.known = &par.known };
	struct instrument kept, view;
	struct early *e;
	const struct separate *s;
	int doubtful, learned = 0;
	enum separate_status status;
	size_t n;

	if (file && instrument_read(&place, &kept))
		par.kept = &kept;
	e = early_new(&par);
	if (!e)
		die(EXIT_RUN, "no memory");
	while ((n = signal_read_some(in, frame, BLOCK)) > 0) {
		int any;

		status = early_push(e, frame, n);
		any = put_ready(e, out);
		s = renewal_now(early_whole(e));
		check_status(status, s, signal_name(in));
		if (any)
			table_flush(out->particles);
		if (file && !par.kept && !learned && separate_instrument(s, &view)) {
			learned = 1;
			keep(s, &place);
		}
	}
	status = early_end(e);
	put_ready(e, out);
	s = renewal_now(early_whole(e));
	check_status(status, s, signal_name(in));
	if (file && !par.kept)
		keep(s, &place);
	if (file && access(file, F_OK) != 0)
		warn("%s: not written: what was learned is doubtful, or nothing was",
			file);
	report(s, (double)out->rate);
	tell_polarity(s, signal_name(in));
	tell_missing(s, out, signal_name(in));
	tell_together(s, out, signal_name(in));
	tell_events(s, out);
	tell_changes(early_whole(e), out, signal_name(in));
	doubtful = is_doubtful(s, out, signal_name(in), par.kept ? file : NULL) ||
		   is_out_of_phase(out, signal_name(in));
	found_detectable(out, separate_calibration(s), separate_ratio(s));
	early_free(e);
	return doubtful;
}

static struct count *start_count(const struct count_par *par, const double *x, size_t n,
	int channels, size_t channel, const char *name)
{
	double *work = xcalloc(n, sizeof *work);
	double level = isnan(par->floor) ? count_level(x, n, (size_t)channels, work)
					 : par->floor;
	struct count *c;

	free(work);
	if (!(level > 0))
		die(EXIT_RUN, "%s: channel %zu is constant: give --floor", name, channel);
	c = count_new(level);
	if (!c)
		die(EXIT_RUN, "no memory");
	return c;
}

void count_record(struct signal_in *in, struct found *out, const struct count_par *par)
{
	int channels = signal_format(in)->channels;
	/* that in phase, of four */
	size_t counted = (size_t)(par->sensor - 1) * (channels == 4 ? 2 : 1);
	double *x = xcalloc(par->learn, sizeof *x * (size_t)channels);
	struct count *c = NULL;
	struct peak p;
	long long frame = 0;
	size_t n;

	while ((n = signal_read(in, x, par->learn)) > 0) {
		for (size_t i = 0; i < n; i++, frame++) {
			double y = x[i * (size_t)channels + counted];

			if (!isfinite(y))
				die(EXIT_RUN,
					"%s: channel %zu, frame %lld: not a finite number",
					signal_name(in), counted + 1, frame);
			if (!c)
				c = start_count(par, x + counted, n, channels,
					counted + 1, signal_name(in));
			if (count_sample(c, y, &p))
				found_peak(out, &p, par->sensor, par->delay);
		}
	}
	if (c && count_end(c, &p))
		found_peak(out, &p, par->sensor, par->delay);
	stats_set("samples", (double)frame);
	stats_set("peaks", (double)out->count);
	count_free(c);
	free(x);
}
