/* joint_model.c - contributions of pulses, tones and offset to the record; see
 * joint_state.h */
#include "num/lesser.h"
#include "num/sigmas.h"
#include "signal/fit/joint_state.h"
#include <limits.h>
#include <stdlib.h>
#include <string.h>

struct joint *joint_new(void)
{
	struct joint *j = calloc(1, sizeof *j);

	if (!j)
		return NULL;
	j->h = malloc(sizeof *j->h * 3 * OWN_MAX * NPAR);
	j->factor = malloc(sizeof *j->factor * NPAR * NPAR);
	j->bq = malloc(sizeof *j->bq * NPAR * 2 * BASIS_MAX);
	for (int i = 0; i < JOINT_PULSES_MAX; i++)
		j->all[i] = i;
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
	free(j->basis_memory);
	j->basis_memory = NULL;
	j->basis_used = 0;
	j->nbases = 0;
	j->capacity = 0;
}

void joint_free(struct joint *j)
{
	if (!j)
		return;
	free_samples(j);
	free(j->memory);
	free(j->scratch);
	free(j->excess);
	free(j->h);
	free(j->factor);
	free(j->bq);
	free(j);
}

static enum joint_status reserve_samples(struct joint *j, size_t n)
{
	if (n <= j->capacity)
		return JOINT_OK;
	free_samples(j);
	n += n / 2;
	for (int c = 0; c < 2; c++) {
		j->e[c] = malloc(n * sizeof *j->e[c]);
		j->r[c] = malloc(n * sizeof *j->r[c]);
		j->filter[c] = malloc(n * sizeof *j->filter[c]);
		if (!j->e[c] || !j->r[c] || !j->filter[c])
			return JOINT_MEMORY;
	}
	j->basis_memory = malloc(n * sizeof *j->basis_memory * BASIS_ROOM);
	if (!j->basis_memory)
		return JOINT_MEMORY;
	j->capacity = n;
	return JOINT_OK;
}

/* Samples that the longest pulse of a scene may touch. */
static double longest_support(const struct joint_scene *s)
{
	double longest = s->delta_max + JOINT_BEYOND * (s->delta_max - s->delta_min);
	double length = 2 * shape_reach(s->shape) * fmax(s->width, 1) *
			joint_duration(s, fmax(longest, 0), 0) *
			exp(SIGMAS_NEVER * s->scatter[JOINT_WIDTH]);

	return floor(length + 0.4 * s->duration) + 4;
}

enum joint_status joint_reserve_columns(struct joint *j, const struct joint_scene *s)
{
	size_t support = (size_t)longest_support(s);
	double *at;

	if (support <= j->support)
		return JOINT_OK;
	free(j->memory);
	free(j->scratch);
	free(j->excess);
	j->support = 0;
	j->memory =
		malloc(support * sizeof *j->memory * (JOINT_PULSES_MAX + 1) * 4 * PAR);
	j->scratch = malloc(support * sizeof *j->scratch * PAR);
	j->excess = malloc(support * sizeof *j->excess * PAIR_KNOTS);
	if (!j->memory || !j->scratch || !j->excess)
		return JOINT_MEMORY;
	j->support = support;
	at = j->memory;
	for (int i = 0; i <= JOINT_PULSES_MAX; i++)
		for (int c = 0; c < 2; c++)
			for (int k = 0; k < PAR; k++, at += 2 * support) {
				j->col[i][c].d[k] = at;
				j->trial[i][c].d[k] = at + support;
			}
	return JOINT_OK;
}

/* Makes vector b of q orthonormal to those from first on before it, by modified
 * Gram-Schmidt, done twice; NUM_DOMAIN if nothing of it is left. */
static enum num_status orthonormalise(double *q, int first, int b, size_t n)
{
	double *v = q + (size_t)b * n, norm = dot(v, v, n), left;

	for (int pass = 0; pass < 2; pass++)
		for (int k = first; k < b; k++)
			add_scaled(
				v, -dot(v, q + (size_t)k * n, n), q + (size_t)k * n, n);
	left = dot(v, v, n);
	if (left <= 1e-8 * norm || left == 0)
		return NUM_DOMAIN;
	left = 1 / sqrt(left);
	for (size_t i = 0; i < n; i++)
		v[i] *= left;
	return NUM_OK;
}

