/* scene.c - pulses, noise, drift and lines of two sensors */
#include "signal/scene.h"
#include "num/normals.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	PIECE = 256, /* samples computed at a time */
	KNOTS = 32   /* straight pieces of the drift per correlation time */
};

/* Places in the noise stream: frame n of the noise is at n. */
static const uint64_t drift_place = (uint64_t)1 << 47, line_place = (uint64_t)1 << 63;

struct line {
	double frequency, level, phase[2];
};

struct scene {
	struct scene_par par;
	uint64_t frame; /* the next one */
	struct normals *normals;
	struct passage *list; /* particles whose pulses are not over */
	size_t count, room;
	double end, touched;
	struct line line[SCENE_LINES_MAX];
	double color[2];    /* state of the low-pass */
	uint64_t knot;      /* of the drift, to the left of the present frame */
	double drift[2][2]; /* [left, right knot][sensor] */
};

static double uniform(const struct scene *s, uint64_t place)
{
	return philox_uniform(s->par.seed, s->par.realisation, RNG_NOISE, place);
}

/* The drift is an Ornstein-Uhlenbeck process at its knots, straight between them. */
static void next_knot(struct scene *s)
{
	double keep = exp(-1.0 / KNOTS), n[2];

	normals_pair(s->normals, drift_place + s->knot + 2, n);
	for (int c = 0; c < 2; c++) {
		s->drift[0][c] = s->drift[1][c];
		s->drift[1][c] = keep * s->drift[0][c] +
				 sqrt(1 - keep * keep) * s->par.drift * n[c];
	}
	s->knot++;
}

struct scene *scene_new(const struct scene_par *par)
{
	struct scene *s = calloc(1, sizeof *s);
	double n[2];

	if (!s)
		return NULL;
	s->normals = normals_new(par->seed, par->realisation, RNG_NOISE);
	if (!s->normals) {
		free(s);
		return NULL;
	}
	s->par = *par;
	for (int i = 0; i < par->nlines; i++) {
		s->line[i] = (struct line){ par->line[i], par->line_level[i], { 0 } };
		for (int c = 0; c < 2; c++)
			s->line[i].phase[c] =
				uniform(s, line_place + 2 * (uint64_t)i + (uint64_t)c);
	}
	normals_pair(s->normals, drift_place, n);
	s->drift[1][0] = par->drift * n[0];
	s->drift[1][1] = par->drift * n[1];
	s->knot = UINT64_MAX; /* one before knot 0 */
	next_knot(s);
	return s;
}

void scene_free(struct scene *scene)
{
	if (!scene)
		return;
	normals_free(scene->normals);
	free(scene->list);
	free(scene);
}

int scene_pass(struct scene *s, const struct passage *p)
{
	double half = pulse_reach(s->par.shape) * s->par.length / p->velocity;

	if (s->count == s->room) {
		size_t room = s->room ? 2 * s->room : 64;
		struct passage *list = realloc(s->list, room * sizeof *list);

		if (!list)
			return 0;
		s->list = list;
		s->room = room;
	}
	s->list[s->count++] = *p;
	s->end = fmax(s->end, fmax(p->time[0], p->time[1]) + half);
	return 1;
}

/* Adds the part of one pulse that lies in the n frames from the present one; returns 1
 * while more of it is to come. */
static int add_pulse(
	struct scene *s, const struct passage *p, int sensor, double *x, size_t n)
{
	double T = s->par.length / p->velocity * s->par.rate, value[PIECE];
	double t0 = p->time[sensor] * s->par.rate;
	double level = sensor_voltage(s->par.kappa, p->velocity, p->diameter) *
		       (sensor ? s->par.gain : 1);
	size_t width;
	long first = pulse_support(s->par.shape, t0, T, &width), now = (long)s->frame;
	long begin = first > now ? first : now;
	long end =
		first + (long)width < now + (long)n ? first + (long)width : now + (long)n;

	for (long t = begin; t < end; t += PIECE) {
		size_t m = end - t < PIECE ? (size_t)(end - t) : PIECE;
		double *y = x + 2 * (t - now) + sensor;

		pulse_sample(s->par.shape, t0, T, t, m, value, NULL, NULL);
		for (size_t i = 0; i < m; i++)
			y[2 * i] += level * value[i];
		s->touched += (double)m;
	}
	return first + (long)width > now + (long)n;
}

