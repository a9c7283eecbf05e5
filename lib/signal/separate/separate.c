/* separate.c - see separate.h */
#include "signal/separate/separate.h"
#include "num/room.h"
#include "signal/detect/sections.h"
#include "signal/detect/spikes.h"
#include "signal/fit/goodness.h"
#include "signal/noise/robust.h"
#include "signal/separate/contrasts.h"
#include "signal/separate/quadrature.h"
#include "signal/separate/tape.h"
#include "signal/separate/validate.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A row that may not have been judged yet. */
struct entry {
	struct transit row;
	struct evidence evidence;
};

/* A section to be reported once its rows are judged. */
struct report {
	struct separate_section section;
	struct campbell dense;
	double *source;
	size_t first, rows; /* of the queue */
};

/* Pulses that stood alone by which the range of delays and the gain are followed. */
enum { TRACKED = 64, ENOUGH = 12, GAINS = 8 };

struct separate {
	struct separate_par par;
	struct calibration cal;
	int calibrated, ended;
	struct instrument kept; /* par.kept, its cal moved to cal */
	int varies[2];          /* channel: not constant so far */
	double first[2];        /* samples of a kept instrument's record */
	double level[2], levels;
	long long level_at;
	int looked, crowded; /* at the first stretch: too many pulses in long sections */
	struct tape tape[2];
	struct sections *sections;
	struct joint *joint;
	struct masks *masks;
	struct joint_scene scene;
	struct joint_pulse pulse[JOINT_PULSES_MAX];
	struct quadrature quadrature;
	struct quadrature_pulse both[JOINT_PULSES_MAX]; /* pulse, with both components */
	int with_both;  /* 1: both is of the present window */
	int carried;    /* pulses of the last window that the next one starts from */
	long long span; /* longest window in this section; 0: as given */
	int failures;   /* windows unresolved, one after the other */
	int dense;      /* the rest of this section is not taken apart */
	int strange;    /* ... though it is short */
	unsigned char *spikes; /* flags of impulses */
	size_t spike_room;
	/* Covariances of the delays of pulse, all of them; 0: not known. */
	double delay_cov[JOINT_PULSES_MAX * JOINT_PULSES_MAX];
	int all;
	double delay[TRACKED]; /* of the last pulses that stood alone */
	size_t delays;
	double gain_off[GAINS]; /* of such, in standard errors, since it was last set */
	double gain_sum, gain_weight;
	int gains;
	int continuing; /* the next window belongs to the same section */
	long number;
	long long done; /* samples before this one are worked off */
	struct entry *queue;
	size_t count, judged, given, capacity;
	struct report *report;
	size_t reports, report_capacity;
	struct validation *validation;
	long long hold; /* rows of what lies before are judged together */
	int holding, group;
	double *source;
	struct separate_counters counters;
	enum separate_status reason; /* why nothing could be learned */
	long long bad_frame;
	int bad_channel;
};

struct separate *separate_new(const struct separate_par *par)
{
	struct separate *s = calloc(1, sizeof *s);

	if (!s)
		return NULL;
	s->par = *par;
	if (s->par.learn < SEPARATE_SHORTEST)
		s->par.learn = SEPARATE_SHORTEST;
	if (par->kept) {
		s->kept = *par->kept;
		s->cal = s->kept.cal;
		par->kept->cal = s->kept.cal = (struct calibration){ .shift = 0 };
	}
	s->validation = validation_new();
	if (!s->validation) {
		separate_free(s);
		return NULL;
	}
	if (s->par.most_pulses <= 0 || s->par.most_pulses > JOINT_PULSES_MAX)
		s->par.most_pulses = JOINT_PULSES_MAX;
	return s;
}

void separate_free(struct separate *s)
{
	if (!s)
		return;
	calibration_clear(&s->cal);
	sections_free(s->sections);
	joint_free(s->joint);
	masks_free(s->masks);
	for (int c = 0; c < 2; c++)
		tape_clear(&s->tape[c]);
	quadrature_clear(&s->quadrature);
	for (size_t i = 0; i < s->reports; i++)
		free(s->report[i].source);
	free(s->report);
	validation_free(s->validation);
	free(s->queue);
	free(s->source);
	free(s->spikes);
	free(s);
}

const struct calibration *separate_calibration(const struct separate *s)
{
	return s->calibrated ? &s->cal : NULL;
}

const struct separate_counters *separate_counters(const struct separate *s)
{
	return &s->counters;
}

long long separate_bad_sample(const struct separate *s, int *channel)
{
	*channel = s->bad_channel;
	return s->bad_frame;
}

int separate_next(struct separate *s, struct transit *p)
{
	if (s->given == s->judged) {
		if (s->given == s->count)
			s->given = s->judged = s->count = 0;
		return 0;
	}
	*p = s->queue[s->given++].row;
	return 1;
}

static struct entry *queue_entry(struct separate *s)
{
	if (s->count == s->capacity) {
		size_t capacity = s->capacity ? 2 * s->capacity : 64;
		struct entry *more = realloc(s->queue, capacity * sizeof *more);

		if (!more)
			return NULL;
		s->queue = more;
		s->capacity = capacity;
	}
	memset(&s->queue[s->count], 0, sizeof *s->queue);
	return &s->queue[s->count++];
}

/* The section is reported with its rows, the last of the queue, and the sources drawn. */
static int queue_report(
	struct separate *s, const struct separate_section *section, size_t rows)
{
	struct report *r;

	if (!s->par.on_section)
		return 1;
	if (s->reports == s->report_capacity) {
		size_t capacity = s->report_capacity ? 2 * s->report_capacity : 16;
		struct report *more = realloc(s->report, capacity * sizeof *more);

		if (!more)
			return 0;
		s->report = more;
		s->report_capacity = capacity;
	}
	r = &s->report[s->reports++];
	memset(r, 0, sizeof *r);
	r->section = *section;
	if (section->dense)
		r->dense = *section->dense;
	r->source = s->source;
	s->source = NULL;
	r->first = s->count - rows;
	r->rows = rows;
	return 1;
}

static void give_reports(struct separate *s)
{
	for (size_t i = 0; i < s->reports; i++) {
		struct report *r = &s->report[i];

		if (r->section.dense)
			r->section.dense = &r->dense;
		r->section.source = r->source;
		for (size_t k = r->first; k < r->first + r->rows; k++)
			if (s->queue[k].evidence.doubted &&
				r->section.verdict != SEPARATE_UNRESOLVED)
				r->section.verdict = SEPARATE_MISFIT;
		s->par.on_section(s->par.context, &r->section);
		free(r->source);
	}
	s->reports = 0;
}

