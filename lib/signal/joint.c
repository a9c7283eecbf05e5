/* joint.c - see joint.h */
#include "signal/joint.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PAR = 3, NPAR = PAR * JOINT_PULSES_MAX, BASIS_MAX = 2 * JOINT_TONES_MAX + 1 };

/* What one pulse puts on one channel, and its derivatives by (t, t + delta, a). */
struct column {
	long first;
	size_t n;
	double *d[PAR];
};

struct joint {
	size_t capacity; /* samples */
	size_t support;  /* samples one pulse may touch */
	size_t n;
	double *e[2];            /* record less pulses, tones still in it */
	double *r[2];            /* e without tones and offset */
	int basis;               /* orthonormal vectors spanning tones and offset */
	double *q;               /* basis * n */
	double share[BASIS_MAX]; /* of each that is projected out: 1 if nothing is known
				  */
	double *memory;          /* columns of all pulses */
	double *scratch;         /* three of support */
	double *filter[2];       /* matched filter on the coarse grid */
	struct column col[JOINT_PULSES_MAX + 1][2];   /* as the pulses are */
	struct column trial[JOINT_PULSES_MAX + 1][2]; /* as they were before a step */
	double *h; /* NPAR * NPAR: normal matrix or its Cholesky factor */
	double *factor;
	int begin[NPAR];         /* first nonzero of each row */
	double energy;           /* e^T e of both channels, ... */
	double qe[2][BASIS_MAX]; /* ... and Q^T e: kept up to date by add_column() */
	double *bq;              /* NPAR * basis: Q^T J */
	double gradient[NPAR], diagonal[NPAR], move[NPAR];
	long steps, searches;
};

struct joint *joint_new(void)
{
	struct joint *j = calloc(1, sizeof *j);

	if (!j)
		return NULL;
	j->h = malloc(sizeof(double) * NPAR * NPAR);
	j->factor = malloc(sizeof(double) * NPAR * NPAR);
	j->bq = malloc(sizeof(double) * NPAR * 2 * BASIS_MAX);
	if (!j->h || !j->factor || !j->bq) {
		joint_free(j);
		return NULL;
	}
	return j;
}

static void free_samples(struct joint *j)
{
	for (int c = 0; c < 2; c++) {
		free(j->e[c]);
		free(j->r[c]);
		free(j->filter[c]);
		j->e[c] = j->r[c] = j->filter[c] = NULL;
	}
	free(j->q);
	j->q = NULL;
	j->capacity = 0;
}

void joint_free(struct joint *j)
{
	if (!j)
		return;
	free_samples(j);
	free(j->memory);
	free(j->scratch);
	free(j->h);
	free(j->factor);
	free(j->bq);
	free(j);
}

static int reserve_samples(struct joint *j, size_t n)
{
	if (n <= j->capacity)
		return 1;
	free_samples(j);
	n += n / 2;
	for (int c = 0; c < 2; c++) {
		j->e[c] = malloc(n * sizeof(double));
		j->r[c] = malloc(n * sizeof(double));
		j->filter[c] = malloc(n * sizeof(double));
		if (!j->e[c] || !j->r[c] || !j->filter[c])
			return 0;
	}
	j->q = malloc(n * sizeof(double) * BASIS_MAX);
	if (!j->q)
		return 0;
	j->capacity = n;
	return 1;
}

static int reserve_columns(struct joint *j, size_t support)
{
	double *at;

	if (support <= j->support)
		return 1;
	free(j->memory);
	free(j->scratch);
	j->support = 0;
	j->memory = malloc(support * sizeof(double) * (JOINT_PULSES_MAX + 1) * 4 * PAR);
	j->scratch = malloc(support * sizeof(double) * PAR);
	if (!j->memory || !j->scratch)
		return 0;
	j->support = support;
	at = j->memory;
	for (int i = 0; i <= JOINT_PULSES_MAX; i++)
		for (int c = 0; c < 2; c++)
			for (int k = 0; k < PAR; k++, at += 2 * support) {
				j->col[i][c].d[k] = at;
				j->trial[i][c].d[k] = at + support;
			}
	return 1;
}

/* Four partial sums in fixed order: fast, and the same bits everywhere. */
static double dot(const double *x, const double *y, size_t n)
{
	double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
	size_t i = 0;

	for (; i + 4 <= n; i += 4) {
		s0 += x[i] * y[i];
		s1 += x[i + 1] * y[i + 1];
		s2 += x[i + 2] * y[i + 2];
		s3 += x[i + 3] * y[i + 3];
	}
	for (; i < n; i++)
		s0 += x[i] * y[i];
	return (s0 + s1) + (s2 + s3);
}