/* Vector b of channel c: cos or sin of w (i - n / 2), times a hat of half width hop about
 * sample knot, or as it is if hop is 0; hidden samples are 0. */
static void draw_wave(struct joint *j, int c, int b, double (*wave)(double), double w,
	double knot, double hop)
{
	double *v = j->basis->q[c] + (size_t)b * j->n, n = (double)j->n;
	size_t from = hop > 0 ? (size_t)clamp(ceil(knot - hop), 0, n) : 0;
	size_t to = hop > 0 ? (size_t)clamp(ceil(knot + hop), 0, n) : j->n;

	j->basis->from[c][b] = from;
	j->basis->to[c][b] = to;
	memset(v, 0, j->n * sizeof *v);
	for (size_t i = from; i < to; i++) {
		double hat = hop > 0 ? 1 - fabs((double)i - knot) / hop : 1;

		v[i] = hat * wave(w * ((double)i - n / 2));
	}
	joint_hide(j, c, 0, j->n, v);
}

/* Vector b of channel c becomes what, times itself, is taken from the inverse of the
 * covariance W^-1 of the record for a term of its shape with this prior variance: W b /
 * sqrt(1 / variance + b^T W b).  Returns the share of a degree of freedom that it takes.
 */
static double take_term(struct joint *j, int c, int b, double variance)
{
	double *v = j->basis->q[c] + (size_t)b * j->n, part[BASIS_MAX], norm, left, scale;
	size_t *from = j->basis->from[c], *to = j->basis->to[c], n = to[b] - from[b];

	norm = left = dot(v + from[b], v + from[b], n);
	joint_along(j, c, b, (long)from[b], v + from[b], n, part);
	for (int k = 0; k < b; k++)
		left -= part[k] * part[k];
	if (left <= 1e-8 * norm || left == 0) {
		memset(v, 0, j->n * sizeof *v);
		return 0;
	}
	for (int k = 0; k < b; k++) {
		const double *q = j->basis->q[c] + (size_t)k * j->n;

		if (part[k] == 0)
			continue;
		add_scaled(v + from[k], -part[k], q + from[k], to[k] - from[k]);
		from[b] = lesser(from[k], from[b]);
		to[b] = to[k] > to[b] ? to[k] : to[b];
	}
	scale = 1 / sqrt(1 / variance + left);
	for (size_t i = from[b]; i < to[b]; i++)
		v[i] *= scale;
	return left * scale * scale;
}

/* Adds what is left of tones that were removed from channel c: errors of their
 * coefficients at knots, with linear interpolation between.  Knots are farther apart if
 * there is no room for all; there are as many on either channel. */
static void add_known_tones(struct joint *j, int c, int most)
{
	const struct joint_scene *s = &j->scene;
	struct basis *b = j->basis;
	double n = (double)j->n, hop = s->tone_hop, first;

	while (hop > 0 && (2 + ceil(n / hop)) * 2 * s->tones > most)
		hop = hop < n ? 2 * hop : 0;
	first = hop > 0 ? s->tone_knot[c] - hop * ceil(s->tone_knot[c] / hop) : 0;
	for (double knot = first; knot < first + n + 2 * hop; knot += hop) {
		for (int k = 0; k < 2 * s->tones; k++) {
			draw_wave(j, c, b->vectors, k % 2 ? sin : cos, s->omega[k / 2],
				knot, hop);
			b->taken += take_term(j, c, b->vectors++, s->tone_variance);
		}
		if (hop == 0)
			break;
	}
}

/* The basis of channel c.  A baseline may be anything slower than low: waves of up to
 * that frequency that are periodic in 2 n, so that its ends need not meet. */