/* Judges the rows held back, which are given out from now on. */
static enum separate_status judge_rows(struct separate *s)
{
	size_t n = s->count - s->judged;
	struct evidence *e = malloc((n ? n : 1) * sizeof *e);

	if (!e)
		return SEPARATE_MEMORY;
	for (size_t i = 0; i < n; i++)
		e[i] = s->queue[s->judged + i].evidence;
	validation_judge(s->validation, e, n);
	for (size_t i = 0; i < n; i++) {
		struct entry *q = &s->queue[s->judged + i];

		q->evidence.doubted = e[i].doubted;
		s->counters.misfits += e[i].doubted;
		if (!e[i].doubted || q->row.verdict == SEPARATE_UNRESOLVED)
			continue;
		s->counters.foreign += q->evidence.fits;
		q->row.verdict = SEPARATE_MISFIT;
	}
	free(e);
	s->judged = s->count;
	give_reports(s);
	return SEPARATE_OK;
}

static enum separate_status start(struct separate *s, size_t n);

static enum separate_status calibrate_now(struct separate *s)
{
	static const enum separate_status of[] = {
		[CALIBRATE_OK] = SEPARATE_OK,
		[CALIBRATE_MEMORY] = SEPARATE_MEMORY,
		[CALIBRATE_COLOURED] = SEPARATE_NO_LAG,
		[CALIBRATE_SILENT_1] = SEPARATE_SILENT_1,
		[CALIBRATE_SILENT_2] = SEPARATE_SILENT_2,
		[CALIBRATE_HARD] = SEPARATE_HARD,
		[CALIBRATE_NO_LAG] = SEPARATE_NO_LAG,
		[CALIBRATE_AT_ONCE] = SEPARATE_AT_ONCE,
		[CALIBRATE_SWAPPED] = SEPARATE_SWAPPED,
		[CALIBRATE_FAR] = SEPARATE_FAR,
		[CALIBRATE_NARROW] = SEPARATE_NARROW,
		[CALIBRATE_FAST] = SEPARATE_FAST,
		[CALIBRATE_SLOW] = SEPARATE_SLOW,
		[CALIBRATE_TONES] = SEPARATE_TONES,
	};
	enum calibrate_status status;
	struct calibrate_par known;
	size_t n;

	if (s->tape[0].n < SEPARATE_SHORTEST)
		return SEPARATE_NO_LAG;
	/* Not more than asked for, however much has come in at once. */
	n = s->tape[0].n < s->par.learn ? s->tape[0].n : s->par.learn;
	known = s->par.known;
	for (int c = 0; c < 2; c++) {
		tape_review(&s->tape[c]);
		known.hidden[c] = s->tape[c].hidden;
	}
	status = calibrate(&known, s->tape[0].x, s->tape[1].x, n, &s->cal);
	if (status != CALIBRATE_OK)
		return of[status];
	if (!(s->cal.duration >= SECTIONS_SHORTEST)) {
		calibration_clear(&s->cal);
		return SEPARATE_FAST;
	}
	return start(s, n);
}

/* With an instrument learned from the n oldest samples, or kept. */
static enum separate_status start(struct separate *s, size_t n)
{
	const struct calibration *c = &s->cal;
	double reach;

	s->calibrated = 1;
	s->done = s->level_at = s->tape[0].begin + c->whitening.edge;
	calibration_scene(c, &s->scene);
	s->scene.max_pulses = JOINT_PULSES_MAX;
	reach = 2 * shape_reach(c->shape) * c->duration;
	if (s->par.window < (size_t)(6 * reach))
		s->par.window = s->par.window ? (size_t)(6 * reach)
					      : (size_t)(reach + 23 * c->duration);
	/* What a baseline has to follow in a window must not be too much. */
	if (c->whitening.low * 2 * (double)s->par.window > JOINT_BASELINE_MAX)
		s->par.window = (size_t)fmax(
			3 * reach, JOINT_BASELINE_MAX / (2 * c->whitening.low));
	if (tape_start(&s->tape[0], c) != NUM_OK || tape_start(&s->tape[1], c) != NUM_OK)
		return SEPARATE_MEMORY;
	if (s->par.quadrature && quadrature_start(&s->quadrature, c, n) != NUM_OK)
		return SEPARATE_MEMORY;
	/* Equal pulses on both channels reach the threshold of a pair at 1 / sqrt 2 of
	 * it. */
	s->sections = sections_new(c->shape, c->duration, 0.65 * sqrt(c->drop),
		fmax(c->delta_max, -c->delta_min));
	if (s->sections)
		sections_skip(s->sections, s->done);
	s->hold = s->tape[0].begin + (long long)n;
	if (isnan(s->par.known.spread) && !isinf(c->transit))
		validation_range(s->validation, c->delta_min, c->delta_max);
	s->holding = s->par.method == SEPARATE_FIT && n > 0;
	if (s->par.kept) {
		validation_tell_flow(s->validation, &s->kept.flow);
		s->crowded = s->kept.crowded;
		s->looked = 1;
	}
	s->joint = joint_new();
	if (s->par.method == SEPARATE_MASKS) {
		size_t window = s->par.mask_window ? s->par.mask_window : 64;
		struct masks_par mp = { .duration = c->duration,
			.delta_min = c->delta_min,
			.delta_max = c->delta_max,
			.gain_max = 2 * s->scene.gain,
			.peak_share = 0.3,
			.sources = s->par.sources,
			.shape = c->shape };

		/* Its first bin has to lie in the band of a pulse. */
		while (!s->par.mask_window && (double)window * MASKS_BAND < c->duration)
			window *= 2;
		if ((double)window * MASKS_BAND < c->duration)
			return SEPARATE_WINDOW;
		mp.window = window;
		mp.hop = s->par.mask_hop ? s->par.mask_hop : window / 2;
		s->masks = masks_new(&mp);
		if (!s->masks)
			return SEPARATE_MEMORY;
	}
	return s->sections && s->joint ? SEPARATE_OK : SEPARATE_MEMORY;
}

static double *channel_1(struct separate *s, long long at)
{
	return s->tape[0].x + (at - s->tape[0].begin);
}

static double *channel_2(struct separate *s, long long at)
{
	return s->tape[1].x + (at + s->cal.shift - s->tape[1].begin);
}

/* The second components, as channel_1() and channel_2(). */
static void quadrature_at(struct separate *s, long long at, double *v[2])
{
	for (int c = 0; c < 2; c++) {
		const struct tape *t = &s->quadrature.tape[c];

		v[c] = t->x + (at + (c ? s->cal.shift : 0) - t->begin);
	}
}

