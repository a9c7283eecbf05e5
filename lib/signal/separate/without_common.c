/* without_common.c - windows fitted again without the noise that both channels have in
 * common
 *
 * Noise that reaches both sensors at the same time is known from the other channel where
 * that records no pulse, or only pulses that have been fitted.  With r the correlation,
 * channel c less r times the residual of the other has noise of sqrt(1 - r^2) of its own.
 * Fitting a window and removing the noise in turn ends at the generalised least squares
 * fit of both channels: its normal equations are those of the fixed point.
 */
#include "num/dot.h"
#include "num/room.h"
#include "num/sigmas.h"
#include "signal/noise/common.h"
#include "signal/separate/separate_state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

void separate_clear_common(struct separate *s)
{
	shape_free(s->common.sharp);
	free(s->common.work);
}

enum num_status separate_set_common(struct separate *s, const double found[3])
{
	const struct shape *shape = s->cal.shape;
	struct common *c = &s->common;

	if (found[0] == 0)
		return NUM_OK;
	shape_free(c->sharp);
	c->sharp = shape_from_cubic(
		shape_reach(shape), shape_cells(shape), shape_cubic(shape));
	if (!c->sharp)
		return NUM_MEMORY;
	shape_scale(c->sharp, 1 / found[1]);
	c->correlation = found[0];
	c->left[0] = found[1];
	c->left[1] = found[2];
	return NUM_OK;
}

enum num_status separate_measure_common(
	struct separate *s, long long from, long long upto)
{
	const double *x[2] = { s->buffer[0].x + (from - s->buffer[0].begin),
		s->buffer[1].x + (from - s->buffer[1].begin) };
	size_t n = (size_t)(upto - from);
	double *work, found[3];

	if (has_quadrature(s) || isinf(s->cal.transit))
		return NUM_OK;
	work = malloc(2 * n * sizeof *work);
	if (!work)
		return NUM_MEMORY;
	common_measure(x, n, s->cal.duration, work, found);
	free(work);
	return separate_set_common(s, found);
}

/* Length of a pulse, samples. */
static long long pulse_length(const struct separate *s)
{
	return (long long)(2 * shape_reach(s->cal.shape) * s->cal.duration);
}

long long separate_common_reach(const struct separate *s)
{
	/* Of the noise beside the section, and of pulses that reach into it. */
	return s->common.correlation == 0 ? 0 : s->cal.shift + 2 * pulse_length(s);
}

/* 1 if the matched filter of the samples tells of no pulse; work holds one of them. */
static int is_noise(const struct separate *s, const double *x, size_t n, double *work)
{
	double T = s->cal.duration, norm = 1 / sqrt(T * shape_energy(s->cal.shape));
	size_t len;
	long first = shape_support(s->cal.shape, 0, T, &len);
	long stride = (long)fmax(T / 16, 1);

	shape_sample(s->cal.shape, 0, T, first, len, work, NULL, NULL);
	for (long at = first; at + (long)len + first <= (long)n - first; at += stride)
		if (fabs(dot_within(work, len, x, n, at)) * norm > SIGMAS_RARELY)
			return 0;
	return 1;
}

/* Subtracts pulses, whose times are shifted, from both channels. */
static void subtract(const struct separate *s, const struct joint_pulse *pulse, int m,
	double shift, double *const y[2], size_t n)
{
	for (int i = 0; i < m; i++) {
		struct joint_pulse p = pulse[i];

		p.t += shift;
		joint_add(&s->scene, &p, -1, y[0], y[1], n);
	}
}

/* Residual of the other channel during the window of channel c: less the pulses of this
 * window and those that are found there.  *noise: in y; NULL: it is not only noise, or
 * not known. */