static void make_channel_basis(struct joint *j, int c)
{
	const struct joint_scene *s = &j->scene;
	int slow = (int)fmin(ceil(2 * (double)j->n * s->low), JOINT_BASELINE_MAX);
	int free_tones = isinf(s->tone_variance) ? s->tones : 0, known;
	struct basis *basis = j->basis;

	basis->vectors = 0;
	if (!free_tones && s->tones > 0)
		add_known_tones(j, c, BASIS_MAX - 2 * slow - 1);
	known = basis->vectors;
	for (int k = 2; k < 2 * slow + 2; k++) {
		const int halves = k / 2; /* half periods in n samples */

		draw_wave(j, c, basis->vectors++, k % 2 ? sin : cos,
			M_PI * halves / (double)j->n, 0, 0);
	}
	draw_wave(j, c, basis->vectors++, cos, 0, 0, 0);
	for (int k = 0; k < 2 * free_tones; k++)
		draw_wave(
			j, c, basis->vectors++, k % 2 ? sin : cos, s->omega[k / 2], 0, 0);
	for (int b = known; b < basis->vectors; b++)
		if (orthonormalise(basis->q[c], known, b, j->n) != NUM_OK)
			memset(basis->q[c] + (size_t)b * j->n, 0, j->n * sizeof(double));
	for (int b = known; b < basis->vectors; b++) {
		double share = known ? take_term(j, c, b, INFINITY) : 1;

		basis->taken += b < known + 2 * slow ? 0 : share;
	}
}

static int same_key(const double *a, const double *b)
{
	int k = 0;

	while (k < BASIS_OF && a[k] == b[k])
		k++;
	return k == BASIS_OF;
}

/* Basis of offset, baseline and tones over n samples. */
static void make_basis(struct joint *j)
{
	const struct joint_scene *s = &j->scene;
	const int hidden = s->hidden[0] || s->hidden[1];
	const int differ = hidden || (s->tones > 0 && s->tone_knot[0] != s->tone_knot[1]);
	double of[BASIS_OF] = { (double)j->n, differ, s->tones, s->tone_variance,
		s->tone_hop, s->tone_knot[0], s->tone_knot[1], s->low };
	struct basis *b;

	memcpy(of + BASIS_OF - JOINT_TONES_MAX, s->omega,
		(size_t)s->tones * sizeof *s->omega);
	for (int i = 0; i < j->nbases && !hidden; i++)
		if (same_key(j->bases[i].of, of)) {
			j->basis = &j->bases[i];
			return;
		}
	if (j->nbases == BASES ||
		j->basis_used + 2 * BASIS_MAX * j->n > BASIS_ROOM * j->capacity)
		j->nbases = 0;
	if (j->nbases == 0)
		j->basis_used = 0;
	b = j->basis = &j->bases[j->nbases];
	memcpy(b->of, of, sizeof of);
	b->taken = 0;
	b->q[0] = b->q[1] = j->basis_memory + j->basis_used;
	make_channel_basis(j, 0);
	if (differ) {
		b->q[1] += (size_t)b->vectors * j->n;
		make_channel_basis(j, 1);
	} else {
		b->taken *= 2;
		memcpy(b->from[1], b->from[0], sizeof b->from[0]);
		memcpy(b->to[1], b->to[0], sizeof b->to[0]);
	}
	if (hidden)
		return;
	j->basis_used += (size_t)(differ ? 2 : 1) * (size_t)b->vectors * j->n;
	j->nbases++;
}

/* Vectors that are not 0 in the same samples, as those of waves over the whole record and
 * of one knot, are taken three at a time. */
void joint_along(const struct joint *j, int c, int vectors, long first, const double *x,
	size_t n, double *along)
{
	const size_t *from = j->basis->from[c], *to = j->basis->to[c];

	for (int b = 0; b < vectors;) {
		const double *q = j->basis->q[c] + (size_t)b * j->n;
		long begin = first > (long)from[b] ? first : (long)from[b];
		long end = first + (long)n < (long)to[b] ? first + (long)n : (long)to[b];
		size_t some = end > begin ? (size_t)(end - begin) : 0;

		if (some > 0 && b + 3 <= vectors && from[b] == from[b + 1] &&
			from[b] == from[b + 2] && to[b] == to[b + 1] &&
			to[b] == to[b + 2]) {
			q += begin;
			dot3(x + (begin - first),
				(const double *[]){ q, q + j->n, q + 2 * j->n }, some,
				along + b);
			b += 3;
		} else {
			along[b++] = some ? dot(x + (begin - first), q + begin, some) : 0;
		}
	}
}

