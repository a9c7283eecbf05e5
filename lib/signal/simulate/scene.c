/* scene.c - pulses, noise, drift and lines of two sensors */
#include "signal/simulate/scene.h"
#include "num/normals.h"
#include "num/room.h"
#include "signal/simulate/wander.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PIECE = 256 }; /* samples computed at a time */

/* Places in the noise stream: frame n of the noise is at n, of the quadrature at n plus
 * an offset; likewise the drift. */
static const uint64_t quadrature_place = (uint64_t)1 << 46,
		      line_place = (uint64_t)1 << 63;
static const uint64_t drift_place = (uint64_t)1 << 47, gain_place = (uint64_t)5 << 45,
		      mains_place = (uint64_t)6 << 45;

struct line {
	double frequency, level, multiple, phase[2];
};

/* One channel of either sensor: in phase or in quadrature. */
struct half {
	uint64_t place;  /* of its noise */
	double color[2]; /* state of the low-pass */
	struct wander drift;
	struct line line[SCENE_LINES_MAX];
};

/* A particle whose pulses are not over: its response as the demodulator sees it, and its
 * peaks at either sensor, V. */
struct pending {
	struct passage p;
	double level[2];
};

struct scene {
	struct scene_par par;
	uint64_t frame; /* the next one */
	struct normals *normals;
	struct pending *list;
	size_t count, room;
	struct disturbance *event;
	size_t events, event_room;
	double end, touched;
	struct wander gain; /* of sensor 2 over sensor 1, and phase */
	struct wander mains;
	double turned; /* turns of the mains beyond those of its frequency */
	struct half half[2];
};

static double uniform(const struct scene *s, uint64_t place)
{
	return philox_uniform(s->par.seed, s->par.realisation, RNG_NOISE, place);
}

static void start_half(struct scene *s, int q)
{
	struct half *h = &s->half[q];
	uint64_t lines = line_place + (q ? 2 * SCENE_LINES_MAX : 0);

	h->place = q ? quadrature_place : 0;
	for (int i = 0; i < s->par.nlines; i++) {
		h->line[i] = (struct line){ s->par.line[i], s->par.line_level[i],
			s->par.multiple[i], { 0 } };
		for (int c = 0; c < 2; c++)
			h->line[i].phase[c] =
				uniform(s, lines + 2 * (uint64_t)i + (uint64_t)c);
	}
	wander_start(&h->drift, s->normals, drift_place + h->place, s->par.drift_time);
}

struct scene *scene_new(const struct scene_par *par)
{
	struct scene *s = calloc(1, sizeof *s);

	if (!s)
		return NULL;
	s->normals = normals_new(par->seed, par->realisation, RNG_NOISE);
	if (!s->normals) {
		free(s);
		return NULL;
	}
	s->par = *par;
	start_half(s, 0);
	start_half(s, 1);
	wander_start(&s->gain, s->normals, gain_place, par->drift_time);
	wander_start(&s->mains, s->normals, mains_place, par->drift_time);
	return s;
}

void scene_free(struct scene *scene)
{
	if (!scene)
		return;
	normals_free(scene->normals);
	free(scene->list);
	free(scene->event);
	free(scene);
}

/* Demodulator and gain of sensor 2 at the time of the particle. */
static struct pending receive(struct scene *s, const struct passage *p)
{
	double phase, re = p->response[0], im = p->response[1];
	double level = sensor_voltage(s->par.kappa, p->velocity, p->diameter);
	struct pending e = { *p, { level, level * s->par.gain } };

	if (s->par.gain_drift > 0 || s->par.phase_drift > 0)
		wander_move(&s->gain, fmax(p->time[0], 0));
	phase = s->par.phase + s->par.phase_drift * wander_value(&s->gain, 1);
	e.p.response[0] = re * cos(phase) - im * sin(phase);
	e.p.response[1] = re * sin(phase) + im * cos(phase);
	e.level[1] *= 1 + s->par.gain_drift * wander_value(&s->gain, 0);
	return e;
}

int scene_receive(struct scene *s, const struct passage *p, double peak[2])
{
	struct pending e = receive(s, p);
	double most = fmax(e.level[0], fabs(e.level[1])), r = fabs(e.p.response[0]);

	if (s->par.quadrature)
		r = fmax(r, fabs(e.p.response[1]));
	for (int q = 0; q < 2; q++)
		peak[q] = e.level[0] * e.p.response[q];
	return s->par.saturation > 0 && most * r > s->par.saturation;
}

enum num_status scene_pass(struct scene *s, const struct passage *p)
{
	double half = pulse_reach(s->par.shape) * s->par.length / p->velocity;

	if (room_for(&s->list, &s->room, s->count + 1, sizeof *s->list))
		return NUM_MEMORY;
	s->list[s->count++] = receive(s, p);
	s->end = fmax(s->end, fmax(p->time[0], p->time[1]) + half);
	return NUM_OK;
}