static void add_scaled(double *y, double factor, const double *x, size_t n)
{
	for (size_t i = 0; i < n; i++)
		y[i] += factor * x[i];
}

/* Orthonormal basis of offset and tones over n samples (modified Gram-Schmidt, twice);
 * a vector that adds nothing, such as a tone at half the rate twice, is dropped. */
static void make_basis(struct joint *j, const struct joint_scene *s)
{
	size_t n = j->n;

	j->basis = 0;
	for (int k = s->offset ? -1 : 0; k < 2 * s->tones; k++) {
		double *v = j->q + (size_t)j->basis * n, norm, w;

		for (size_t i = 0; i < n; i++) {
			w = k < 0 ? 0 : s->omega[k / 2] * ((double)i - (double)n / 2);
			v[i] = k % 2 ? (k < 0 ? 1 : sin(w)) : cos(w);
		}
		norm = dot(v, v, n);
		for (int pass = 0; pass < 2; pass++)
			for (int b = 0; b < j->basis; b++)
				add_scaled(v, -dot(v, j->q + (size_t)b * n, n),
					j->q + (size_t)b * n, n);
		w = dot(v, v, n);
		if (w <= 1e-8 * norm || w == 0)
			continue;
		w = 1 / sqrt(w);
		for (size_t i = 0; i < n; i++)
			v[i] *= w;
		w = 0.5 * (double)n * s->tone_variance;
		j->share[j->basis++] = k < 0 || isinf(w) ? 1 : w / (1 + w);
	}
}

/* Energy of e and its part along the basis, from scratch. */
static void measure(struct joint *j)
{
	j->energy = 0;
	for (int c = 0; c < 2; c++) {
		j->energy += dot(j->e[c], j->e[c], j->n);
		for (int b = 0; b < j->basis; b++)
			j->qe[c][b] = dot(j->q + (size_t)b * j->n, j->e[c], j->n);
	}
}

/* Chi-square.  With s^2 the variance of a coefficient known beforehand, the covariance of
 * the record is 1 + s^2 q q^T, its inverse 1 - share q q^T, share = s^2 / (1 + s^2). */
static double chi_square(const struct joint *j)
{
	double chi2 = j->energy;

	for (int c = 0; c < 2; c++)
		for (int b = 0; b < j->basis; b++)
			chi2 -= j->share[b] * j->qe[c][b] * j->qe[c][b];
	return chi2;
}

/* r = e without its tones, as far as they are not known beforehand. */
static void project(struct joint *j)
{
	measure(j);
	for (int c = 0; c < 2; c++) {
		memcpy(j->r[c], j->e[c], j->n * sizeof(double));
		for (int b = 0; b < j->basis; b++)
			add_scaled(j->r[c], -j->share[b] * j->qe[c][b],
				j->q + (size_t)b * j->n, j->n);
	}
}

static double pulse_duration(const struct joint_scene *s, double delta)
{
	return s->duration * (1 + delta / s->transit);
}

/* The part of a pulse on channel c inside the n samples. */
static long pulse_window(const struct joint_scene *s, const struct joint_pulse *p, int c,
	size_t n, size_t *len)
{
	double T = pulse_duration(s, p->delta);
	long first = shape_support(s->shape, p->t + (c ? p->delta : 0), T, len);
	long last = first + (long)*len;

	if (first < 0)
		first = 0;
	if (last > (long)n)
		last = (long)n;
	*len = last > first ? (size_t)(last - first) : 0;
	return first;
}

static void subtract(struct joint *j, const struct joint_scene *s,
	const struct joint_pulse *p, double sign)
{
	for (int c = 0; c < 2; c++) {
		size_t len;
		long first = pulse_window(s, p, c, j->n, &len);

		shape_sample(s->shape, p->t + (c ? p->delta : 0),
			pulse_duration(s, p->delta), first, len, j->scratch, NULL, NULL);
		if (len)
			add_scaled(j->e[c] + first, -sign * p->a * (c ? s->gain : 1),
				j->scratch, len);
	}
}

static void make_columns(
	struct joint *j, const struct joint_scene *s, int i, const struct joint_pulse *p)
{
	double T = pulse_duration(s, p->delta), stretch = s->duration / s->transit;