/* Aligned samples before this one are ready on both channels. */
static long long ready(const struct separate *s)
{
	long long second = s->tape[1].clean - s->cal.shift;

	return s->tape[0].clean < second ? s->tape[0].clean : second;
}

/* What the second component adds to the row of pulse i. */
static void tell_phase(
	const struct separate *s, int i, long long from, struct transit *out)
{
	const struct quadrature_pulse *p = &s->both[i];
	double noise = s->cal.noise[0], size = hypot(p->a, p->b);
	double ca = p->a / size, cb = p->b / size, along[4];
	double delay_var = p->cov[0][0] - 2 * p->cov[0][1] + p->cov[1][1];

	for (int k = 0; k < 4; k++)
		along[k] = ca * p->cov[2][k] + cb * p->cov[3][k];
	out->t1 = (double)from + p->t;
	out->t2 = out->t1 + (double)s->cal.shift + p->delta;
	out->t1_se = sqrt(p->cov[0][0]);
	out->t2_se = sqrt(p->cov[1][1]);
	out->delay_se = sqrt(delay_var);
	out->amplitude = size * noise;
	out->amplitude_se = sqrt(ca * along[2] + cb * along[3]) * noise;
	out->correlation =
		(along[1] - along[0]) * noise / (out->amplitude_se * out->delay_se);
	/* of a reversed pulse, the opposite of the phase of what it was reversed from */
	out->phase = s->cal.reversed ? atan2(-p->b, -p->a) : atan2(p->b, p->a);
	out->phase_se = sqrt(cb * cb * p->cov[2][2] - 2 * ca * cb * p->cov[2][3] +
				ca * ca * p->cov[3][3]) /
			size;
}

static int emit_pulse(struct separate *s, const struct joint_pulse *p, long long from,
	int sources, double chi2, enum separate_verdict verdict)
{
	struct entry *entry = queue_entry(s);
	struct transit *out;
	double delay_var = joint_delay_variance(p), noise = s->cal.noise[0];

	if (!entry)
		return 0;
	out = &entry->row;
	out->section = s->number;
	out->sources = sources;
	out->t1 = (double)from + p->t;
	out->t2 = out->t1 + (double)s->cal.shift + p->delta;
	out->amplitude = p->a * noise;
	out->t1_se = sqrt(p->cov[0]);
	out->t2_se = sqrt(p->cov[2]);
	out->delay_se = sqrt(delay_var);
	out->amplitude_se = sqrt(p->cov[5]) * noise;
	out->correlation = (p->cov[4] - p->cov[3]) / sqrt(delay_var * p->cov[5]);
	out->phase = out->phase_se = NAN;
	if (s->with_both)
		tell_phase(s, (int)(p - s->pulse), from, out);
	out->chi2 = chi2;
	out->verdict = verdict;
	entry->evidence = (struct evidence){ .group = s->group,
		.fits = verdict != SEPARATE_MISFIT,
		.delay = p->delta,
		.var = isinf(s->cal.transit) || !isfinite(delay_var) ? 0 : delay_var,
		.amplitude = p->a };
	s->counters.rows++;
	s->counters.negative += p->a < 0;
	return 1;
}

/* The larger pulse nearest to pulse i that overlaps it, or -1. */
static int larger_neighbour(const struct separate *s, int m, int i)
{
	const struct joint_pulse *p = s->pulse;
	double nearest = 2 * s->cal.duration;
	int found = -1;

	for (int k = 0; k < m; k++)
		if (fabs(p[k].a) > fabs(p[i].a) && fabs(p[k].t - p[i].t) < nearest) {
			nearest = fabs(p[k].t - p[i].t);
			found = k;
		}
	return found;
}

/* What the last m rows, of one fit, tell of each other. */
static enum num_status compare_pulses(struct separate *s, int m)
{
	double delay[JOINT_PULSES_MAX], square[JOINT_PULSES_MAX], var[JOINT_PULSES_MAX];
	const double *cov = s->delay_cov;
	struct entry *entry = s->queue + s->count - m;
	const struct joint_pulse *p = s->pulse;
	int all = s->all;

	for (int i = 0; i < m && all >= m && !isinf(s->cal.transit); i++) {
		struct evidence *e = &entry[i].evidence;
		int k = larger_neighbour(s, m, i);

		if (k < 0)
			continue;
		e->partner = k - i;
		e->apart = p[i].delta - p[k].delta;
		e->apart_var = cov[i * all + i] + cov[k * all + k] - 2 * cov[i * all + k];
		e->place = (p[i].t - p[k].t) / s->cal.duration;
		e->height = fabs(p[i].a / p[k].a);
	}
	if (m < 2 || all < m || isinf(s->cal.transit))
		return NUM_OK;
	for (int i = 0; i < m; i++)
		delay[i] = p[i].delta;
	if (contrasts_of(m, delay, cov, all, square, var) != NUM_OK)
		return NUM_MEMORY;
	for (int i = 0; i + 1 < m; i++) {
		entry[i].evidence.contrast2 = square[i];
		entry[i].evidence.contrast_var = var[i];
	}
	return NUM_OK;
}

static int report_section(struct separate *s, long long from, long long to, int sources,
	double chi2, enum separate_verdict verdict, const double *source)
{
	struct separate_section out = { .number = s->number,
		.begin = from,
		.end = to,
		.sources = sources,
		.chi2 = chi2,
		.verdict = verdict,
		.source = source,
		.masks = s->masks };

	if (s->par.on_section)
		s->par.on_section(s->par.context, &out);
	return 1;
}

static int reserve_sources(struct separate *s, size_t count)
{
	free(s->source);
	s->source = calloc(count ? count : 1, sizeof *s->source);
	return s->source != NULL;
}

/* Each fitted pulse alone, as sensor 1 would see it. */
static int draw_pulses(struct separate *s, int m, size_t n)
{
	if (!reserve_sources(s, (size_t)m * n))
		return 0;
	for (int i = 0; i < m; i++) {
		double *x = s->source + (size_t)i * n;

		joint_add(&s->scene, &s->pulse[i], 1, x, NULL, n);
		for (size_t k = 0; k < n; k++)
			x[k] *= s->cal.noise[0];
	}
	return 1;
}

/* Where to cut a window of n samples: the widest gap between arrivals in its later
 * half that leaves room for the pulses behind it. */
static double choose_cut(const struct separate *s, int m, size_t n)
{
	double lo = 0.4 * (double)n, widest = -1, cut = 0;
	double hi = (double)n - 2.2 * shape_reach(s->cal.shape) * s->cal.duration;

	for (int i = 0; i <= m; i++) {
		double from = i ? s->pulse[i - 1].t : 0,
		       to = i < m ? s->pulse[i].t : (double)n;

		if (from < lo)
			from = lo;
		if (to > hi)
			to = hi;
		if (to - from > widest) {
			widest = to - from;
			cut = (from + to) / 2;
		}
	}
	return cut;
}