static enum separate_status noise_beside(struct separate *s, int c,
	const struct account *a, double *y[2], double *work, const double **noise)
{
	long long from = a->from;
	size_t n = a->n;
	long long pad = pulse_length(s);
	long long at = from - pad + (c ? s->cal.shift : -s->cal.shift);
	size_t length = n + 2 * (size_t)pad;
	int other = 1 - c;

	*noise = NULL;
	for (int k = 0; k < 2; k++) {
		const struct buffer *t = &s->buffer[k];
		long long begin = at + (k ? s->cal.shift : 0);

		if (begin < t->begin || begin + (long long)length > t->clean ||
			memchr(t->hidden + (begin - t->begin), 1, length))
			return SEPARATE_OK;
		memcpy(y[k], t->x + (begin - t->begin), length * sizeof(double));
	}
	subtract(s, a->pulse, a->m, (double)(from - at), y, length);
	if (!is_noise(s, y[other] + pad, n, work)) {
		struct joint_scene around = s->scene;
		struct joint_pulse pulse[JOINT_PULSES_MAX];
		struct joint_result r;
		enum joint_status status;
		int m = 0;

		around.hidden[0] = around.hidden[1] = NULL;
		around.quiet[0] = around.quiet[1] = 0;
		around.tone_knot[0] += (double)(from - at);
		around.tone_knot[1] += (double)(from - at);
		around.max_pulses = s->par.most_pulses;
		around.signs = 1;
		status = joint_fit(s->joint, &around, y[0], y[1], length, pulse, &m, &r);
		if (status != JOINT_OK)
			return status == JOINT_MEMORY ? SEPARATE_MEMORY : SEPARATE_WIDE;
		subtract(s, pulse, m, 0, y, length);
	}
	if (is_noise(s, y[other] + pad, n, work))
		*noise = y[other] + pad;
	return SEPARATE_OK;
}

/* Fits, each of which takes the residual of the one before: what is left of the
 * difference to the last of such a chain is an eighth where half of the pulses of either
 * channel overlaps with those of the other. */
enum { ROUNDS = 3 };

/* The present scene for the pulses of a, none more. */
static void describe(struct separate *s, const struct account *a)
{
	s->scene.max_pulses = a->m;
	for (int i = 0; i < a->m; i++) {
		const struct joint_pulse *p = &a->pulse[i];

		s->scene.signs |= p->a < 0;
		s->scene.delta_min = fmin(s->scene.delta_min, p->delta);
		s->scene.delta_max = fmax(s->scene.delta_max, p->delta);
	}
}

/* One fit of the chain; *removed: 1 if it describes the window with the same number of
 * pulses, 0 if not or if nothing is known of the noise. */
static enum separate_status fit_once(struct separate *s, struct account *a, int *removed)
{
	const struct joint_scene plain = s->scene;
	size_t n = a->n, length = n + 2 * (size_t)pulse_length(s);
	double *work = s->common.work, *x[2] = { work, work + length };
	double *y[2] = { work + 2 * length, work + 3 * length }, left[2] = { 1, 1 };
	int m = a->m;
	enum separate_status status;

	for (int c = 0; c < 2; c++) {
		const double *noise;

		memcpy(x[c], channels_at(s, a->from).at[c], n * sizeof(double));
		status = noise_beside(s, c, a, y, work + 4 * length, &noise);
		if (status != SEPARATE_OK)
			return status;
		left[c] = noise ? s->common.left[c] : 1;
		for (size_t i = 0; noise && i < n; i++)
			x[c][i] = (x[c][i] - s->common.correlation * noise[i]) / left[c];
	}
	*removed = 0;
	if (left[0] == 1 && left[1] == 1)
		return SEPARATE_OK;
	if (left[0] < 1)
		s->scene.shape = s->common.sharp;
	s->scene.gain *= left[0] / left[1];
	status = separate_fit_window(s, (const double *const[]){ x[0], x[1] }, a);
	s->scene = plain;
	*removed = a->m == m && separate_is_described(a);
	return status;
}

enum separate_status separate_fit_without_common(struct separate *s, struct account *a)
{
	const struct joint_scene plain = s->scene;
	size_t length = a->n + 2 * (size_t)pulse_length(s);
	struct account better = *a;
	enum separate_status status = SEPARATE_OK;
	int removed = 1;

	if (s->common.correlation == 0 || a->m == 0)
		return SEPARATE_OK;
	if (room_for(&s->common.work, &s->common.room, 5 * length, sizeof(double)))
		return SEPARATE_MEMORY;
	describe(s, a);
	for (int k = 0; k < ROUNDS && removed && status == SEPARATE_OK; k++)
		status = fit_once(s, &better, &removed);
	if (status == SEPARATE_OK && removed)
		*a = better;
	else if (status == SEPARATE_OK)
		status = separate_fit_window(s, channels_at(s, a->from).at, a);
	s->scene = plain;
	return status;
}