	for (int c = 0; c < 2; c++) {
		struct column *col = &j->col[i][c];
		double a = p->a * (c ? s->gain : 1), *by_t, *by_T;

		col->first = pulse_window(s, p, c, j->n, &col->n);
		by_t = col->d[c];
		by_T = col->d[1 - c];
		shape_sample(s->shape, p->t + (c ? p->delta : 0), T, col->first, col->n,
			col->d[2], by_t, by_T);
		/* T grows with t2 and falls with t1. */
		for (size_t k = 0; k < col->n; k++) {
			double lengthen = by_T[k] * stretch;

			by_t[k] = a * (by_t[k] + (c ? lengthen : -lengthen));
			by_T[k] = a * (c ? -lengthen : lengthen);
			if (c)
				col->d[2][k] *= s->gain;
		}
	}
}

/* J_i^T J_k of two pulses, added to block. */
static int add_block(const struct joint *j, int i, int k, double block[PAR][PAR])
{
	int touch = 0;

	for (int c = 0; c < 2; c++) {
		const struct column *x = &j->col[i][c], *y = &j->col[k][c];
		long first = x->first > y->first ? x->first : y->first;
		long xend = x->first + (long)x->n, yend = y->first + (long)y->n;
		long end = xend < yend ? xend : yend;

		if (end <= first)
			continue;
		touch = 1;
		for (int u = 0; u < PAR; u++)
			for (int v = 0; v < (i == k ? u + 1 : PAR); v++)
				block[u][v] += dot(x->d[u] + (first - x->first),
					y->d[v] + (first - y->first),
					(size_t)(end - first));
	}
	return touch;
}

/* Normal matrix and gradient of the m pulses in set. */
static void make_normal(struct joint *j, const int *set, int m)
{
	int np = PAR * m, nb = 2 * j->basis;

	for (int x = 0; x < m; x++) {
		int i = set[x];

		for (int u = 0; u < PAR; u++) {
			double g = 0;

			for (int c = 0; c < 2; c++) {
				const struct column *col = &j->col[i][c];

				g += dot(col->d[u], j->e[c] + col->first, col->n);
				for (int b = 0; b < j->basis; b++) {
					double part = dot(col->d[u],
						j->q + (size_t)b * j->n + col->first,
						col->n);

					g -= j->share[b] * part * j->qe[c][b];
					j->bq[(PAR * x + u) * nb + c * j->basis + b] =
						sqrt(j->share[b]) * part;
				}
			}
			j->gradient[PAR * x + u] = g;
			j->begin[PAR * x + u] = nb ? 0 : PAR * x;
		}
		for (int y = 0; y <= x; y++) {
			double block[PAR][PAR] = { { 0 } };
			int touch = add_block(j, i, set[y], block);

			for (int u = 0; u < PAR; u++) {
				int row = PAR * x + u;

				if (touch && j->begin[row] > PAR * y)
					j->begin[row] = PAR * y;
				for (int v = 0; v < (x == y ? u + 1 : PAR); v++)
					j->h[row * np + PAR * y + v] =
						block[u][v] -
						dot(j->bq + row * nb,
							j->bq + (PAR * y + v) * nb,
							(size_t)nb);
			}
		}
	}
	for (int i = 0; i < np; i++)
		j->diagonal[i] = j->h[i * np + i];
}

/* Cholesky of h + lambda diag(h) within the profile; 0 where not positive definite. */
static int factorise(struct joint *j, int np, double lambda)
{
	for (int i = 0; i < np; i++) {
		double *row = j->factor + (size_t)i * (size_t)np, pivot;

		for (int k = j->begin[i]; k < i; k++) {
			const double *other = j->factor + (size_t)k * (size_t)np;
			int from = j->begin[i] > j->begin[k] ? j->begin[i] : j->begin[k];

			row[k] = (j->h[i * np + k] - dot(row + from, other + from,
							     (size_t)(k - from))) /
				 other[k];
		}
		pivot = j->h[i * np + i] + lambda * j->diagonal[i] -
			dot(row + j->begin[i], row + j->begin[i],
				(size_t)(i - j->begin[i]));
		if (!(pivot > 1e-13 * j->diagonal[i]))
			return 0;
		row[i] = sqrt(pivot);
	}
	return 1;
}

/* Solves L L^T x = x in place, from row start on (the rows above are zero). */
static void solve(const struct joint *j, int np, int start, double *x)
{
	for (int i = start; i < np; i++) {
		const double *row = j->factor + (size_t)i * (size_t)np;
		int from = j->begin[i] > start ? j->begin[i] : start;

		x[i] = (x[i] - dot(row + from, x + from, (size_t)(i - from))) / row[i];
	}
	for (int i = np - 1; i >= 0; i--) {
		const double *row = j->factor + (size_t)i * (size_t)np;

		x[i] /= row[i];
		add_scaled(x + j->begin[i], -x[i], row + j->begin[i],
			(size_t)(i - j->begin[i]));
	}
}

