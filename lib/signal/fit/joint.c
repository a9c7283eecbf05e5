/* joint.c - see joint.h */
#include "num/sigmas.h"
#include "signal/fit/joint_state.h"
#include <stdlib.h>
#include <string.h>

/* Inner products of p with x from first, first + stride, ... on; zero outside. */
static void filter_at(const double *p, size_t len, const double *x, size_t n, long first,
	size_t stride, double *out, size_t points)
{
	for (size_t k = 0; k < points;) {
		long at = (long)(k * stride) + first;

		if (k + 3 <= points && at >= 0 && (size_t)at + 2 * stride + len <= n) {
			const double *const y[3] = { x + at, x + at + stride,
				x + at + 2 * stride };

			dot3(p, y, len, out + k);
			k += 3;
		} else {
			out[k++] = dot_within(p, len, x, n, at);
		}
	}
}

/* Matched filter of the residual, for the pulse of this delay, on every stride-th sample,
 * per channel. */
static size_t filter_residual(struct joint *j, double delta, size_t stride)
{
	const struct joint_scene *s = &j->scene;
	size_t len, points = (j->n + stride - 1) / stride;

	for (int c = 0; c < 2; c++) {
		double T = joint_duration(s, delta, c);
		long first = shape_support(s->shape, 0, T, &len);

		shape_sample(s->shape, 0, T, first, len, j->scratch, NULL, NULL);
		filter_at(j->scratch, len, j->r[c], j->n, first, stride, j->filter[c],
			points);
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

/* What a search has found: the pulse that would reduce chi-square most, the root of that
 * with the sign of the pulse, and the same of the best negative one. */
struct found {
	struct candidate best;
	double z, least;
};

/* Looks for pulses of delays from lo to hi, except near the positions tried before. */
static void search_between(struct joint *j, double lo, double hi,
	const struct candidate *tried, int ntried, struct found *found)
{
	const struct joint_scene *s = &j->scene;
	const double middle = 0.5 * (lo + hi), g = s->gain;
	const double norm = 1 / sqrt(joint_energy(s) * (1 + middle / s->transit));
	const double T = joint_duration(s, middle, 0);
	const size_t stride = (size_t)shape_stride(T);
	const size_t points = filter_residual(j, middle, stride);
	const long least = (long)floor(lo / (double)stride);
	const long most = (long)ceil(hi / (double)stride);
	long from, to, top = -1, low = -1;

	from = (long)ceil(fmax(arrival_limit(j, 0), 0) / (double)stride);
	to = (long)fmin(arrival_limit(j, 1) / (double)stride, (double)points - 1);
	for (long k = from; k <= to; k++) {
		const double *f = j->filter[1];
		long first = k + least < 0 ? 0 : k + least, last = k + most;
		double up, down;

		last = last < (long)points ? last : (long)points - 1;
		if (first > last)
			continue;
		top = largest(f, 1, first, last, top);
		low = largest(f, -1, first, last, low);
		up = (j->filter[0][k] + g * f[top]) * norm;
		down = (j->filter[0][k] + g * f[low]) * norm;
		/* No delay is better than the best one so far. */
		if (down >= found->least && up <= fabs(found->z) &&
			(!s->signs || -down <= fabs(found->z)))
			continue;
		for (long l = first - k; l <= last - k; l++) {
			double here = (j->filter[0][k] + g * f[k + l]) * norm;
			int old = 0;

			found->least = fmin(found->least, here);
			if ((s->signs ? fabs(here) : here) <= fabs(found->z))
				continue;
			for (int i = 0; i < ntried && !old; i++)
				old = fabs((double)(k * (long)stride) - tried[i].t) <
					      0.15 * T &&
				      fabs((double)(l * (long)stride) - tried[i].delta) <
					      0.15 * T;
			if (old)
				continue;
			found->z = here;
			found->best = (struct candidate){ .t = (double)(k * (long)stride),
				.delta = clamp((double)(l * (long)stride), s->delta_min,
					s->delta_max),
				.a = here * norm,
				.z2 = here * here };
		}
	}
}

/* Ratio of the longest and the shortest pulse for which one matched filter serves: that
 * of a sine pulse in the middle then loses a twentieth of the chi-square of either.  In
 * 69 records of laminar flow 1.27, 1.6, 1.86 and a single filter find 1157, 1069, 1052
 * and 1101 of 1694 particles rightly. */
static const double ONE_FILTER = 1.27;

/* The pulse that would reduce chi-square most, except near the positions tried before. */
static struct candidate search(struct joint *j, const struct candidate *tried, int ntried)
{
	const struct joint_scene *s = &j->scene;
	const double shortest = 1 + s->delta_min / s->transit;
	const double ratio = (1 + s->delta_max / s->transit) / shortest;
	const int filters = (int)fmax(ceil(log(ratio) / log(ONE_FILTER)), 1);
	double lo = s->delta_min;
	struct found found = { .z = 0 };

	joint_project(j);
	j->result.searches++;
	for (int i = 1; i <= filters; i++) {
		double longest = shortest * pow(ratio, (double)i / filters), hi;

		hi = i < filters ? (longest - 1) * s->transit : s->delta_max;
		search_between(j, lo, hi, tried, ntried, &found);
		lo = hi;
	}
	j->result.negative |= !s->signs && -found.least > found.z &&
			      found.least * found.least > s->threshold_near;
	return found.best;
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

	return (1 - j->scene.lost) * visible - j->basis->taken;
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

/* 1 if more than noise is left where chi-square falls by this much. */
static int leaves_more(const struct joint *j, double by)
{
	double dof = fmax(degrees(j) - PAR * j->m, 1);

	return j->result.chi2 - by >
	       dof * (1 + CHI_SQUARE_MORE) + SIGMAS_NEVER * sqrt(2 * dof);
}

/* 1 if as many more pulses as there may be leave more than noise although each of them
 * reduces chi-square by as much as the best of the latest: the clearest are found first.
 */
static int is_hopeless(const struct joint *j, const struct pursuit *p)
{
	double most = 0;

	for (int i = 0; i < LATEST; i++)
		most = fmax(most, p->gain[i]);
	return p->found >= LATEST && leaves_more(j, (j->scene.max_pulses - j->m) * most);
}

/* 1 if a tenth of what the pulses leave, without what the error of their shape explains,
 * is more than noise: exchanging, merging and removing pulses rarely saves such a fit,
 * and takes two thirds of the time of some records.  In 12 records of groups in turbulent
 * flow (group-turbulent of tests/matrix/scenes.tsv, seeds + 0, 1000, 2000) a tenth and a
 * fiftieth lose none of 1200 particles, a half loses 26. */
static int is_beyond(const struct joint *j)
{
	double energy = 0;

	for (int i = 0; i < j->m; i++)
		energy += j->pulse[i].a * j->pulse[i].a * joint_energy(&j->scene);
	return leaves_more(j, 0.9 * j->result.chi2 + j->scene.misfit * energy);
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
	joint_relax(j);
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
	for (int i = 0; i < j->m; i++)
		j->pulse[i].exchange = 0;
	joint_fit_all(j);
	do {
		hopeless = add_pulses(j, &pursuit);
		joint_fit_all(j);
	} while (!hopeless && joint_split_pulses(j));
	full = s->give_up && are_more(j);
	if (!full && !is_beyond(j)) {
		joint_swap_pulses(j);
		joint_merge_pulses(j);
		joint_prune(j);
		joint_fit_all(j);
		joint_prune_relaxed(j);
		joint_forget_moved(j);
	}
	full = full || are_more(j);
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
