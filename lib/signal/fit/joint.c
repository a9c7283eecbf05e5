/* joint.c - see joint.h */
#include "num/sigmas.h"
#include "signal/fit/joint_state.h"
#include <stdlib.h>
#include <string.h>

/* Matched filter of the residual on every stride-th sample, per channel. */
static size_t filter_residual(struct joint *j, size_t stride)
{
	const struct joint_scene *s = &j->scene;
	size_t len, points = (j->n + stride - 1) / stride;

	for (int c = 0; c < 2; c++) {
		double T = joint_duration(s, 0, c);
		long first = shape_support(s->shape, 0, T, &len);

		shape_sample(s->shape, 0, T, first, len, j->scratch, NULL, NULL);
		for (size_t k = 0; k < points; k++)
			j->filter[c][k] = dot_within(j->scratch, len, j->r[c], j->n,
				(long long)(k * stride) + first);
	}
	return points;
}

/* Of sign * x[first .. last], the index of the largest; at: that of as many before last,
 * or less than first. */
static long largest(const double *x, double sign, long first, long last, long at)
{
	if (at >= first)
		return sign * x[last] > sign * x[at] ? last : at;
	at = first;
	for (long i = first + 1; i <= last; i++)
		if (sign * x[i] > sign * x[at])
			at = i;
	return at;
}

/* The pulse that would reduce chi-square most, except near the positions tried before. */
static struct candidate search(struct joint *j, const struct candidate *tried, int ntried)
{
	const struct joint_scene *s = &j->scene;
	size_t stride = (size_t)shape_stride(s->duration);
	size_t points;
	double z = 0, least = 0, g = s->gain, norm = 1 / sqrt(joint_energy(s));
	long lo = (long)floor(s->delta_min / (double)stride);
	long hi = (long)ceil(s->delta_max / (double)stride), from, to, top = -1, low = -1;
	struct candidate best = { 0 };