static void add_pulses(struct scene *s, double *x, size_t n)
{
	size_t kept = 0;

	for (size_t i = 0; i < s->count; i++) {
		struct passage p = s->list[i];
		int more = add_pulse(s, &p, 0, x, n);

		more |= add_pulse(s, &p, 1, x, n);
		if (more)
			s->list[kept++] = p;
	}
	s->count = kept;
}

/* Gives the noise of both sensors its correlation. */
static void correlate(double common, double *z, size_t n)
{
	double own = sqrt(1 - common * common);

	for (size_t i = 0; i < n; i++)
		z[2 * i + 1] = common * z[2 * i] + own * z[2 * i + 1];
}

/* One-pole low-pass of frames from the given one on, to the same variance. */
static void low_pass(struct scene *s, uint64_t frame, double *z, size_t n)
{
	double keep = exp(-2 * M_PI * s->par.corner / s->par.rate);
	double fresh = sqrt(1 - keep * keep), a = s->color[0], b = s->color[1];
	size_t i = 0;

	if (frame == 0) { /* the first one has the lasting variance */
		a = z[0];
		b = z[1];
		i = 1;
	}
	for (; i < n; i++) {
		z[2 * i] = a = keep * a + fresh * z[2 * i];
		z[2 * i + 1] = b = keep * b + fresh * z[2 * i + 1];
	}
	s->color[0] = a;
	s->color[1] = b;
}

static void add_noise(struct scene *s, double *x, size_t n)
{
	double z[2 * PIECE];
	size_t m;

	for (size_t i = 0; i < n; i += m) {
		m = n - i < PIECE ? n - i : PIECE;
		normals_pairs(s->normals, s->frame + i, m, z);
		if (s->par.common != 0)
			correlate(s->par.common, z, m);
		if (s->par.corner > 0)
			low_pass(s, s->frame + i, z, m);
		for (size_t k = 0; k < 2 * m; k++)
			x[2 * i + k] += s->par.noise * z[k];
	}
}

static void add_drift(struct scene *s, double *x, size_t n)
{
	double step =
		s->par.drift_time / KNOTS * s->par.rate; /* frames from knot to knot */

	for (size_t i = 0; i < n; i++) {
		double place = (double)(s->frame + i) / step - (double)s->knot;

		while (place >= 1) {
			next_knot(s);
			place = (double)(s->frame + i) / step - (double)s->knot;
		}
		for (int c = 0; c < 2; c++)
			x[2 * i + (size_t)c] += s->drift[0][c] +
						place * (s->drift[1][c] - s->drift[0][c]);
	}
}

/* Turns of a line since frame 0, without the whole ones; exact however late it is. */
static double turns(double frequency, double rate, double frame)
{
	double product = frequency * frame, rest = fma(frequency, frame, -product);

	return (fmod(product, rate) + rest) / rate;
}

static void add_line(const struct scene *s, const struct line *l, double *x, size_t n)
{
	double step = 2 * M_PI * l->frequency / s->par.rate, dc = cos(step),
	       ds = sin(step);

	for (int c = 0; c < 2; c++)
		for (size_t i = 0; i < n; i += PIECE) {
			double a = 2 * M_PI *
				   (turns(l->frequency, s->par.rate,
					    (double)(s->frame + i)) +
					   l->phase[c]);
			double re = l->level * cos(a), im = l->level * sin(a);

			for (size_t k = i; k < n && k < i + PIECE; k++) {
				double next = re * dc - im * ds;

				x[2 * k + (size_t)c] += im;
				im = im * dc + re * ds;
				re = next;
			}
		}
}

void scene_next(struct scene *s, double *x, size_t nframes)
{
	memset(x, 0, 2 * nframes * sizeof *x);
	add_pulses(s, x, nframes);
	if (s->par.noise > 0)
		add_noise(s, x, nframes);
	if (s->par.drift > 0)
		add_drift(s, x, nframes);
	for (int i = 0; i < s->par.nlines; i++)
		add_line(s, &s->line[i], x, nframes);
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