/* More pulses than this in n samples are not looked for. */
static int most_pulses(const struct separate *s, size_t n)
{
	double most = 4 + 3 * (double)n / s->cal.duration;

	if (s->par.sources)
		most = s->par.sources;
	return (int)fmin(most, s->par.most_pulses);
}

/* Shot noise of [from, to): one row. */
static enum separate_status dense_section(
	struct separate *s, long long from, long long to)
{
	struct entry *entry = queue_entry(s);
	struct transit *p;
	struct separate_section out = { .number = s->number,
		.begin = from,
		.end = to,
		.chi2 = NAN,
		.verdict = SEPARATE_UNRESOLVED };
	double noise = s->cal.noise[0], length = (double)(to - from);
	struct campbell c;

	if (!entry)
		return SEPARATE_MEMORY;
	p = &entry->row;
	campbell_estimate(channel_1(s, from), channel_2(s, from), (size_t)(to - from),
		s->cal.shape, s->cal.duration, s->scene.gain, &c);
	campbell_scale(&c, noise);
	p->section = s->number;
	p->sources =
		isnan(c.rate) || c.rate * length > 1e9 ? 0 : (int)(c.rate * length + 0.5);
	if (s->strange && p->sources < 1)
		p->sources = 1;
	p->t1 = (double)from + length / 2;
	p->t2 = p->t1 + (double)s->cal.shift;
	p->amplitude = c.amplitude;
	p->amplitude_se = c.amplitude_se;
	p->t1_se = p->t2_se = length / sqrt(12);
	p->delay_se = p->correlation = p->chi2 = p->phase = p->phase_se = NAN;
	p->verdict = SEPARATE_UNRESOLVED;
	s->counters.unresolved++;
	s->counters.dense += length;
	entry->evidence.group = ++s->group;
	entry->evidence.fits = !s->strange;
	s->strange = 0;
	out.sources = p->sources;
	out.dense = &c;
	return queue_report(s, &out, 1) ? SEPARATE_OK : SEPARATE_MEMORY;
}

/* Gives out the first done of the m pulses fitted to [from, to). */
static enum separate_status give_pulses(struct separate *s, long long from, long long to,
	int m, int done, const struct goodness *j)
{
	struct separate_section out = { .number = s->number,
		.begin = from,
		.end = to,
		.sources = done,
		.chi2 = j->chi2,
		.verdict = j->stretch };

	s->group++;
	for (int i = 0; i < done; i++)
		if (!emit_pulse(s, &s->pulse[i], from, m, j->chi2, j->pulse[i]))
			return SEPARATE_MEMORY;
	if (compare_pulses(s, done) != NUM_OK)
		return SEPARATE_MEMORY;
	if (s->par.want_sources && !draw_pulses(s, done, (size_t)(to - from)))
		return SEPARATE_MEMORY;
	return queue_report(s, &out, (size_t)done) ? SEPARATE_OK : SEPARATE_MEMORY;
}

/* Takes the first done of m pulses out of the record and carries the others into the
 * next window; returns its first sample. */
static long long cut_section(
	struct separate *s, long long from, double boundary, int m, int done)
{
	size_t rest = (size_t)(ready(s) - from);
	double reach = shape_reach(s->cal.shape) * s->cal.duration;
	long long start = from + (long long)floor(boundary - reach + s->cal.delta_min);

	for (int i = 0; i < done; i++)
		joint_add(&s->scene, &s->pulse[i], -1, channel_1(s, from),
			channel_2(s, from), rest);
	for (int i = 0; i < done && s->with_both; i++) {
		const struct quadrature_pulse *b = &s->both[i];
		struct joint_pulse p = { .t = b->t, .delta = b->delta, .a = b->b };
		double *v[2];

		quadrature_at(s, from, v);
		joint_add(&s->scene, &p, -1, v[0], v[1], rest);
	}
	if (start <= from)
		start = from + 1;
	s->carried = m - done;
	for (int i = 0; i < s->carried; i++) {
		s->pulse[i] = s->pulse[done + i];
		s->pulse[i].t -= (double)(start - from);
	}
	return start;
}

/* Samples: in shorter windows the pulses cut by their ends would be most. */
static double shortest_window(const struct separate *s)
{
	return fmax(10, 6 * shape_reach(s->cal.shape)) * s->cal.duration;
}

/* Windows that stay unresolved one after the other until what is left is given up. */
enum { PATIENCE = 3 };

/* One account of a window: its pulses and what is thought of them. */
struct account {
	struct joint_pulse pulse[JOINT_PULSES_MAX];
	int m, done; /* pulses, and those before the boundary */
	double boundary;
	struct joint_result r;
	struct goodness goodness;
};

/* Samples that the converter has not measured are left out of the fit, but where the
 * record was made white, which spreads them. */
static void hide(struct separate *s, long long from, size_t n)
{
	for (int c = 0; c < 2; c++) {
		const struct tape *t = &s->tape[c];
		const unsigned char *flags =
			t->hidden + (from + (c ? s->cal.shift : 0) - t->begin);

		s->scene.hidden[c] =
			!s->cal.whitening.tap && memchr(flags, 1, n) ? flags : NULL;
	}
}

/* Hides impulses as well, by s->spikes; 0 if there are none. */
static int hide_spikes(struct separate *s, long long from, size_t n)
{
	size_t found = 0;

	for (int c = 0; c < 2; c++) {
		const double *y = c ? channel_2(s, from) : channel_1(s, from);
		const unsigned char *known = s->scene.hidden[c];
		unsigned char *flags = s->spikes + (size_t)c * n;

		found += spikes_find(y, n, s->cal.duration, flags);
		for (size_t i = 0; known && i < n; i++)
			flags[i] |= known[i];
		s->scene.hidden[c] = flags;
	}
	return found > 0;
}

/* Share of the transit time that delays are searched within where the learned range does
 * not do. */
static const double WIDE = 0.3;

/* Share of the transit time that a delay may be less. */
static const double LEAST = 0.5;

static int is_range_free(const struct separate *s)
{
	return isnan(s->par.known.spread) && !isinf(s->cal.transit);
}

/* Searches a range of delays about the present one that is as wide as may be. */
static void widen(struct separate *s)
{
	double middle = 0.5 * (s->scene.delta_min + s->scene.delta_max);
	double half = fmax(WIDE * (s->cal.transit + middle), 0.05 * s->cal.duration);

	s->scene.delta_min = fmax(middle - half, -LEAST * s->cal.transit);
	s->scene.delta_max = middle + half;
}

