/* separate.c - see separate.h */
#include "signal/separate/separate.h"
#include "signal/detect/sections.h"
#include "signal/fit/judge.h"
#include "signal/noise/robust.h"
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
	int carried;    /* pulses of the last window that the next one starts from */
	long long span; /* longest window in this section; 0: as given */
	int failures;   /* windows unresolved, one after the other */
	int dense;      /* the rest of this section is not taken apart */
	int strange;    /* ... though it is short */
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
	for (size_t i = 0; i < s->reports; i++)
		free(s->report[i].source);
	free(s->report);
	validation_free(s->validation);
	free(s->queue);
	free(s->source);
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
	static const enum separate_status of[] = { SEPARATE_OK, SEPARATE_MEMORY,
		SEPARATE_NO_LAG, SEPARATE_SILENT_1, SEPARATE_SILENT_2, SEPARATE_NO_LAG,
		SEPARATE_SWAPPED, SEPARATE_FAR, SEPARATE_NARROW, SEPARATE_FAST,
		SEPARATE_SLOW, SEPARATE_TONES };
	enum calibrate_status status;
	size_t n;

	if (s->tape[0].n < SEPARATE_SHORTEST)
		return SEPARATE_NO_LAG;
	/* Not more than asked for, however much has come in at once. */
	n = s->tape[0].n < s->par.learn ? s->tape[0].n : s->par.learn;
	status = calibrate(&s->par.known, s->tape[0].x, s->tape[1].x, n, &s->cal);
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

/* Aligned samples before this one are ready on both channels. */
static long long ready(const struct separate *s)
{
	long long second = s->tape[1].clean - s->cal.shift;

	return s->tape[0].clean < second ? s->tape[0].clean : second;
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
	out->chi2 = chi2;
	out->verdict = verdict;
	entry->evidence = (struct evidence){ .group = s->group,
		.fits = verdict != SEPARATE_MISFIT,
		.delay = p->delta,
		.var = isinf(s->cal.transit) || !isfinite(delay_var) ? 0 : delay_var,
		.amplitude = p->a };
	s->counters.rows++;
	return 1;
}

/* The larger pulse nearest to pulse i that overlaps it, or -1. */
static int larger_neighbour(const struct separate *s, int m, int i)
{
	const struct joint_pulse *p = s->pulse;
	double nearest = 2 * s->cal.duration;
	int found = -1;

	for (int k = 0; k < m; k++)
		if (p[k].a > p[i].a && fabs(p[k].t - p[i].t) < nearest) {
			nearest = fabs(p[k].t - p[i].t);
			found = k;
		}
	return found;
}

/* What the last m rows, of one fit, tell of each other. */
static void compare_pulses(struct separate *s, int m)
{
	double cov[JOINT_PULSES_MAX * JOINT_PULSES_MAX];
	struct entry *entry = s->queue + s->count - m;
	const struct joint_pulse *p = s->pulse;
	int all = joint_delay_covariance(s->joint, cov);

	for (int i = 0; i < m && all >= m && !isinf(s->cal.transit); i++) {
		struct evidence *e = &entry[i].evidence;
		int k = larger_neighbour(s, m, i);

		if (k < 0)
			continue;
		e->partner = k - i;
		e->apart = p[i].delta - p[k].delta;
		e->apart_var = cov[i * all + i] + cov[k * all + k] - 2 * cov[i * all + k];
		e->place = (p[i].t - p[k].t) / s->cal.duration;
		e->height = p[i].a / p[k].a;
	}
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
	p->t1 = (double)from + length / 2;
	p->t2 = p->t1 + (double)s->cal.shift;
	p->amplitude = c.amplitude;
	p->amplitude_se = c.amplitude_se;
	p->t1_se = p->t2_se = length / sqrt(12);
	p->delay_se = p->correlation = p->chi2 = NAN;
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
	int m, int done, const struct judgement *j)
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
	compare_pulses(s, done);
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

/* Works off [from, to) by a joint fit.  With cut, the section goes on: pulses behind
 * the cut are carried into the next window, whose first sample is *next; from again if
 * a shorter one, or shot noise, is to be tried. */