enum num_status scene_disturb(struct scene *s, const struct disturbance *event)
{
	if (room_for(&s->event, &s->event_room, s->events + 1, sizeof *s->event))
		return NUM_MEMORY;
	s->event[s->events++] = *event;
	s->end = fmax(s->end, event->end);
	return NUM_OK;
}

/* Samples of one frame, and which of them is of this sensor, in quadrature or not. */
static size_t channels(const struct scene *s)
{
	return s->par.quadrature ? 4 : 2;
}

static size_t channel(const struct scene *s, int sensor, int q)
{
	return (size_t)(s->par.quadrature ? 2 * sensor + q : sensor);
}

/* Adds the part of one pulse that lies in the n frames from the present one; returns 1
 * while more of it is to come. */
static int add_pulse(
	struct scene *s, const struct pending *e, int sensor, double *x, size_t n)
{
	double T = s->par.length / e->p.velocity * s->par.rate, value[PIECE];
	double t0 = e->p.time[sensor] * s->par.rate;
	size_t width, stride = channels(s);
	long first = pulse_support(s->par.shape, t0, T, &width), now = (long)s->frame;
	long begin = first > now ? first : now;
	long end =
		first + (long)width < now + (long)n ? first + (long)width : now + (long)n;

	for (long t = begin; t < end; t += PIECE) {
		size_t m = end - t < PIECE ? (size_t)(end - t) : PIECE;

		pulse_sample(s->par.shape, t0, T, t, m, value, NULL, NULL);
		for (int q = 0; q <= s->par.quadrature; q++) {
			double *y =
				x + stride * (size_t)(t - now) + channel(s, sensor, q);
			double level = e->level[sensor] * e->p.response[q];

			for (size_t i = 0; i < m; i++)
				y[stride * i] += level * value[i];
		}
		s->touched += (double)m;
	}
	return first + (long)width > now + (long)n;
}

static void add_pulses(struct scene *s, double *x, size_t n)
{
	size_t kept = 0;

	for (size_t i = 0; i < s->count; i++) {
		struct pending e = s->list[i];
		int more = add_pulse(s, &e, 0, x, n);

		more |= add_pulse(s, &e, 1, x, n);
		if (more)
			s->list[kept++] = e;
	}
	s->count = kept;
}

/* The frames of an event among the n from the present one. */
static void event_frames(const struct scene *s, const struct disturbance *e, size_t n,
	size_t *from, size_t *to)
{
	double now = (double)s->frame, begin = ceil(e->begin * s->par.rate) - now;
	double end = ceil(e->end * s->par.rate) - now;

	*from = begin > 0 ? (size_t)fmin(begin, (double)n) : 0;
	*to = end > 0 ? (size_t)fmin(end, (double)n) : 0;
}

/* What shakes or charges a sensor does so in and out of phase. */
static void add_event(
	const struct scene *s, const struct disturbance *e, double *x, size_t n)
{
	size_t from, to, stride = channels(s);

	event_frames(s, e, n, &from, &to);
	for (int c = 0; c < 2; c++)
		for (size_t i = from; i < to; i++) {
			double t = (double)(s->frame + i) / s->par.rate;
			double y = disturbance_value(e, c, t);

			for (int q = 0; q <= s->par.quadrature; q++)
				x[stride * i + channel(s, c, q)] += y;
		}
}

/* Dropouts hide all else; what is past is forgotten. */
static void drop_out(struct scene *s, double *x, size_t n)
{
	size_t kept = 0, stride = channels(s), from, to;

	for (size_t i = 0; i < s->events; i++) {
		struct disturbance e = s->event[i];

		event_frames(s, &e, n, &from, &to);
		if (e.kind == DISTURBANCE_DROPOUT && from < to)
			memset(x + stride * from, 0, stride * (to - from) * sizeof *x);
		if (e.end * s->par.rate > (double)(s->frame + n))
			s->event[kept++] = e;
	}
	s->events = kept;
}

/* Gives the noise of both sensors its correlation. */
static void correlate(double common, double *z, size_t n)
{
	double own = sqrt(1 - common * common);

	for (size_t i = 0; i < n; i++)
		z[2 * i + 1] = common * z[2 * i] + own * z[2 * i + 1];
}

/* One-pole low-pass of frames from the given one on, to the same variance. */
static void low_pass(
	const struct scene *s, struct half *h, uint64_t frame, double *z, size_t n)
{
	double keep = exp(-2 * M_PI * s->par.corner / s->par.rate);
	double fresh = sqrt(1 - keep * keep);

	for (size_t c = 0; c < 2; c++)
		for (size_t i = 0; i < n; i++) {
			/* the first one has the lasting variance */
			if (frame + i > 0)
				z[2 * i + c] = keep * h->color[c] + fresh * z[2 * i + c];
			h->color[c] = z[2 * i + c];
		}
}