/* The range of the last delays, widened by half on either side, as it was learned. */
static void follow_delay(struct separate *s, double delay)
{
	size_t n;
	double lo = INFINITY, hi = -INFINITY;

	s->delay[s->delays++ % TRACKED] = delay;
	n = s->delays < TRACKED ? s->delays : TRACKED;
	for (size_t i = 0; i < n; i++) {
		lo = fmin(lo, s->delay[i]);
		hi = fmax(hi, s->delay[i]);
	}
	calibration_widen(s->cal.duration, &lo, &hi);
	if (n < ENOUGH) { /* it was learned from others */
		lo = fmin(s->scene.delta_min, lo);
		hi = fmax(s->scene.delta_max, hi);
	}
	s->scene.delta_min = fmax(lo, -LEAST * s->cal.transit);
	s->scene.delta_max = hi;
	validation_range(s->validation, s->scene.delta_min, s->scene.delta_max);
}

/* The gain stays until the last GAINS pulses say, by three standard errors of their mean,
 * that it has changed; then it is theirs. */
static void follow_gain(struct separate *s, const struct joint_pulse *p)
{
	double share, se, sum = 0;

	joint_gain_error(s->joint, p, &share, &se);
	if (!(se > 0) || isinf(se))
		return;
	s->gain_off[s->gains++ % GAINS] = share / se;
	s->gain_sum += share / (se * se);
	s->gain_weight += 1 / (se * se);
	if (s->gains % GAINS)
		return;
	for (int i = 0; i < GAINS; i++)
		sum += s->gain_off[i];
	if (fabs(sum) > 3 * sqrt(GAINS))
		s->scene.gain *= 1 + s->gain_sum / s->gain_weight;
	s->gain_sum = s->gain_weight = 0;
}

/* What a pulse that stands alone tells of the instrument. */
static void follow(struct separate *s, const struct account *a)
{
	if (a->m != 1 || a->goodness.stretch != SEPARATE_ALONE)
		return;
	if (is_range_free(s))
		follow_delay(s, a->pulse[0].delta);
	if (isnan(s->par.known.gain))
		follow_gain(s, &a->pulse[0]);
}

/* Fits a window from the first a->m pulses of a, and judges the fit. */
static enum separate_status fit_window(
	struct separate *s, long long from, size_t n, int cut, struct account *a)
{
	enum joint_status status = joint_fit(s->joint, &s->scene, channel_1(s, from),
		channel_2(s, from), n, a->pulse, &a->m, &a->r);

	if (status != JOINT_OK)
		return status == JOINT_MEMORY ? SEPARATE_MEMORY : SEPARATE_WIDE;
	s->counters.fits++;
	s->counters.steps += (double)a->r.steps;
	s->counters.searches += (double)a->r.searches;
	memcpy(s->pulse, a->pulse, sizeof s->pulse);
	a->boundary = cut ? choose_cut(s, a->m, n) : INFINITY;
	a->done = 0;
	while (a->done < a->m && a->pulse[a->done].t < a->boundary)
		a->done++;
	goodness_of_fit(s->joint, &s->scene, n, a->pulse, a->m, a->done, a->boundary,
		s->cal.chi2 < 4 || s->cal.dense, &a->r, &a->goodness);
	return SEPARATE_OK;
}

static int is_described(const struct account *a)
{
	return a->goodness.stretch < SEPARATE_MISFIT;
}

/* Pulses of a rival per duration of a pulse.  Three parameters of each describe
 * anything once they are as many as the values of two channels in the band of a pulse,
 * up to 1.5 / T: two. */
static const double MOST = 1;

/* Where pulses do not describe a window: impulses beside the pulses, other velocities,
 * pulses of either sign, or those with impulses; without more pulses. */
static enum separate_status try_rivals(
	struct separate *s, long long from, size_t n, int cut, struct account *a)
{
	enum { IMPULSES, VELOCITIES, SIGNS, BOTH, RIVALS };
	const struct joint_scene plain = s->scene;
	enum separate_status status = SEPARATE_OK;
	int found = 0, most, tried;

	most = (int)fmin(a->m, fmax(MOST * (double)n / s->cal.duration, 1));
	if (cut && a->m > 2 * most)
		return SEPARATE_OK; /* a crowd */
	tried = 2 * most < plain.max_pulses ? 2 * most : plain.max_pulses;
	if (room_for(&s->spikes, &s->spike_room, 2 * n, sizeof *s->spikes))
		return SEPARATE_MEMORY;
	for (int k = 0; k < RIVALS && status == SEPARATE_OK && !found; k++) {
		struct account rival = { .m = 0 };

		s->scene = plain;
		s->scene.max_pulses = tried;
		if (k == VELOCITIES && !is_range_free(s))
			continue;
		if (k == VELOCITIES)
			widen(s);
		s->scene.signs = k >= SIGNS;
		if ((k == IMPULSES || k == BOTH) &&
			(s->cal.whitening.tap || !hide_spikes(s, from, n)))
			continue;
		status = fit_window(s, from, n, cut, &rival);
		found = status == SEPARATE_OK && is_described(&rival) && rival.m <= most;
		if (found)
			*a = rival;
	}
	s->scene = plain;
	if (found) {
		s->all = joint_delay_covariance(s->joint, s->delay_cov);
		follow(s, a);
	}
	memcpy(s->pulse, a->pulse, sizeof s->pulse);
	return status;
}

/* Fits the m pulses of a window to both components; doubts them if more than noise is
 * left of the second. */
static enum separate_status fit_quadrature(
	struct separate *s, long long from, size_t n, int m, int done, struct goodness *j)
{
	const double *x[2] = { channel_1(s, from), channel_2(s, from) };
	double *v[2];
	int doubt;
	enum num_status status;

	s->with_both = 0;
	if (!s->par.quadrature)
		return SEPARATE_OK;
	quadrature_at(s, from, v);
	status = quadrature_fit(&s->quadrature, s->joint, &s->scene, x,
		(const double *const[]){ v[0], v[1] }, n, s->pulse, m, j->chi2, s->both,
		&doubt);
	if (status == NUM_MEMORY)
		return SEPARATE_MEMORY;
	s->with_both = status == NUM_OK;
	if (!doubt || j->stretch == SEPARATE_UNRESOLVED)
		return SEPARATE_OK;
	/* Without a pulse there is no row that could say so. */
	j->stretch = m > 0 ? SEPARATE_MISFIT : SEPARATE_UNRESOLVED;
	for (int i = 0; i < done; i++)
		j->pulse[i] = SEPARATE_MISFIT;
	return SEPARATE_OK;
}