static double clamp(double x, double lo, double hi)
{
	return x < lo ? lo : x > hi ? hi : x;
}

/* One step from old along move, kept where pulses make sense. */
static struct joint_pulse moved(const struct joint_scene *s,
	const struct joint_pulse *old, const double *move, size_t n)
{
	struct joint_pulse p = *old;
	double step = 0.25 * s->duration, span = s->delta_max - s->delta_min;
	double reach = 0.9 * shape_reach(s->shape) * s->duration;
	double t2 = old->t + old->delta + clamp(move[1], -step, step);

	p.t = clamp(old->t + clamp(move[0], -step, step), -reach, (double)n + reach);
	p.delta = clamp(t2 - p.t, s->delta_min - 0.1 * span, s->delta_max + 0.1 * span);
	p.a = clamp(old->a + move[2], 0.1 * old->a, 10 * old->a);
	return p;
}

/* Adds what the columns of pulse i say it puts on the record. */
static void add_column(struct joint *j, int i, double factor)
{
	for (int c = 0; c < 2; c++) {
		const struct column *col = &j->col[i][c];
		double *e = j->e[c] + col->first;

		j->energy -= dot(e, e, col->n);
		add_scaled(e, factor, col->d[2], col->n);
		j->energy += dot(e, e, col->n);
		for (int b = 0; b < j->basis; b++)
			j->qe[c][b] += factor * dot(j->q + (size_t)b * j->n + col->first,
							col->d[2], col->n);
	}
}

static void swap_columns(struct joint *j, int i)
{
	struct column keep[2];

	memcpy(keep, j->col[i], sizeof keep);
	memcpy(j->col[i], j->trial[i], sizeof keep);
	memcpy(j->trial[i], keep, sizeof keep);
}

/* Moves the pulses in set along j->move; their columns before the step go to trial. */
static void step_forth(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, const int *set, int m, struct joint_pulse *old)
{
	for (int x = 0; x < m; x++) {
		struct joint_pulse *p = &pulses[set[x]];

		old[x] = *p;
		add_column(j, set[x], p->a);
		*p = moved(s, &old[x], j->move + PAR * x, j->n);
		swap_columns(j, set[x]);
		make_columns(j, s, set[x], p);
		add_column(j, set[x], -p->a);
	}
}

static void step_back(struct joint *j, struct joint_pulse *pulses, const int *set, int m,
	const struct joint_pulse *old)
{
	for (int x = 0; x < m; x++) {
		add_column(j, set[x], pulses[set[x]].a);
		swap_columns(j, set[x]);
		pulses[set[x]] = old[x];
		add_column(j, set[x], -old[x].a);
	}
}

/* Levenberg-Marquardt on the pulses in set, the others held; returns chi-square. */
static double fit_set(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, const int *set, int m, int max_steps,
	double tolerance)
{
	double lambda = 1e-4, chi2;
	struct joint_pulse old[JOINT_PULSES_MAX];
	int fresh = 0;

	measure(j);
	chi2 = chi_square(j);
	for (int x = 0; x < m; x++)
		make_columns(j, s, set[x], &pulses[set[x]]);
	for (int step = 0; step < max_steps && m > 0; step++) {
		double after;

		if (!fresh)
			make_normal(j, set, m);
		fresh = 1;
		j->steps++;
		if (!factorise(j, PAR * m, lambda)) {
			lambda = lambda * 10 + 1e-3;
			continue;
		}
		memcpy(j->move, j->gradient, sizeof(double) * (size_t)(PAR * m));
		solve(j, PAR * m, 0, j->move);
		step_forth(j, s, pulses, set, m, old);
		after = chi_square(j);
		if (after < chi2) {
			double gain = chi2 - after;

			chi2 = after;
			lambda = lambda > 1e-9 ? lambda / 10 : lambda;
			fresh = 0;
			if (gain < tolerance)
				break;
			continue;
		}
		step_back(j, pulses, set, m, old);
		after -= chi2;
		chi2 = chi_square(j);
		if (after < tolerance || lambda > 1e6)
			break;
		lambda = lambda * 10;
	}
	return chi2;
}

/* Pulses whose support on either channel comes near that of pulse i. */
static int neighbours(const struct joint_scene *s, const struct joint_pulse *pulses,
	int m, int i, double reach, int *set)
{
	double near = reach * s->duration * 2 * shape_reach(s->shape);
	int count = 0;

	for (int k = 0; k < m; k++)
		if (fabs(pulses[k].t - pulses[i].t) < near ||
			fabs(pulses[k].t + pulses[k].delta - pulses[i].t -
				pulses[i].delta) < near)
			set[count++] = k;
	return count;
}

