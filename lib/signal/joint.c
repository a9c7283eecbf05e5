/* joint.c - see joint.h */
#include "signal/joint_state.h"
#include <stdlib.h>

/* Matched filter of the residual on every stride-th sample, per channel, for pulses that
 * last T. */
static size_t filter_residual(
	struct joint *j, const struct joint_scene *s, double T, size_t stride)
{
	size_t len, points = (j->n + stride - 1) / stride;

	for (int c = 0; c < 2; c++) {
		long first = shape_support(s->shape[c], 0, T, &len);

		shape_sample(s->shape[c], 0, T, first, len, j->scratch, NULL, NULL);
		j->operations += (double)points * (double)len;
		for (size_t k = 0; k < points; k++) {
			long from = (long)(k * stride) + first,
			     skip = from < 0 ? -from : 0;
			long end = from + (long)len;

			if (end > (long)j->n)
				end = (long)j->n;
			j->filter[c][k] =
				end > from + skip
					? dot(j->scratch + skip, j->r[c] + from + skip,
						  (size_t)(end - from - skip))
					: 0;
		}
	}
	return points;
}

static int tried_before(const struct joint_scene *s, const struct candidate *tried, int n,
	double t, double delta)
{
	for (int i = 0; i < n; i++)
		if (fabs(t - tried[i].t) < 0.15 * s->duration &&
			fabs(delta - tried[i].delta) < 0.15 * s->duration)
			return 1;
	return 0;
}

/* The same among pulses with delays from lo to hi, for which one duration will do. */
static void search_delays(struct joint *j, const struct joint_scene *s, double delta_lo,
	double delta_hi, const struct candidate *tried, int ntried,
	struct candidate *best)
{
	size_t stride = s->duration >= 48 ? (size_t)(s->duration / 24) : 1;
	double T = pulse_duration(s, 0.5 * (delta_lo + delta_hi)), g = s->gain;
	double norm = sqrt(s->duration / T / unit_energy(s));
	size_t points = filter_residual(j, s, T, stride);
	long lo = (long)floor(delta_lo / (double)stride);
	long hi = (long)ceil(delta_hi / (double)stride);

	j->operations += 4 * (double)points * (double)(hi - lo + 1);
	for (long k = 0; k < (long)points; k++)
		for (long l = k + lo < 0 ? -k : lo; l <= hi && k + l < (long)points;
			l++) {
			double z = (j->filter[0][k] + g * j->filter[1][k + l]) * norm;
			double worth = z < 0 ? z * z - s->negative : z * z;
			double t = (double)(k * (long)stride),
			       delta = (double)(l * (long)stride);

			if (worth <= best->z2 || tried_before(s, tried, ntried, t, delta))
				continue;
			best->z2 = worth;
			best->t = t;
			best->delta = clamp(delta, s->delta_min, s->delta_max);
			best->a = z * norm;
		}
}

int joint_bank(const struct joint_scene *s)
{
	static const double step = 0.26; /* of log T, see joint.h */
	double lo = pulse_duration(s, s->delta_min), hi = pulse_duration(s, s->delta_max);
	double count = ceil(log(hi / lo) / step);

	return count > 1 ? (int)count : 1;
}

/* The pulse that would take most chi-square away, outside the spots tried before. */
static struct candidate search(struct joint *j, const struct joint_scene *s,
	const struct candidate *tried, int ntried)
{
	struct candidate best = { 0 };
	int bank = joint_bank(s);
	double ratio =
		pow(pulse_duration(s, s->delta_max) / pulse_duration(s, s->delta_min),
			1.0 / bank);
	double lo = s->delta_min, hi;

	joint_project(j);
	j->searches++;
	for (int b = 0; b < bank; b++, lo = hi) {
		hi = b + 1 < bank ? (s->transit + lo) * ratio - s->transit : s->delta_max;
		search_delays(j, s, lo, hi, tried, ntried, &best);
	}
	return best;
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
	double taken = 0; /* the baseline had no noise to take */

	qsort(pulses, (size_t)m, sizeof *pulses, by_time);
	joint_fill_covariance(j, s, pulses, m);
	joint_project(j);
	result->chi2 = chi2;
	for (int b = j->slow; b < j->basis; b++)
		taken += 2 * j->share[b];
	result->dof = (long)((1 - s->lost) * (2 * (double)j->n - (double)j->left_out) -
			      taken + 0.5) -
		      PAR * m;
	if (result->dof < 1)
		result->dof = 1;
	result->full = full;
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
	double most = j->operations + (s->work > 0 ? s->work : JOINT_WORK) *
					      ((double)n + 8 * s->duration);
	int failed = 0;
	double chi2;

	if (status != JOINT_OK)
		return status;
	chi2 = joint_fit_all(j, s, pulses, *m);
	do {
		while (failed < 3 + *m / 8 && *m < s->max_pulses &&
			j->operations < most) {
			struct candidate c = search(j, s, tried, failed);

			if (c.z2 < 0.3 * s->drop_near)
				break;
			if (joint_try_pulse(j, s, pulses, m, &c, &chi2))
				failed = 0;
			else
				tried[failed++] = c;
		}
		chi2 = joint_fit_all(j, s, pulses, *m);
	} while (j->operations < most && joint_split_pulses(j, s, pulses, m, &chi2));
	if (j->operations < most) {
		joint_swap_pulses(j, s, pulses, *m, &chi2);
		joint_merge_pulses(j, s, pulses, m, &chi2);
		joint_prune(j, s, pulses, m, &chi2);
		chi2 = joint_fit_all(j, s, pulses, *m);
	}
	finish(j, s, pulses, *m, chi2,
		(j->operations >= most || *m == s->max_pulses) &&
			search(j, s, NULL, 0).z2 > s->drop,
		result);
	return JOINT_OK;
}

double joint_amplitude(struct joint *j, const struct joint_scene *s,
	const struct joint_pulse *pulse, int c, double *se)
{
	const struct column *col = &j->col[JOINT_PULSES_MAX][c];
	double hh;

	joint_make_columns(j, s, JOINT_PULSES_MAX, pulse);
	hh = dot(col->d[2], col->d[2], col->n);
	*se = hh > 0 ? 1 / sqrt(hh) : INFINITY;
	return hh > 0 ? pulse->a + dot(col->d[2], j->r[c] + col->first, col->n) / hh
		      : pulse->a;
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