/* Works off [from, to) by a joint fit.  With cut, the section goes on: pulses behind
 * the cut are carried into the next window, whose first sample is *next; from again if
 * a shorter one, or shot noise, is to be tried. */
static enum separate_status fit_section(
	struct separate *s, long long from, long long to, int cut, long long *next)
{
	struct account a = { .m = s->carried };
	enum separate_status status;
	int unresolved, shorter;
	long before = 0, after = 0;
	size_t n;

	/* The quiet samples beside a section tell that no pulse reaches there. */
	if (!s->par.quadrature) {
		before = s->continuing ? 0 : sections_aside(s->sections, 0);
		before = from - s->tape[0].begin < before
				 ? (long)(from - s->tape[0].begin)
				 : before;
		after = cut ? 0 : sections_aside(s->sections, 1);
		after = ready(s) - to < after ? (long)(ready(s) - to) : after;
	}
	n = (size_t)(to - from + before + after);
	s->scene.max_pulses = most_pulses(s, (size_t)(to - from));
	s->scene.quiet[0] = (double)before;
	s->scene.quiet[1] = (double)after;
	if (!s->par.quadrature)
		hide(s, from - before, n);
	if (a.m > s->scene.max_pulses)
		a.m = s->scene.max_pulses;
	memcpy(a.pulse, s->pulse, sizeof a.pulse);
	status = fit_window(s, from - before, n, cut, &a);
	if (status == SEPARATE_OK)
		s->all = joint_delay_covariance(s->joint, s->delay_cov);
	if (status == SEPARATE_OK && s->par.quadrature)
		status = fit_quadrature(s, from, n, a.m, a.done, &a.goodness);
	else if (status == SEPARATE_OK && is_described(&a))
		follow(s, &a);
	else if (status == SEPARATE_OK && !s->par.sources)
		status = try_rivals(s, from - before, n, cut, &a);
	for (int i = 0; i < a.m; i++)
		s->pulse[i].t -= (double)before;
	a.boundary -= (double)before;
	if (status != SEPARATE_OK)
		return status;
	unresolved = a.goodness.stretch == SEPARATE_UNRESOLVED && !s->par.sources;
	shorter = unresolved && (cut || a.r.full) &&
		  (double)(to - from) > 2 * shortest_window(s);
	if (shorter)
		s->span = (to - from) / 2;
	else
		s->failures = unresolved ? s->failures + 1 : 0;
	s->dense = unresolved && !shorter && (!cut || s->failures == PATIENCE);
	/* In a short section it is not their number that resists. */
	s->strange = s->dense && !cut && !s->continuing && !a.r.full;
	if (shorter || s->dense) {
		s->carried = 0;
		*next = from;
		return SEPARATE_OK;
	}
	if (unresolved) {
		if (dense_section(s, from, from + (long long)a.boundary) != SEPARATE_OK)
			return SEPARATE_MEMORY;
	} else if (give_pulses(s, from, to, a.m, a.done, &a.goodness) != SEPARATE_OK) {
		return SEPARATE_MEMORY;
	}
	s->counters.singles += !cut && a.m == 1 && !s->continuing;
	*next = to;
	if (cut)
		*next = cut_section(s, from, a.boundary, a.m, a.done);
	else
		s->carried = 0;
	return SEPARATE_OK;
}

/* Arrival (zero crossing between the lobes) and amplitude of the one pulse in x. */
static void measure_pulse(const double *x, size_t n, double *t, double *a)
{
	size_t high = 0, low = 0;

	for (size_t i = 1; i < n; i++) {
		if (x[i] > x[high])
			high = i;
		if (x[i] < x[low])
			low = i;
	}
	*t = ((double)high + (double)low) / 2;
	*a = (x[high] - x[low]) / 2;
}

/* Holds the pulses that masks have found in n samples against those of a joint fit.  A
 * mask divides one pulse into several where the noise moves the points of its histogram,
 * and what a pulse of the fit does not stand beside, by a quarter of a duration, is none.
 */
static enum separate_status confirm(struct separate *s, long long from, size_t n,
	const double *t, int m, enum separate_verdict *verdict)
{
	struct joint_result r;
	int count = 0, taken[JOINT_PULSES_MAX] = { 0 };
	enum joint_status status;

	s->scene.max_pulses = s->par.most_pulses;
	status = joint_fit(s->joint, &s->scene, channel_1(s, from), channel_2(s, from), n,
		s->pulse, &count, &r);
	if (status != JOINT_OK)
		return status == JOINT_MEMORY ? SEPARATE_MEMORY : SEPARATE_WIDE;
	s->counters.fits++;
	s->counters.steps += (double)r.steps;
	s->counters.searches += (double)r.searches;
	for (int k = 0; k < m; k++) {
		int best = -1;

		for (int i = 0; i < count; i++)
			if (!taken[i] &&
				(best < 0 || fabs(s->pulse[i].t - t[k]) <
						     fabs(s->pulse[best].t - t[k])))
				best = i;
		verdict[k] = m > 1 || count > 1 ? SEPARATE_OVERLAP : SEPARATE_ALONE;
		if (best >= 0 && fabs(s->pulse[best].t - t[k]) < s->cal.duration / 4)
			taken[best] = 1;
		else
			verdict[k] = SEPARATE_MISFIT;
	}
	return SEPARATE_OK;
}

/* Works off [from, to) by masks. */
static enum separate_status mask_section(struct separate *s, long long from, long long to)
{
	struct masks_source source[MASKS_SOURCES_MAX];
	size_t n = (size_t)(to - from);
	const double *y1 = channel_1(s, from);
	int m;
	double t[MASKS_SOURCES_MAX], a[MASKS_SOURCES_MAX];
	enum separate_verdict verdict[MASKS_SOURCES_MAX], all = SEPARATE_ALONE;
	enum separate_status status;