	joint_project(j);
	points = filter_residual(j, stride);
	j->result.searches++;
	from = (long)ceil(fmax(arrival_limit(j, 0), 0) / (double)stride);
	to = (long)fmin(arrival_limit(j, 1) / (double)stride, (double)points - 1);
	for (long k = from; k <= to; k++) {
		const double *f = j->filter[1];
		long first = k + lo < 0 ? 0 : k + lo, last = k + hi;
		double up, down;

		last = last < (long)points ? last : (long)points - 1;
		if (first > last)
			continue;
		top = largest(f, 1, first, last, top);
		low = largest(f, -1, first, last, low);
		up = (j->filter[0][k] + g * f[top]) * norm;
		down = (j->filter[0][k] + g * f[low]) * norm;
		/* No delay is better than the best one so far. */
		if (down >= least && up <= fabs(z) && (!s->signs || -down <= fabs(z)))
			continue;
		for (long l = first - k; l <= last - k; l++) {
			double here = (j->filter[0][k] + g * f[k + l]) * norm;
			int old = 0;

			least = here < least ? here : least;
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
	j->result.negative |=
		!s->signs && -least > z && least * least > s->threshold_near;
	best.a = z * norm;
	return best;
}

/* 1 if there are more pulses, and no room for them. */
static int are_more(struct joint *j)
{
	return j->m == j->scene.max_pulses && search(j, NULL, 0).z2 > j->scene.threshold;
}

/* Degrees of freedom of the record without those that the pulses take. */
static double degrees(const struct joint *j)
{
	double visible =
		(double)(joint_visible(j, 0, 0, j->n) + joint_visible(j, 1, 0, j->n));

	return (1 - j->scene.lost) * visible - j->taken;
}

/* The search for pulses: candidates that were not worth it since the last one that was,
 * and by how much the latest ones have reduced chi-square.  With 1, 2, 3 and 5 of them 69
 * of 72 records of 4 to 200 kHz (doc/benchmarks.md) have the same rows, and no row is
 * wrong; the others differ by what is done when they are stopped after their length. */
enum { TRIES = 3 + JOINT_PULSES_MAX / 8, LATEST = 3 };
struct pursuit {
	struct candidate tried[TRIES];
	int failed, found;
	double gain[LATEST];
};

/* 1 if as many more pulses as there may be leave more than noise although each of them
 * reduces chi-square by as much as the best of the latest: the clearest are found first.
 */
static int is_hopeless(const struct joint *j, const struct pursuit *p)
{
	double dof = fmax(degrees(j) - PAR * j->m, 1), most = 0;

	for (int i = 0; i < LATEST; i++)
		most = fmax(most, p->gain[i]);
	return p->found >= LATEST &&
	       j->result.chi2 - (j->scene.max_pulses - j->m) * most >
		       dof * (1 + CHI_SQUARE_MORE) + SIGMAS_NEVER * sqrt(2 * dof);
}

/* Adds pulses one by one; 1 if that is hopeless. */
static int add_pulses(struct joint *j, struct pursuit *p)
{
	while (p->failed < 3 + j->m / 8 && j->m < j->scene.max_pulses) {
		struct candidate c = search(j, p->tried, p->failed);
		double before = j->result.chi2;

		if (c.z2 < 0.3 * j->scene.threshold_near)
			break;
		if (!joint_try_pulse(j, &c)) {
			p->tried[p->failed++] = c;
			continue;
		}
		p->failed = 0;
		p->gain[p->found++ % LATEST] = before - j->result.chi2;
		if (j->scene.hopeless && is_hopeless(j, p))
			return 1;
	}
	return 0;
}

static int by_time(const void *x, const void *y)
{
	const struct joint_pulse *p = x, *q = y;

	return p->t < q->t ? -1 : p->t > q->t;
}

static void finish(struct joint *j, int full, struct joint_pulse *pulses,
	struct joint_result *result)
{
	double dof = degrees(j);

	qsort(j->pulse, (size_t)j->m, sizeof *j->pulse, by_time);
	joint_fill_covariance(j);
	joint_project(j);
	j->result.dof = (long)(dof + 0.5) - PAR * j->m;
	if (j->result.dof < 1)
		j->result.dof = 1;
	j->result.full = full;
	memcpy(pulses, j->pulse, (size_t)j->m * sizeof *pulses);
	*result = j->result;
}

enum joint_status joint_fit(struct joint *j, const struct joint_scene *s,
	const double *y1, const double *y2, size_t n, struct joint_pulse *pulses, int *m,
	struct joint_result *result)
{
	enum joint_status status = joint_start(j, s, y1, y2, n, pulses, *m);
	struct pursuit pursuit = { .failed = 0 };
	int hopeless, full;

	if (status != JOINT_OK)
		return status;
	joint_fit_all(j);
	do {
		hopeless = add_pulses(j, &pursuit);
		joint_fit_all(j);
	} while (!hopeless && joint_split_pulses(j));
	full = s->give_up && are_more(j);
	if (!full) {
		joint_swap_pulses(j);
		joint_merge_pulses(j);
		joint_prune(j);
		joint_fit_all(j);
		full = are_more(j);
	}
	*m = j->m;
	finish(j, full, pulses, result);
	return JOINT_OK;
}

enum joint_status joint_adjust(struct joint *j, const struct joint_scene *s,
	const double *y1, const double *y2, size_t n, struct joint_pulse *pulses, int m,
	double *chi2)
{
	enum joint_status status = joint_start(j, s, y1, y2, n, pulses, m);

	if (status != JOINT_OK)
		return status;
	joint_fit_all(j);
	qsort(j->pulse, (size_t)m, sizeof *j->pulse, by_time);
	memcpy(pulses, j->pulse, (size_t)m * sizeof *pulses);
	*chi2 = j->result.chi2;
	return JOINT_OK;
}

enum joint_status joint_refine(struct joint *j, const struct joint_scene *s,
	const double *y1, const double *y2, size_t n, struct joint_pulse *pulses, int m,
	struct joint_result *result)
{
	enum joint_status status = joint_start(j, s, y1, y2, n, pulses, m);

	if (status != JOINT_OK)
		return status;
	joint_fit_all(j);
	finish(j, 0, pulses, result);
	return JOINT_OK;
}