void joint_measure(struct joint *j)
{
	j->energy = 0;
	for (int c = 0; c < 2; c++) {
		j->energy += dot(j->e[c], j->e[c], j->n);
		joint_along(j, c, j->basis->vectors, 0, j->e[c], j->n, j->qe[c]);
	}
}

double joint_chi_square(const struct joint *j)
{
	double chi2 = j->energy;

	for (int c = 0; c < 2; c++)
		for (int b = 0; b < j->basis->vectors; b++)
			chi2 -= j->qe[c][b] * j->qe[c][b];
	return chi2;
}

void joint_project(struct joint *j)
{
	joint_measure(j);
	for (int c = 0; c < 2; c++) {
		const size_t *from = j->basis->from[c], *to = j->basis->to[c];

		memcpy(j->r[c], j->e[c], j->n * sizeof(double));
		for (int b = 0; b < j->basis->vectors; b++)
			add_scaled(j->r[c] + from[b], -j->qe[c][b],
				j->basis->q[c] + (size_t)b * j->n + from[b],
				to[b] - from[b]);
	}
}

void joint_hide(const struct joint *j, int channel, long first, size_t n, double *x)
{
	const unsigned char *flag = n > 0 ? j->scene.hidden[channel] : NULL;
	const unsigned char *begin = flag ? flag + first : NULL, *at = begin;

	while (at && (at = memchr(at, 1, n - (size_t)(at - begin))))
		x[at++ - begin] = 0;
}

size_t joint_visible(const struct joint *j, int channel, size_t from, size_t to)
{
	size_t count = to - from;

	for (size_t i = from; j->scene.hidden[channel] && i < to; i++)
		count -= j->scene.hidden[channel][i] != 0;
	return count;
}

/* The part of a pulse on channel c inside the n samples. */
static long pulse_window(const struct joint_scene *s, const struct joint_pulse *p, int c,
	size_t n, size_t *len)
{
	double T = joint_pulse_duration(s, p, c);
	long first = shape_support(s->shape, p->t + (c ? p->delta : 0), T, len);
	long last = first + (long)*len;

	if (first < 0)
		first = 0;
	if (last > (long)n)
		last = (long)n;
	*len = last > first ? (size_t)(last - first) : 0;
	return first;
}

void joint_subtract(struct joint *j, const struct joint_pulse *p, double sign)
{
	const struct joint_scene *s = &j->scene;

	for (int c = 0; c < 2; c++) {
		size_t len;
		long first = pulse_window(s, p, c, j->n, &len);

		shape_sample(s->shape, p->t + (c ? p->delta : 0),
			joint_pulse_duration(s, p, c), first, len, j->scratch, NULL,
			NULL);
		joint_hide(j, c, first, len, j->scratch);
		if (len)
			add_scaled(j->e[c] + first, -sign * joint_pulse_height(s, p, c),
				j->scratch, len);
	}
}

void joint_subtract_all(struct joint *j, double sign)
{
	for (int i = 0; i < j->m; i++)
		joint_subtract(j, &j->pulse[i], sign);
}

/* From derivatives by the arrival and by T, which grows by stretch with the arrival,
 * those by this arrival and by the other one, with amplitude a. */
LANES_CLONES static void turn_columns(
	double *by_t, double *by_T, double a, double stretch, size_t n)
{
	lanes4 x, longer;
	size_t k = 0;

	for (; k + 4 <= n; k += 4) {
		memcpy(&x, by_t + k, sizeof x);
		memcpy(&longer, by_T + k, sizeof x);
		longer *= stretch;
		x = a * (x + longer);
		longer *= -a;
		memcpy(by_t + k, &x, sizeof x);
		memcpy(by_T + k, &longer, sizeof x);
	}
	for (; k < n; k++) {
		double more = by_T[k] * stretch;

		by_t[k] = a * (by_t[k] + more);
		by_T[k] = -a * more;
	}
}