	if (masks_find(s->masks, y1, channel_2(s, from), n, source, &m) != NUM_OK ||
		!reserve_sources(s, (size_t)m * n))
		return SEPARATE_MEMORY;
	/* A single source needs no demixing. */
	if (m == 1)
		memcpy(s->source, y1, n * sizeof *y1);
	for (int k = 0; k < m && m > 1; k++)
		masks_separate(s->masks, k, s->source + (size_t)k * n);
	s->counters.singles += m == 1;
	s->counters.masks += m > 1;
	s->counters.masks_skipped += m == 1;
	for (int k = 0; k < m; k++) {
		double *x = s->source + (size_t)k * n;

		for (size_t i = 0; i < n; i++)
			x[i] *= s->cal.noise[0];
		measure_pulse(x, n, &t[k], &a[k]);
	}
	status = confirm(s, from, n, t, m, verdict);
	if (status != SEPARATE_OK)
		return status;
	for (int k = 0; k < m; k++) {
		struct entry *entry = queue_entry(s);
		struct transit *p;

		if (!entry)
			return SEPARATE_MEMORY;
		p = &entry->row;
		entry->evidence.fits = verdict[k] != SEPARATE_MISFIT;
		entry->evidence.group = ++s->group;
		p->section = s->number;
		p->sources = m;
		p->t1 = (double)from + t[k];
		p->t2 = p->t1 + (double)s->cal.shift + source[k].delta;
		p->amplitude = a[k];
		p->t1_se = p->t2_se = p->delay_se = p->amplitude_se = p->chi2 = NAN;
		p->correlation = p->phase = p->phase_se = NAN;
		p->verdict = verdict[k];
		all = verdict[k] > all ? verdict[k] : all;
		s->counters.rows++;
	}
	report_section(s, from, to, m, NAN, all, s->source);
	return SEPARATE_OK;
}

/* Pulses per duration that are not worth a try. */
static const double CROWD = 2.5;

/* Are there too many throughout, by what the voltage of the first stretch tells?  That is
 * the least they can be. */
static int is_crowded(struct separate *s, long long from, long long to)
{
	struct campbell c;

	campbell_estimate(channel_1(s, from), channel_2(s, from), (size_t)(to - from),
		s->cal.shape, s->cal.duration, s->scene.gain, &c);
	return (c.rate - c.rate_se) * s->cal.duration > CROWD;
}

/* Samples that the noise is measured from at once. */
enum { LEVEL_BLOCK = 4096 };

/* Measures the noise of both channels once they are clean, until as many samples as are
 * learned from have shown it. */
static void measure_level(struct separate *s)
{
	static const int order = 4;
	double work[LEVEL_BLOCK];
	long long clean =
		s->tape[0].clean < s->tape[1].clean ? s->tape[0].clean : s->tape[1].clean;

	while (s->levels < (double)s->par.learn) {
		long long n = clean - s->level_at;

		if (n < (s->ended ? SEPARATE_SHORTEST : LEVEL_BLOCK))
			return;
		n = n < LEVEL_BLOCK ? n : LEVEL_BLOCK;
		for (int c = 0; c < 2; c++) {
			const struct tape *t = &s->tape[c];
			double level = robust_noise(
				t->x + (s->level_at - t->begin), (size_t)n, order, work);

			s->level[c] += (level - s->level[c]) * (double)n /
				       (s->levels + (double)n);
		}
		s->levels += (double)n;
		s->level_at += n;
	}
	s->level_at = clean;
}

/* Relative standard error of robust_noise() of order 4 from n samples: 1.17 / sqrt(n) of
 * a median of independent ones, whose correlations rho_k in fourth differences (-0.8,
 * 0.4, -0.11, 0.01) leave n / (1 + 2 sum rho_k^2). */
static double level_error(double n)
{
	return 1.17 * sqrt(2.63 / n);
}

void separate_noise(const struct separate *s, double share[2])
{
	for (int c = 0; c < 2; c++)
		share[c] = s->kept.level[c] > 0 ? s->level[c] / s->kept.level[c] : 1;
}

static int is_other_noise(const struct separate *s)
{
	/* A quarter of chi-square: at 1e-9 per sample 25 times more or fewer false
	 * alarms (a threshold of 33 becomes 26.4), standard errors wrong by an eighth. */
	static const double tolerance = 0.118;
	double share[2], margin;

	if (!(s->levels > 0))
		return 0;
	margin = 5 * hypot(level_error(s->levels), level_error(s->kept.level_samples));
	separate_noise(s, share);
	return !(fmax(fabs(log(share[0])), fabs(log(share[1]))) < tolerance + margin);
}

int separate_instrument(const struct separate *s, struct instrument *view)
{
	if (!s->calibrated || s->holding || !s->looked)
		return 0;
	*view = (struct instrument){ .cal = s->cal,
		.crowded = s->crowded,
		.level = { s->level[0], s->level[1] },
		.level_samples = s->levels };
	validation_flow(s->validation, &view->flow);
	return 1;
}

static enum num_status measure_quadrature(struct separate *s, long long upto)
{
	const double *x[2] = { channel_1(s, s->done), channel_2(s, s->done) };
	double *v[2];

	quadrature_at(s, s->done, v);
	return quadrature_measure(&s->quadrature, x,
		(const double *const[]){ v[0], v[1] }, (size_t)(upto - s->done));
}

static enum num_status scan(struct separate *s, long long limit)
{
	const double *y[2] = { channel_1(s, s->done), channel_2(s, s->done) };
	double *v[2] = { NULL, NULL }, scale = 0;

	if (s->par.quadrature) {
		quadrature_at(s, s->done, v);
		scale = 1 / quadrature_noise(&s->quadrature);
	}
	return sections_scan_quadrature(s->sections, y,
		s->par.quadrature ? (const double *const[]){ v[0], v[1] } : NULL, scale,
		s->done, (size_t)(limit - s->done),
		s->ended ? limit : limit - sections_reach(s->sections));
}

/* Works off all sections that are whole. */
static enum separate_status work(struct separate *s)
{
	long long limit, longest, keep;
	struct section section;