/* Matched filter of the residual on every stride-th sample, per channel. */
static size_t filter_residual(struct joint *j, const struct joint_scene *s, size_t stride)
{
	size_t len, points = (j->n + stride - 1) / stride;
	long first = shape_support(s->shape, 0, s->duration, &len);

	shape_sample(s->shape, 0, s->duration, first, len, j->scratch, NULL, NULL);
	for (int c = 0; c < 2; c++)
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
	return points;
}

struct candidate {
	double t, delta, a, z2;
};

/* The pulse that would take most chi-square away, outside the spots tried before. */
static struct candidate search(struct joint *j, const struct joint_scene *s,
	const struct candidate *tried, int ntried)
{
	size_t stride = s->duration >= 48 ? (size_t)(s->duration / 24) : 1;
	size_t points;
	double energy = s->duration * shape_energy(s->shape), z = 0, g = s->gain;
	double norm = 1 / sqrt(energy * (1 + g * g));
	long lo = (long)floor(s->delta_min / (double)stride);
	long hi = (long)ceil(s->delta_max / (double)stride);
	struct candidate best = { 0 };

	project(j);
	points = filter_residual(j, s, stride);
	j->searches++;
	for (long k = 0; k < (long)points; k++) {
		for (long l = k + lo < 0 ? -k : lo; l <= hi && k + l < (long)points;
			l++) {
			double here = (j->filter[0][k] + g * j->filter[1][k + l]) * norm;
			int old = 0;

			if (here <= z)
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
	best.a = z * norm;
	return best;
}

/* Energy, in units of chi-square, of the pulses that overlap pulse i. */
static double energy_near(
	const struct joint_scene *s, const struct joint_pulse *pulses, int m, int i)
{
	double sum = 0,
	       unit = s->duration * shape_energy(s->shape) * (1 + s->gain * s->gain);
	int set[JOINT_PULSES_MAX];
	int count = neighbours(s, pulses, m, i, 1, set);

	for (int k = 0; k < count; k++)
		if (set[k] != i)
			sum += pulses[set[k]].a * pulses[set[k]].a * unit;
	return sum;
}

/* Puts the pulses back as they were in before. */
static void restore(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, const struct joint_pulse *before, int old)
{
	for (int k = 0; k < *m; k++)
		subtract(j, s, &pulses[k], -1);
	memcpy(pulses, before, sizeof(*pulses) * (size_t)old);
	*m = old;
	for (int k = 0; k < *m; k++)
		subtract(j, s, &pulses[k], 1);
}

/* Is pulse i, the last one put in, worth a drop of chi-square from before to after? */
static int worth(const struct joint_scene *s, const struct joint_pulse *pulses, int m,
	int i, double before, double after)
{
	double energy = energy_near(s, pulses, m, i);
	double need = energy > 0 ? fmax(s->drop_near, s->misfit * energy) : s->drop;

	return before - after > need;
}

/* Tries one more pulse at c; 1 if it was worth it, else everything is as before. */
static int try_pulse(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, const struct candidate *c, double *chi2)
{
	struct joint_pulse before[JOINT_PULSES_MAX];
	int set[JOINT_PULSES_MAX], i = *m, count, old = *m;
	double after;

	memcpy(before, pulses, sizeof(*pulses) * (size_t)old);
	pulses[i] = (struct joint_pulse){ .t = c->t, .delta = c->delta, .a = c->a };
	subtract(j, s, &pulses[i], 1);
	++*m;
	fit_set(j, s, pulses, &i, 1, 8, 1);
	count = neighbours(s, pulses, *m, i, 0.8, set);
	after = fit_set(j, s, pulses, set, count, 30, 0.1);
	if (worth(s, pulses, *m, i, *chi2, after)) {
		*chi2 = after;
		return 1;
	}
	restore(j, s, pulses, m, before, old);
	return 0;
}

/* How much, in standard deviations, the residual asks for pulse i to be two pulses a
 * distance 2 shift apart on both sensors: its projection on p(+) + p(-) - 2 p, made
 * orthogonal to what moving and scaling pulse i alone can do. */
static double split_score(struct joint *j, const struct joint_scene *s,
	const struct joint_pulse *pulse, double shift)
{
	struct joint_pulse wide = *pulse;
	double T = pulse_duration(s, pulse->delta), x2 = 0, xr = 0,
	       h[PAR][PAR + 1] = { { 0 } };

	make_columns(j, s, JOINT_PULSES_MAX, &wide);
	for (int c = 0; c < 2; c++) {
		const struct column *col = &j->col[JOINT_PULSES_MAX][c];
		double t0 = pulse->t + (c ? pulse->delta : 0), g = c ? s->gain : 1;
		long first = col->first - (long)shift;
		size_t n = col->n + 2 * (size_t)shift;
		double *x = j->scratch, *part = j->scratch + j->support;

		if (first < 0 || first + (long)n > (long)j->n || n > j->support)
			return 0;
		shape_sample(s->shape, t0 - shift, T, first, n, x, NULL, NULL);
		shape_sample(s->shape, t0 + shift, T, first, n, part, NULL, NULL);
		add_scaled(x, 1, part, n);
		shape_sample(s->shape, t0, T, first, n, part, NULL, NULL);
		add_scaled(x, -2, part, n);
		x2 += g * g * dot(x, x, n);
		xr += g * dot(x, j->r[c] + first, n);
		for (int u = 0; u < PAR; u++) {
			h[u][PAR] += g * dot(x + (col->first - first), col->d[u], col->n);
			for (int v = 0; v < PAR; v++)
				h[u][v] += dot(col->d[u], col->d[v], col->n);
		}
	}
	for (int u = 0; u < PAR; u++) { /* eliminate: x2 becomes its Schur complement */
		if (!(h[u][u] > 0))
			return 0;
		for (int v = u + 1; v < PAR; v++)
			for (int w = PAR; w >= u; w--)
				h[v][w] -= h[u][w] * h[v][u] / h[u][u];
		x2 -= h[u][PAR] * h[u][PAR] / h[u][u];
	}
	return x2 > 0 ? xr / sqrt(x2) : 0;
}

/* Tries pulse i as two; 1 if it was worth it, else everything is as before. */
static int try_split(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, int i, double shift, double *chi2)
{
	struct joint_pulse before[JOINT_PULSES_MAX];
	int set[JOINT_PULSES_MAX], pair[2] = { i, *m }, count, old = *m;
	double after;

	memcpy(before, pulses, sizeof(*pulses) * (size_t)old);
	subtract(j, s, &pulses[i], -1);
	pulses[old] = pulses[i];
	pulses[i].a = pulses[old].a = pulses[i].a / 2;
	pulses[i].t -= shift;
	pulses[old].t += shift;
	subtract(j, s, &pulses[i], 1);
	subtract(j, s, &pulses[old], 1);
	++*m;
	fit_set(j, s, pulses, pair, 2, 10, 1);
	count = neighbours(s, pulses, *m, i, 0.8, set);
	after = fit_set(j, s, pulses, set, count, 30, 0.1);
	if (worth(s, pulses, *m, old, *chi2, after)) {
		*chi2 = after;
		return 1;
	}
	restore(j, s, pulses, m, before, old);
	return 0;
}

/* Splits pulses that look like two; returns how many were split. */
static int split_pulses(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, double *chi2)
{
	int split = 0;

	project(j);
	for (int i = 0; i < *m && *m < s->max_pulses; i++) {
		double best = 2, shift = 0;

		for (int k = 1; k <= 3; k++) {
			double score = split_score(
				j, s, &pulses[i], floor(0.06 * k * s->duration));

			if (score > best) {
				best = score;
				shift = floor(0.06 * k * s->duration);
			}
		}
		if (shift > 0) {
			split += try_split(j, s, pulses, m, i, shift, chi2);
			project(j);
		}
	}
	return split;
}

static double fit_all(
	struct joint *j, const struct joint_scene *s, struct joint_pulse *pulses, int m)
{
	int set[JOINT_PULSES_MAX];

	for (int i = 0; i < m; i++)
		set[i] = i;
	return fit_set(j, s, pulses, set, m, 50, 1e-4);
}

/* Covariances from the inverse of the undamped normal matrix. */
static void fill_covariance(
	struct joint *j, const struct joint_scene *s, struct joint_pulse *pulses, int m)
{
	int set[JOINT_PULSES_MAX] = { 0 }, good, np = PAR * m;
	double x[NPAR];

	for (int i = 0; i < m; i++) {
		set[i] = i;
		make_columns(j, s, i, &pulses[i]);
	}
	make_normal(j, set, m);
	good = factorise(j, np, 0);
	for (int i = 0; i < m; i++)
		for (int u = 0, k = 0; u < PAR; u++) {
			if (good) {
				memset(x, 0, sizeof(double) * (size_t)np);
				x[PAR * i + u] = 1;
				solve(j, np, PAR * i + u, x);
			}
			for (int v = 0; v <= u; v++)
				pulses[i].cov[k++] = good ? x[PAR * i + v] : INFINITY;
		}
}

/* How far the amplitude of a pulse is from zero, squared, in standard errors; where the
 * matrix is singular, as it is with pulses too many, in those of a lone pulse. */
static double significance(const struct joint_scene *s, const struct joint_pulse *p)
{
	double energy = s->duration * shape_energy(s->shape) * (1 + s->gain * s->gain);

	return isfinite(p->cov[5]) ? p->a * p->a / p->cov[5] : p->a * p->a * energy;
}

/* Takes pulse i out if the others can do without it. */
static int try_without(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, int i, double *chi2)
{
	struct joint_pulse before[JOINT_PULSES_MAX], weak = pulses[i];
	int set[JOINT_PULSES_MAX], count, old = *m;
	double after;

	memcpy(before, pulses, sizeof(*pulses) * (size_t)old);
	subtract(j, s, &weak, -1);
	--*m;
	for (int k = i; k < *m; k++)
		pulses[k] = pulses[k + 1];
	pulses[*m] = weak; /* for neighbours() only */
	count = neighbours(s, pulses, *m + 1, *m, 0.8, set) - 1;
	after = fit_set(j, s, pulses, set, count, 30, 0.1);
	pulses[*m] = weak;
	if (worth(s, pulses, *m + 1, *m, after, *chi2)) {
		restore(j, s, pulses, m, before, old);
		return 0;
	}
	*chi2 = after;
	return 1;
}

/* Puts one pulse in the place of pulses i and k if that will do. */
static int try_merge(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, int i, int k, double *chi2)
{
	struct joint_pulse before[JOINT_PULSES_MAX], gone = pulses[k];
	int set[JOINT_PULSES_MAX], old = *m, count;
	double part = pulses[k].a / (pulses[i].a + pulses[k].a), after;

	memcpy(before, pulses, sizeof(*pulses) * (size_t)old);
	subtract(j, s, &pulses[i], -1);
	subtract(j, s, &pulses[k], -1);
	pulses[i].a += pulses[k].a;
	pulses[i].t += part * (pulses[k].t - pulses[i].t);
	pulses[i].delta += part * (pulses[k].delta - pulses[i].delta);
	subtract(j, s, &pulses[i], 1);
	--*m;
	for (int l = k; l < *m; l++)
		pulses[l] = pulses[l + 1];
	pulses[*m] = gone; /* for neighbours() only */
	count = neighbours(s, pulses, *m + 1, *m, 0.8, set) - 1;
	after = fit_set(j, s, pulses, set, count, 30, 0.1);
	pulses[*m] = gone;
	if (worth(s, pulses, *m + 1, *m, after, *chi2)) {
		restore(j, s, pulses, m, before, old);
		return 0;
	}
	*chi2 = after;
	return 1;
}

/* Merges pulses so close that they may be one that was split in vain. */
static double merge_pulses(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, double chi2)
{
	double near = 0.12 * s->duration;

	for (int i = 0; i < *m; i++)
		for (int k = i + 1; k < *m; k++)
			if (fabs(pulses[k].t - pulses[i].t) < near &&
				try_merge(j, s, pulses, m, i, k, &chi2))
				k = i;
	return chi2;
}

/* Takes out pulses that the others can do without, least significant first. */
static double prune(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, double chi2)
{
	enum { TRIES = 4 };
	int needed[TRIES], tries = 0;

	while (*m > 1 && tries < TRIES) {
		double least = 6 * s->drop;
		int worst = -1;

		fill_covariance(j, s, pulses, *m);
		for (int i = 0; i < *m; i++) {
			int tried = 0;

			for (int k = 0; k < tries; k++)
				tried |= needed[k] == i;
			if (!tried && significance(s, &pulses[i]) < least) {
				least = significance(s, &pulses[i]);
				worst = i;
			}
		}
		if (worst < 0)
			break;
		if (try_without(j, s, pulses, m, worst, &chi2))
			tries = 0;
		else
			needed[tries++] = worst;
	}
	return chi2;
}

static int by_time(const void *x, const void *y)
{
	const struct joint_pulse *p = x, *q = y;

	return p->t < q->t ? -1 : p->t > q->t;
}

static int scene_is_sane(
	const struct joint_scene *s, const struct joint_pulse *pulses, int m)
{
	if (!s->shape || !(s->duration >= 4) || !(s->transit > 0) || !(s->gain > 0) ||
		!(s->delta_min <= s->delta_max) || !(s->drop >= 0) ||
		!(s->drop_near >= 0) || !(s->tone_variance >= 0) || s->tones < 0 ||
		s->tones > JOINT_TONES_MAX || s->max_pulses < 0 ||
		s->max_pulses > JOINT_PULSES_MAX || m < 0 || m > s->max_pulses)
		return 0;
	/* The slack of moved() must keep T positive. */
	if (s->delta_min - 0.1 * (s->delta_max - s->delta_min) <= -s->transit)
		return 0;
	for (int i = 0; i < m; i++)
		if (!isfinite(pulses[i].t) || !isfinite(pulses[i].delta) ||
			!isfinite(pulses[i].a))
			return 0;
	return 1;
}

static enum joint_status start(struct joint *j, const struct joint_scene *s,
	const double *y1, const double *y2, size_t n, const struct joint_pulse *pulses,
	int m)
{
	double longest;
	size_t support;

	if (!scene_is_sane(s, pulses, m) || n == 0)
		return JOINT_DOMAIN;
	longest = s->delta_max + 0.1 * (s->delta_max - s->delta_min);
	support =
		(size_t)(2 * shape_reach(s->shape) * pulse_duration(s, fmax(longest, 0)) +
			 0.4 * s->duration) +
		4;
	if (!reserve_samples(j, n) || !reserve_columns(j, support))
		return JOINT_MEMORY;
	j->n = n;
	j->steps = j->searches = 0;
	memcpy(j->e[0], y1, n * sizeof(double));
	memcpy(j->e[1], y2, n * sizeof(double));
	make_basis(j, s);
	for (int i = 0; i < m; i++)
		subtract(j, s, &pulses[i], 1);
	return JOINT_OK;
}

static void finish(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int m, double chi2, int full,
	struct joint_result *result)
{
	double taken = 0;

	qsort(pulses, (size_t)m, sizeof *pulses, by_time);
	fill_covariance(j, s, pulses, m);
	project(j);
	result->chi2 = chi2;
	for (int b = 0; b < j->basis; b++)
		taken += 2 * j->share[b];
	result->dof = 2 * (long)j->n - (long)(taken + 0.5) - PAR * m;
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
	enum { TRIES = 3 };
	enum joint_status status = start(j, s, y1, y2, n, pulses, *m);
	struct candidate tried[TRIES];
	int failed = 0;
	double chi2;

	if (status != JOINT_OK)
		return status;
	chi2 = fit_all(j, s, pulses, *m);
	do {
		while (failed < TRIES && *m < s->max_pulses) {
			struct candidate c = search(j, s, tried, failed);

			if (c.z2 < 0.3 * s->drop_near)
				break;
			if (try_pulse(j, s, pulses, m, &c, &chi2))
				failed = 0;
			else
				tried[failed++] = c;
		}
		chi2 = fit_all(j, s, pulses, *m);
	} while (split_pulses(j, s, pulses, m, &chi2));
	chi2 = merge_pulses(j, s, pulses, m, chi2);
	chi2 = prune(j, s, pulses, m, chi2);
	chi2 = fit_all(j, s, pulses, *m);
	finish(j, s, pulses, *m, chi2,
		*m == s->max_pulses && search(j, s, NULL, 0).z2 > s->drop, result);
	return JOINT_OK;
}

enum joint_status joint_refine(struct joint *j, const struct joint_scene *s,
	const double *y1, const double *y2, size_t n, struct joint_pulse *pulses, int m,
	struct joint_result *result)
{
	enum joint_status status = start(j, s, y1, y2, n, pulses, m);

	if (status == JOINT_OK)
		finish(j, s, pulses, m, fit_all(j, s, pulses, m), 0, result);
	return status;
}

const double *joint_residual(const struct joint *j, int channel)
{
	return j->r[channel];
}

void joint_add(const struct joint_scene *s, const struct joint_pulse *p, double sign,
	double *y1, double *y2, size_t n)
{
	double T = pulse_duration(s, p->delta), part[64];

	for (int c = 0; c < 2; c++) {
		double *y = c ? y2 : y1, t0 = p->t + (c ? p->delta : 0);
		size_t len, chunk;
		long first = pulse_window(s, p, c, n, &len);

		for (size_t done = 0; y && done < len; done += chunk) {
			chunk = len - done < 64 ? len - done : 64;
			shape_sample(s->shape, t0, T, first + (long)done, chunk, part,
				NULL, NULL);
			add_scaled(y + first + (long)done,
				sign * p->a * (c ? s->gain : 1), part, chunk);
		}
	}
}
