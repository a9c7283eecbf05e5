#include "outputs.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "components.h"
#include "signal/detect/detectable.h"
#include "signal/pulse/sensor.h"
#include "signal/separate/sizing.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SOURCES_SHOWN = 8 };

#define COLUMNS                                                                       \
	"particle time1 time2 diameter amplitude delay velocity time1_se time2_se "   \
	"diameter_se amplitude_se delay_se velocity_se section sources chi2 verdict " \
	"diameter_most"

static const char *const verdicts[] = { "alone", "overlap", "misfit", "unresolved",
	"shock", "bubble", "impulse", "transient" };

static struct table_out *side_table(const char *path, const struct signal_format *format,
	const char *option, const char *units, const char *columns)
{
	char *cmd = opt_cmd_side(format->cmd, option);
	struct table_out *t = table_create(path, cmd, units, columns);

	free(cmd);
	return t;
}

void found_open(struct found *out, const struct signal_format *format, const char *cmd)
{
	struct signal_format many = { format->rate, SOURCES_SHOWN, 0, NULL, NULL, NULL,
		NULL, format->start, format->doubt };

	out->rate = format->rate;
	out->particles = table_create(NULL, cmd,
		out->components ? "1 s s m V s m/s s s m V s m/s 1 1 1 1 m rad rad 1 1"
				: "1 s s m V s m/s s s m V s m/s 1 1 1 1 m",
		out->components ? COLUMNS " phase phase_se ferrous class" : COLUMNS);
	if (format->seed)
		table_comment(out->particles, "seed", "%s", format->seed);
	if (format->start)
		table_comment(out->particles, "start", "%s", format->start);
	if (out->sections)
		out->section_rows = side_table(out->sections, format, "sections",
			"1 s s 1 1 V V V2 V2 V4 V4 1 1",
			"section begin end sources sources_se amplitude amplitude_se square square_se "
			"fourth fourth_se chi2 verdict");
	if (out->histogram)
		out->weights = side_table(out->histogram, format, "histogram", "1 1 s 1",
			"section attenuation delay weight");
	if (out->detectable)
		out->limits = side_table(out->detectable, format, "detectable", "m V 1 1",
			"diameter amplitude alone beside");
	if (out->separated) {
		many.cmd = opt_cmd_side(format->cmd, "separated");
		out->sources = signal_create(out->separated, &many);
		free(many.cmd);
	}
}

/* A row of n numbers and a verdict, not ended. */
static void put_row(struct table_out *t, const double *row, int n, const char *word)
{
	for (int i = 0; i < n; i++)
		table_put(t, row[i]);
	table_put_text(t, word);
}

static void put_class(struct found *out, const struct transit *p, double diameter)
{
	struct table_out *t = out->particles;
	struct component_class class =
		components_classify(diameter, p->phase, p->phase_se);

	if (!isnan(p->phase) && p->verdict <= SEPARATE_OVERLAP) {
		out->phases++;
		out->strange += isnan(class.ferrous) != 0;
	}
	table_put(t, class.phase);
	table_put(t, p->phase_se);
	table_put(t, class.ferrous);
	table_put_text(t, class.name);
}

/* The whole amplitude where only the first component is known: that of phases 0 and -90
 * degrees. */
static struct transit whole(const struct found *out, struct transit p)
{
	if (out->components && isnan(p.phase)) {
		p.amplitude /= components_share();
		p.amplitude_se /= components_share();
	}
	return p;
}

void found_particle(struct found *out, const struct transit *found)
{
	const struct transit every = whole(out, *found), *p = &every;
	int one = p->verdict < SEPARATE_UNRESOLVED;
	struct sizing s;

	sizing_of(p, (double)out->rate, out->spacing, out->kappa, &s);
	const double row[16] = { one ? (double)out->count++ : NAN, s.time[0], s.time[1],
		s.diameter, s.amplitude, s.delay, s.velocity, s.time_se[0], s.time_se[1],
		s.diameter_se, s.amplitude_se, s.delay_se, s.velocity_se,
		(double)p->section, (double)p->sources, p->chi2 };

	put_row(out->particles, row, 16, verdicts[p->verdict]);
	table_put(out->particles, s.most);
	if (out->components)
		put_class(out, p, s.diameter);
	table_end_row(out->particles);
	if (p->verdict == SEPARATE_ALONE || p->verdict == SEPARATE_OVERLAP)
		out->largest = fmax(out->largest, fabs(p->amplitude));
}

void found_peak(struct found *out, const struct peak *p, int sensor, double delay)
{
	double t = p->t / (double)out->rate, v = out->spacing / delay;
	const double row[16] = { (double)out->count++, sensor == 1 ? t : NAN,
		sensor == 2 ? t : NAN, sensor_diameter(out->kappa, v, p->height),
		p->height, delay, v, NAN, NAN, NAN, NAN, NAN, NAN, NAN, 1, NAN };

	put_row(out->particles, row, 16, "counted");
	table_put(out->particles, NAN);
	table_end_row(out->particles);
}