	for (int c = 0; c < 2; c++)
		if (tape_prepare(&s->tape[c], &s->cal, c, s->ended) != NUM_OK)
			return SEPARATE_MEMORY;
	if (s->par.quadrature &&
		quadrature_prepare(&s->quadrature, &s->cal, s->ended) != NUM_OK)
		return SEPARATE_MEMORY;
	measure_level(s);
	limit = ready(s);
	if (limit <= s->done)
		return SEPARATE_OK;
	if (!s->looked || s->par.quadrature > s->quadrature.measured) {
		/* Always the same stretch, however the record comes in. */
		long long upto = s->done + (long long)s->par.learn / 2;

		if (limit < upto && !s->ended)
			return SEPARATE_OK;
		upto = limit < upto ? limit : upto;
		if (!s->looked)
			s->crowded = !s->par.sources && is_crowded(s, s->done, upto);
		s->looked = 1;
		if (s->par.quadrature && measure_quadrature(s, upto) != NUM_OK)
			return SEPARATE_MEMORY;
	}
	if (scan(s, limit) != NUM_OK)
		return SEPARATE_MEMORY;
	if (s->ended)
		sections_end(s->sections);
	while (sections_first(s->sections, &section)) {
		long long from = section.begin > 0 ? section.begin : 0, to = section.end,
			  next;
		int cut;
		enum separate_status status;

		longest = s->dense  ? (long long)s->par.learn
			  : s->span ? s->span
				    : (long long)s->par.window;
		cut = to - from > longest;
		if (cut)
			to = from + longest;
		if (!s->ended && (to > limit || sections_scanned(s->sections) < to))
			break;
		if (!cut && section.open)
			break;
		if (to > limit)
			to = limit;
		if (to - from < 2) {
			sections_take(s->sections, section.end);
			continue;
		}
		if (!s->continuing) {
			s->number++;
			s->counters.sections++;
		}
		if (s->holding && from >= s->hold) {
			s->holding = 0;
			if (judge_rows(s) != SEPARATE_OK)
				return SEPARATE_MEMORY;
		}
		next = to;
		s->dense |= cut && s->crowded && s->par.method == SEPARATE_FIT;
		if (s->dense)
			status = dense_section(s, from, to);
		else if (s->par.method == SEPARATE_MASKS)
			status = mask_section(s, from, to);
		else
			status = fit_section(s, from, to, cut, &next);
		if (status == SEPARATE_OK && !s->holding)
			status = judge_rows(s);
		if (status != SEPARATE_OK)
			return status;
		s->counters.active += (double)(next - from);
		if (next == from) { /* the same again, shorter or as shot noise */
			s->continuing = 1;
			continue;
		}
		s->continuing = cut;
		s->dense = s->dense && cut;
		if (!cut)
			s->span = s->failures = 0;
		sections_take(s->sections, cut ? next : section.end);
	}
	s->done = sections_scanned(s->sections) - sections_reach(s->sections);
	if (sections_first(s->sections, &section) && section.begin < s->done)
		s->done = section.begin;
	if (s->done < 0)
		s->done = 0;
	keep = (s->done < s->level_at ? s->done : s->level_at) -
	       sections_reach(s->sections);
	for (int c = 0; c < 2; c++)
		tape_forget(&s->tape[c], keep);
	quadrature_forget(&s->quadrature, s->done);
	if (s->holding && (s->ended || s->done >= s->hold)) {
		s->holding = 0;
		return judge_rows(s);
	}
	return SEPARATE_OK;
}

/* Learns from the oldest samples held; where they hold no particle, half of them are
 * passed over and the next are tried. */
static enum separate_status learn(struct separate *s)
{
	size_t half = s->par.learn / 2;
	int first = 1;

	while (!s->calibrated && s->tape[0].n >= (s->ended && first ? 1 : s->par.learn)) {
		enum separate_status status = calibrate_now(s);

		first = 0;
		if (status != SEPARATE_OK && status != SEPARATE_NO_LAG &&
			status != SEPARATE_FAST && status != SEPARATE_HARD &&
			status != SEPARATE_AT_ONCE)
			return status;
		if (s->calibrated)
			break;
		s->reason = status;
		if (s->tape[0].n < s->par.learn)
			break;
		for (int c = 0; c < 2; c++)
			tape_drop(&s->tape[c], half);
		if (s->par.quadrature)
			quadrature_drop(&s->quadrature, half);
		s->counters.passed_over += (double)half;
	}
	return SEPARATE_OK;
}

/* Takes a kept instrument for that of the record. */
static enum separate_status start_kept(struct separate *s)
{
	return s->cal.duration >= SECTIONS_SHORTEST ? start(s, 0) : SEPARATE_FAST;
}

/* A channel of a kept instrument that stays constant as long as one would learn. */
static enum separate_status check_alive(struct separate *s, const double *x, size_t n)
{
	double before = s->counters.samples;

	for (size_t i = 0; i < 2 * n && before < (double)s->par.learn; i++) {
		if (before == 0 && i < 2)
			s->first[i] = x[i];
		s->varies[i % 2] |= x[i] != s->first[i % 2];
	}
	if (before + (double)n < (double)s->par.learn && !s->ended)
		return SEPARATE_OK;
	return !s->varies[0]   ? SEPARATE_SILENT_1
	       : !s->varies[1] ? SEPARATE_SILENT_2
			       : SEPARATE_OK;
}

enum separate_status separate_push(struct separate *s, const double *x, size_t n)
{
	return separate_push_quadrature(s, x, NULL, n);
}

enum separate_status separate_push_quadrature(
	struct separate *s, const double *x, const double *v, size_t n)
{
	enum separate_status status = SEPARATE_OK;

	for (size_t i = 0; i < 2 * n; i++)
		if (!isfinite(x[i])) {
			s->bad_frame =
				(long long)s->counters.samples + (long long)(i / 2);
			s->bad_channel = (int)(i % 2);
			return SEPARATE_NOT_FINITE;
		}
	if (tape_append(&s->tape[0], x, n) != NUM_OK ||
		tape_append(&s->tape[1], x + 1, n) != NUM_OK)
		return SEPARATE_MEMORY;
	if (v && quadrature_append(&s->quadrature, v, n) != NUM_OK)
		return SEPARATE_MEMORY;
	if (s->par.kept)
		status = check_alive(s, x, n);
	s->counters.samples += (double)n;
	if (!s->calibrated && status == SEPARATE_OK)
		status = s->par.kept ? start_kept(s) : learn(s);
	if (status != SEPARATE_OK)
		return status;
	return s->calibrated ? work(s) : status;
}

enum separate_status separate_end(struct separate *s)
{
	enum separate_status status = SEPARATE_OK;

	s->ended = 1;
	if (!s->calibrated)
		status = s->counters.samples < SEPARATE_SHORTEST ? SEPARATE_SHORT
								 : learn(s);
	if (status == SEPARATE_OK && s->par.kept)
		status = check_alive(s, NULL, 0);
	if (status != SEPARATE_OK)
		return status;
	return s->calibrated ? work(s) : s->reason;
}

/* A tenth of the rows, and more than two, that fit no particle are more than a few odd
 * ones: then the pulses are not what was learned, and other rows may be wrong, too. */
enum separate_doubt separate_doubtful(const struct separate *s)
{
	const struct separate_counters *c = &s->counters;

	if (s->par.kept && is_other_noise(s))
		return SEPARATE_NOISE;
	if (s->par.kept && c->rows > 2 && c->negative > 0.9 * c->rows)
		return SEPARATE_REVERSED;
	if (s->par.kept && !s->kept.crowded && 2 * c->dense > c->samples)
		return SEPARATE_CROWD;
	return c->misfits > 2 && 10 * c->misfits > c->rows + c->unresolved
		       ? SEPARATE_FOREIGN
		       : SEPARATE_BELIEVED;
}