void joint_make_columns(struct joint *j, int i)
{
	const struct joint_scene *s = &j->scene;
	const struct joint_pulse *p = &j->pulse[i];
	const double gain = s->gain * exp(p->own[JOINT_RATIO]);

	for (int c = 0; c < 2; c++) {
		struct column *col = &j->col[i][c];
		double T = joint_pulse_duration(s, p, c);
		double stretch =
			joint_duration(s, 0, c) / s->transit * exp(p->own[JOINT_WIDTH]);
		double a = joint_pulse_height(s, p, c), *by_t, *by_T;

		col->first = pulse_window(s, p, c, j->n, &col->n);
		by_t = col->d[c];
		by_T = col->d[1 - c];
		shape_sample(s->shape, p->t + (c ? p->delta : 0), T, col->first, col->n,
			col->d[2], by_t, by_T);
		j->work += (double)col->n;
		/* T grows with t2 and falls with t1. */
		turn_columns(by_t, by_T, a, c ? stretch : -stretch, col->n);
		for (size_t k = 0; c && k < col->n; k++)
			col->d[2][k] *= gain;
		for (int k = 0; k < PAR; k++)
			joint_hide(j, c, col->first, col->n, col->d[k]);
	}
}

static int scene_is_sane(
	const struct joint_scene *s, const struct joint_pulse *pulses, int m)
{
	if (!s->shape || !(s->duration >= 4) || !(s->transit > 0) || !(s->gain > 0) ||
		!(s->width > 0) || !(s->delta_min <= s->delta_max) ||
		!(s->threshold >= 0) || !(s->threshold_near >= 0) ||
		!(s->tone_variance >= 0) || !(s->tone_hop >= 0) || s->tones < 0 ||
		!(s->low >= 0) || !(s->lost >= 0) || !(s->lost < 1) ||
		s->tones > JOINT_TONES_MAX || s->max_pulses < 0 ||
		s->max_pulses > JOINT_PULSES_MAX || m < 0 || m > s->max_pulses)
		return 0;
	/* Memory is reserved for it. */
	if (!(longest_support(s) < INT_MAX))
		return 0;
	/* The tolerance of joint_moved() must keep T positive. */
	if (s->delta_min - JOINT_BEYOND * (s->delta_max - s->delta_min) <= -s->transit)
		return 0;
	for (int i = 0; i < m; i++)
		if (!isfinite(pulses[i].t) || !isfinite(pulses[i].delta) ||
			!isfinite(pulses[i].a))
			return 0;
	return 1;
}

enum joint_status joint_start(struct joint *j, const struct joint_scene *s,
	const double *y1, const double *y2, size_t n, const struct joint_pulse *pulses,
	int m)
{
	enum joint_status status;

	if (!scene_is_sane(s, pulses, m) || n == 0)
		return JOINT_DOMAIN;
	status = joint_reserve_columns(j, s);
	if (status == JOINT_OK)
		status = reserve_samples(j, n);
	if (status != JOINT_OK)
		return status;
	j->n = n;
	j->result = (struct joint_result){ 0 };
	memcpy(j->e[0], y1, n * sizeof(double));
	memcpy(j->e[1], y2, n * sizeof(double));
	j->scene = *s;
	j->m = m;
	memcpy(j->pulse, pulses, (size_t)m * sizeof *pulses);
	for (int i = 0; i < m; i++)
		memset(j->pulse[i].own, 0, sizeof j->pulse[i].own);
	for (int c = 0; c < 2; c++)
		joint_hide(j, c, 0, n, j->e[c]);
	make_basis(j);
	joint_subtract_all(j, 1);
	return JOINT_OK;
}

double joint_work(const struct joint *j)
{
	return j->work;
}

const double *joint_residual(const struct joint *j, int channel)
{
	return j->r[channel];
}

void joint_add(const struct joint_scene *s, const struct joint_pulse *p, double sign,
	double *y1, double *y2, size_t n)
{
	double part[64];

	for (int c = 0; c < 2; c++) {
		double *y = c ? y2 : y1, t0 = p->t + (c ? p->delta : 0);
		double T = joint_pulse_duration(s, p, c);
		size_t len, chunk;
		long first = pulse_window(s, p, c, n, &len);

		for (size_t done = 0; y && done < len; done += chunk) {
			chunk = len - done < 64 ? len - done : 64;
			shape_sample(s->shape, t0, T, first + (long)done, chunk, part,
				NULL, NULL);
			add_scaled(y + first + (long)done,
				sign * joint_pulse_height(s, p, c), part, chunk);
		}
	}
}