static void add_noise(struct scene *s, int q, double *x, size_t n)
{
	struct half *h = &s->half[q];
	size_t m, stride = channels(s), c1 = channel(s, 0, q), c2 = channel(s, 1, q);
	double z[2 * PIECE];

	for (size_t i = 0; i < n; i += m) {
		m = n - i < PIECE ? n - i : PIECE;
		normals_pairs(s->normals, h->place + s->frame + i, m, z);
		if (s->par.common != 0)
			correlate(s->par.common, z, m);
		if (s->par.corner > 0)
			low_pass(s, h, s->frame + i, z, m);
		for (size_t k = 0; k < m; k++) {
			x[stride * (i + k) + c1] += s->par.noise * z[2 * k];
			x[stride * (i + k) + c2] += s->par.noise * z[2 * k + 1];
		}
	}
}

static void add_drift(struct scene *s, int q, double *x, size_t n)
{
	struct wander *drift = &s->half[q].drift;
	size_t stride = channels(s);

	for (size_t i = 0; i < n; i++) {
		wander_move(drift, (double)(s->frame + i) / s->par.rate);
		for (int c = 0; c < 2; c++)
			x[stride * i + channel(s, c, q)] +=
				s->par.drift * wander_value(drift, c);
	}
}

/* Turns of a line since frame 0, without the whole ones; exact however late it is. */
static double turns(double frequency, double rate, double frame)
{
	double product = frequency * frame, rest = fma(frequency, frame, -product);

	return (fmod(product, rate) + rest) / rate;
}

static double line_angle(const struct scene *s, const struct line *l, int c, size_t i)
{
	return 2 * M_PI *
	       (turns(l->frequency, s->par.rate, (double)(s->frame + i)) + l->phase[c]);
}

static void add_line(
	const struct scene *s, const struct line *l, int q, double *x, size_t n)
{
	double step = 2 * M_PI * l->frequency / s->par.rate, dc = cos(step),
	       ds = sin(step);
	size_t stride = channels(s);

	for (int c = 0; c < 2; c++)
		for (size_t i = 0; i < n; i += PIECE) {
			double a = line_angle(s, l, c, i);
			double re = l->level * cos(a), im = l->level * sin(a);

			for (size_t k = i; k < n && k < i + PIECE; k++) {
				double next = re * dc - im * ds;

				x[stride * k + channel(s, c, q)] += im;
				im = im * dc + re * ds;
				re = next;
			}
		}
}

/* The lines of mains whose frequency wanders. */
static void add_mains(struct scene *s, double *x, size_t n)
{
	size_t stride = channels(s);

	for (size_t i = 0; i < n; i++) {
		wander_move(&s->mains, (double)(s->frame + i) / s->par.rate);
		s->turned += s->par.wander * wander_value(&s->mains, 0) / s->par.rate;
		for (int k = 0; k < s->par.nlines; k++)
			for (int c = 0; c < 2; c++)
				for (int q = 0; q <= s->par.quadrature; q++) {
					const struct line *l = &s->half[q].line[k];
					double a = line_angle(s, l, c, i) +
						   2 * M_PI * l->multiple * s->turned;

					if (l->multiple > 0)
						x[stride * i + channel(s, c, q)] +=
							l->level * sin(a);
				}
	}
}

static void limit(double most, double *x, size_t n)
{
	for (size_t i = 0; i < n; i++)
		x[i] = fmax(-most, fmin(most, x[i]));
}

void scene_next(struct scene *s, double *x, size_t nframes)
{
	int wanders = s->par.wander > 0;

	memset(x, 0, channels(s) * nframes * sizeof *x);
	add_pulses(s, x, nframes);
	for (size_t i = 0; i < s->events; i++)
		add_event(s, &s->event[i], x, nframes);
	for (int q = 0; q <= s->par.quadrature; q++) {
		if (s->par.noise > 0)
			add_noise(s, q, x, nframes);
		if (s->par.drift > 0)
			add_drift(s, q, x, nframes);
		for (int i = 0; i < s->par.nlines; i++)
			if (!wanders || s->half[q].line[i].multiple == 0)
				add_line(s, &s->half[q].line[i], q, x, nframes);
	}
	if (wanders)
		add_mains(s, x, nframes);
	if (s->par.saturation > 0)
		limit(s->par.saturation, x, channels(s) * nframes);
	drop_out(s, x, nframes);
	s->frame += nframes;
}

double scene_end(const struct scene *scene)
{
	return scene->end;
}

double scene_touched(const struct scene *scene)
{
	return scene->touched;
}

size_t scene_pending(const struct scene *scene)
{
	return scene->count;
}