static enum separate_status fit_section(
	struct separate *s, long long from, long long to, int cut, long long *next)
{
	struct joint_result r;
	size_t n = (size_t)(to - from);
	double boundary;
	struct judgement judgement;
	enum joint_status status;
	int m = s->carried, done = 0, unresolved, shorter;

	s->scene.max_pulses = most_pulses(s, n);
	if (m > s->scene.max_pulses)
		m = s->scene.max_pulses;
	status = joint_fit(s->joint, &s->scene, channel_1(s, from), channel_2(s, from), n,
		s->pulse, &m, &r);
	if (status != JOINT_OK)
		return status == JOINT_MEMORY ? SEPARATE_MEMORY : SEPARATE_WIDE;
	s->counters.fits++;
	s->counters.steps += (double)r.steps;
	s->counters.searches += (double)r.searches;
	boundary = cut ? choose_cut(s, m, n) : INFINITY;
	while (done < m && s->pulse[done].t < boundary)
		done++;
	judge(s->joint, &s->scene, n, s->pulse, m, done, boundary,
		s->cal.chi2 < 4 || s->cal.dense, &r, &judgement);
	unresolved = judgement.stretch == SEPARATE_UNRESOLVED && !s->par.sources;
	shorter = unresolved && r.full && (double)n > 2 * shortest_window(s);
	if (shorter)
		s->span = (to - from) / 2;
	else
		s->failures = unresolved ? s->failures + 1 : 0;
	s->dense = unresolved && !shorter && (!cut || s->failures == PATIENCE);
	/* In a short section it is not their number that resists. */
	s->strange = s->dense && !cut && !s->continuing && !r.full;
	if (shorter || s->dense) {
		s->carried = 0;
		*next = from;
		return SEPARATE_OK;
	}
	if (unresolved) {
		if (dense_section(s, from, from + (long long)boundary) != SEPARATE_OK)
			return SEPARATE_MEMORY;
	} else if (give_pulses(s, from, to, m, done, &judgement) != SEPARATE_OK) {
		return SEPARATE_MEMORY;
	}
	s->counters.singles += !cut && m == 1 && !s->continuing;
	*next = to;
	if (cut)
		*next = cut_section(s, from, boundary, m, done);
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
		p->correlation = NAN;
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

/* Works off all sections that are whole. */
static enum separate_status work(struct separate *s)
{
	long long limit, longest;
	struct section section;

	for (int c = 0; c < 2; c++)
		if (tape_prepare(&s->tape[c], &s->cal, c, s->ended) != NUM_OK)
			return SEPARATE_MEMORY;
	measure_level(s);
	limit = ready(s);
	if (limit <= s->done)
		return SEPARATE_OK;
	if (!s->looked) {
		/* Always the same stretch, however the record comes in. */
		long long upto = s->done + (long long)s->par.learn / 2;

		if (limit < upto && !s->ended)
			return SEPARATE_OK;
		s->crowded = !s->par.sources &&
			     is_crowded(s, s->done, limit < upto ? limit : upto);
		s->looked = 1;
	}
	if (sections_scan(s->sections, channel_1(s, s->done), channel_2(s, s->done),
		    s->done, (size_t)(limit - s->done),
		    s->ended ? limit : limit - sections_reach(s->sections)) != NUM_OK)
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
	for (int c = 0; c < 2; c++)
		tape_forget(&s->tape[c], s->done < s->level_at ? s->done : s->level_at);
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
			status != SEPARATE_FAST)
			return status;
		if (s->calibrated)
			break;
		s->reason = status;
		if (s->tape[0].n < s->par.learn)
			break;
		for (int c = 0; c < 2; c++)
			tape_drop(&s->tape[c], half);
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
	if (s->par.kept && !s->kept.crowded && 2 * c->dense > c->samples)
		return SEPARATE_CROWD;
	return c->misfits > 2 && 10 * c->misfits > c->rows + c->unresolved
		       ? SEPARATE_FOREIGN
		       : SEPARATE_BELIEVED;
}
