/* joint.c - see joint.h */
#include "signal/fit/joint_state.h"
#include <stdlib.h>

/* Matched filter of the residual on every stride-th sample, per channel. */
static size_t filter_residual(struct joint *j, const struct joint_scene *s, size_t stride)
{
	size_t len, points = (j->n + stride - 1) / stride;
	long first = shape_support(s->shape, 0, s->duration, &len);

	shape_sample(s->shape, 0, s->duration, first, len, j->scratch, NULL, NULL);
	for (int c = 0; c < 2; c++)
		for (size_t k = 0; k < points; k++)
			j->filter[c][k] = dot_within(j->scratch, len, j->r[c], j->n,
				(long long)(k * stride) + first);
	return points;
}

/* The pulse that would reduce chi-square most, except near the positions tried before. */
static struct candidate search(struct joint *j, const struct joint_scene *s,
	const struct candidate *tried, int ntried)
{
	size_t stride = (size_t)shape_stride(s->duration);
	size_t points;
	double z = 0, least = 0, g = s->gain, norm = 1 / sqrt(joint_energy(s));
	long lo = (long)floor(s->delta_min / (double)stride);
	long hi = (long)ceil(s->delta_max / (double)stride), from, to;
	struct candidate best = { 0 };

	joint_project(j);
	points = filter_residual(j, s, stride);
	j->searches++;
	from = (long)ceil(fmax(arrival_limit(s, 0, j->n), 0) / (double)stride);
	to = (long)fmin(arrival_limit(s, 1, j->n) / (double)stride, (double)points - 1);
	for (long k = from; k <= to; k++) {
		for (long l = k + lo < 0 ? -k : lo; l <= hi && k + l < (long)points;
			l++) {
			double here = (j->filter[0][k] + g * j->filter[1][k + l]) * norm;
			int old = 0;

			least = fmin(least, here);
			if ((s->signs ? fabs(here) : here) <= fabs(z))
				continue;
			for (int i = 0; i < ntried && !old; i++)
				old = fabs((double)(k * (long)stride) - tried[i].t) <
					      0.15 * s->duration &&
				      fabs((double)(l * (long)stride) - tried[i].delta) <
					      0.15 * s->duration;
			if (old)
				continue;
			z = here;
			best.t = (double)(k * (long)stride);
			best.delta = clamp(
				(double)(l * (long)stride), s->delta_min, s->delta_max);
		}
	}
	best.z2 = z * z;
	j->negative |= !s->signs && -least > z && least * least > s->threshold_near;
	best.a = z * norm;
	return best;
}

/* 1 if there are more than the m pulses, and no room for them. */
static int are_more(struct joint *j, const struct joint_scene *s, int m)
{
	return m == s->max_pulses && search(j, s, NULL, 0).z2 > s->threshold;
}

static int by_time(const void *x, const void *y)
{
	const struct joint_pulse *p = x, *q = y;

	return p->t < q->t ? -1 : p->t > q->t;
}

static void finish(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int m, double chi2, int full,
	struct joint_result *result)
{
	double visible;

	qsort(pulses, (size_t)m, sizeof *pulses, by_time);
	joint_fill_covariance(j, s, pulses, m);
	joint_project(j);
	result->chi2 = chi2;
	visible = (double)(joint_visible(j, 0, 0, j->n) + joint_visible(j, 1, 0, j->n));
	result->dof = (long)((1 - s->lost) * visible - j->taken + 0.5) - PAR * m;
	if (result->dof < 1)
		result->dof = 1;
	result->full = full;
	result->negative = j->negative;
	result->steps = j->steps;
	result->searches = j->searches;
}

enum joint_status joint_fit(struct joint *j, const struct joint_scene *s,
	const double *y1, const double *y2, size_t n, struct joint_pulse *pulses, int *m,
	struct joint_result *result)
{
	enum { TRIES = 3 + JOINT_PULSES_MAX / 8 };
	enum joint_status status = joint_start(j, s, y1, y2, n, pulses, *m);
	struct candidate tried[TRIES];
	int failed = 0, full;
	double chi2;

	if (status != JOINT_OK)
		return status;
	chi2 = joint_fit_all(j, s, pulses, *m);
	do {
		while (failed < 3 + *m / 8 && *m < s->max_pulses) {
			struct candidate c = search(j, s, tried, failed);

			if (c.z2 < 0.3 * s->threshold_near)
				break;
			if (joint_try_pulse(j, s, pulses, m, &c, &chi2))
				failed = 0;
			else
				tried[failed++] = c;
		}
		chi2 = joint_fit_all(j, s, pulses, *m);
	} while (joint_split_pulses(j, s, pulses, m, &chi2));
	full = s->give_up && are_more(j, s, *m);
	if (!full) {
		joint_swap_pulses(j, s, pulses, *m, &chi2);
		joint_merge_pulses(j, s, pulses, m, &chi2);
		joint_prune(j, s, pulses, m, &chi2);
		chi2 = joint_fit_all(j, s, pulses, *m);
		full = are_more(j, s, *m);
	}
	finish(j, s, pulses, *m, chi2, full, result);
	return JOINT_OK;
}

enum joint_status joint_refine(struct joint *j, const struct joint_scene *s,
	const double *y1, const double *y2, size_t n, struct joint_pulse *pulses, int m,
	struct joint_result *result)
{
	enum joint_status status = joint_start(j, s, y1, y2, n, pulses, m);

	if (status == JOINT_OK)
		finish(j, s, pulses, m, joint_fit_all(j, s, pulses, m), 0, result);
	return status;
}