/* Writes silence up to sample upto, then what is held. */
static void draw_until(struct found *out, long long upto)
{
	static const double silence[SOURCES_SHOWN];

	if (out->held)
		signal_write(out->sources, out->frames, out->held);
	out->drawn += (long long)out->held;
	out->held = 0;
	for (; out->drawn < upto; out->drawn++)
		signal_write(out->sources, silence, 1);
}

/* Adds the sources of a section; sections may overlap by the tails of pulses. */
static void draw_sources(struct found *out, const struct separate_section *s)
{
	size_t n = (size_t)(s->end - s->begin), end, at;

	if (s->begin > out->drawn + (long long)out->held)
		draw_until(out, s->begin);
	at = s->begin > out->drawn ? (size_t)(s->begin - out->drawn) : 0;
	end = at + n;
	if (end > out->held) {
		out->frames =
			xrealloc(out->frames, end, SOURCES_SHOWN * sizeof *out->frames);
		memset(out->frames + out->held * SOURCES_SHOWN, 0,
			(end - out->held) * SOURCES_SHOWN * sizeof *out->frames);
		out->held = end;
	}
	for (int k = 0; k < s->sources; k++)
		for (size_t i = 0; i < n; i++)
			out->frames[(at + i) * SOURCES_SHOWN +
				    (size_t)(k % SOURCES_SHOWN)] +=
				s->source[(size_t)k * n + i];
}

static void put_section(struct found *out, const struct separate_section *s)
{
	static const struct campbell none = { .amplitude = NAN,
		.amplitude_se = NAN,
		.square = NAN,
		.square_se = NAN,
		.fourth = NAN,
		.fourth_se = NAN };
	const struct campbell *c = s->dense ? s->dense : &none;
	double rate = (double)out->rate;
	double seen = out->components ? components_share() : 1;
	const double row[12] = { (double)s->number, (double)s->begin / rate,
		(double)s->end / rate, s->sources,
		c->rate_se * (double)(s->end - s->begin), c->amplitude / seen,
		c->amplitude_se / seen, c->square * rate / pow(seen, 2),
		c->square_se * rate / pow(seen, 2), c->fourth * rate / pow(seen, 4),
		c->fourth_se * rate / pow(seen, 4), s->chi2 };

	put_row(out->section_rows, row, 12, verdicts[s->verdict]);
	table_end_row(out->section_rows);
}

static void put_histogram(struct found *out, const struct separate_section *s)
{
	for (int i = 0; i < MASKS_CELLS * MASKS_CELLS; i++) {
		const int at = i / MASKS_CELLS;
		double a, delta;

		masks_cell(s->masks, at + 0.5, i % MASKS_CELLS + 0.5, &a, &delta);
		const double row[4] = { (double)s->number, a, delta / (double)out->rate,
			masks_histogram(s->masks)[i] };

		table_put_row(out->weights, row, 4);
	}
}

void found_section(void *context, const struct separate_section *s)
{
	struct found *out = context;

	if (out->section_rows)
		put_section(out, s);
	if (out->sources && s->source)
		draw_sources(out, s);
	if (out->weights && s->masks)
		put_histogram(out, s);
}

/* From where hardly any is found to where hardly any is missed, in steps of a tenth. */
void found_detectable(struct found *out, const struct calibration *c, int ratio)
{
	enum { ROWS = 100 };
	/* of an amplitude in the channels that are searched */
	double seen = out->components ? components_share() : 1;
	double share[DETECTABLE_PLACES], alone = 0, beside = 0, noise, v, a;
	struct joint_scene scene;

	if (!out->limits || !c)
		return;
	noise = c->noise[0];
	v = c->shift > 0 ? out->spacing * out->rate / ratio / (double)c->shift : NAN;
	calibration_scene(c, &scene);
	detectable_shares(c->shape, share);
	table_comment(out->limits, "large", "%.17g V", out->largest);
	for (a = noise; detectable_alone(&scene, a / noise) > 1e-3;)
		a /= 1.1;
	for (; detectable_alone(&scene, a / noise) < 1e-3;)
		a *= 1.1;
	for (int k = 0; k < ROWS && !(alone > 0.999 && beside > 0.9); k++) {
		alone = detectable_alone(&scene, a / noise);
		beside = detectable_beside(
			&scene, a / noise, seen * out->largest / noise, share);
		const double row[4] = { sensor_diameter(out->kappa, v, a / seen),
			a / seen, alone, beside };

		table_put_row(out->limits, row, 4);
		a *= 1.1;
	}
}

enum { TABLES = 4 };

static void tables_of(struct found *out, struct table_out *t[TABLES])
{
	t[0] = out->particles;
	t[1] = out->section_rows;
	t[2] = out->weights;
	t[3] = out->limits;
}

void found_doubt(struct found *out, const char *why)
{
	struct table_out *t[TABLES];

	tables_of(out, t);
	for (int k = 0; k < TABLES; k++)
		if (t[k])
			table_comment(t[k], "doubtful", "%s", why);
}

void found_close(struct found *out)
{
	struct table_out *t[TABLES];

	tables_of(out, t);
	for (int k = 0; k < TABLES; k++)
		if (t[k])
			table_done(t[k]);
	if (out->sources) {
		draw_until(out, 0);
		signal_done(out->sources);
	}
	free(out->frames);
}
