/* learn.c - see learn.h */
#include "signal/learn.h"
#include "signal/robust.h"
#include "signal/sections.h"
#include "signal/template.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Stretches with one pulse that a free form can be learned from. */
enum { ENOUGH = 5, MANY = 20 };

/* Multiplications per sample of a fit under a form that is one of several: what nine of
 * ten fits under the right one take (joint.h). */
static const double QUICK = 20000;

/* Share of a pulse's energy that a form far from its own may leave. */
static const double ROUGH = 0.05;

/* Chi-square per degree of freedom that asks for no other form. */
static const double FITS = 1.05;

/* Change of a logarithm that leaves things as they are. */
static const double SURE = 0.15;

/* Deviations of chi-square that noise does not reach. */
static const double BEYOND = 5;

/* Multiplications per sample that one round of learning may take, and the samples that it
 * may take them for in any case: what it learns from is as much in a short record.  A
 * crowd of 50 particles a second takes 20 000, one of long tails 120 000 of 2.5 s. */
static const double WORK = 50000, AT_LEAST = 37000;

/* --- stretches */

/* Keeps stretch s if it is among the loudest; merit: of those kept. */
static void offer(struct learning *l, const struct stretch *s, int most, double shortest,
	double *merit)
{
	double energy = 0, here, length = (double)s->n;
	int at;

	for (int c = 0; c < 2; c++)
		for (size_t i = 0; i < s->n; i++)
			energy += s->y[c][i] * s->y[c][i] - 1;
	/* Loud is good; few pulses are better. */
	here = energy * pow(shortest / length, 4);
	for (at = l->count; at > 0 && merit[at - 1] < here; at--)
		if (at < most) {
			merit[at] = merit[at - 1];
			l->stretch[at] = l->stretch[at - 1];
		}
	if (at == most)
		return;
	merit[at] = here;
	l->stretch[at] = *s;
	l->count += l->count < most;
}

/* The clearest sections of the record; of long ones, pieces if allowed. */
static int pick(struct learning *l, double *const y[2], unsigned char *const bad[2],
	size_t n, int most, int allow_pieces)
{
	const struct joint_scene *scene = &l->scene;
	double merit[LEARN_STRETCHES] = { 0 };
	struct sections *s = sections_new(scene, BEYOND);
	struct section section;
	double longest =
		scene->duration * (1 + fmax(scene->delta_max, 0) / scene->transit);
	double reach = fmax(shape_reach_above(scene->shape[0], 0.01),
		shape_reach_above(scene->shape[1], 0.01));
	long margin =
		(long)(1.2 * reach * longest + fmax(scene->delta_max, -scene->delta_min));

	l->count = 0;
	if (!s)
		return 0;
	sections_scan(s, y[0], y[1], 0, n, (long long)n);
	sections_end(s);
	while (sections_first(s, &section)) {
		long long begin = section.begin > 0 ? section.begin : 0;
		long long end = section.end < (long long)n ? section.end : (long long)n;
		long long pieces = 1 + (end - begin) / (6 * margin);

		for (long long k = 0; k < pieces && (pieces == 1 || allow_pieces); k++) {
			long long from = begin + (end - begin) * k / pieces;
			long long to = begin + (end - begin) * (k + 1) / pieces;
			struct stretch one = { .from = (long)from,
				.y = { y[0] + from, y[1] + from },
				.bad = { bad[0] + from, bad[1] + from },
				.n = to > from ? (size_t)(to - from) : 0 };

			if ((double)one.n > 1.5 * (double)margin)
				offer(l, &one, most, 2 * (double)margin, merit);
		}
		sections_take(s, section.end);
	}
	sections_free(s);
	return 1;
}

/* Largest matched filter of either channel at every twenty-fourth of a duration. */
static double *filter_record(const struct joint_scene *s, double *const y[2], size_t n,
	size_t stride, size_t *points)
{
	double *z, *p;

	*points = (n + stride - 1) / stride;
	z = calloc(*points, sizeof *z);
	for (int c = 0; z && c < 2; c++) {
		double norm = 1 / sqrt(s->duration * shape_energy(s->shape[c]));
		size_t len;
		long first = shape_support(s->shape[c], 0, s->duration, &len);

		p = malloc(len * sizeof *p);
		if (!p) {
			free(z);
			return NULL;
		}
		shape_sample(s->shape[c], 0, s->duration, first, len, p, NULL, NULL);
		for (size_t k = 0; k < *points; k++) {
			long from = (long)(k * stride) + first;
			double sum = 0;

			if (from < 0 || from + (long)len > (long)n)
				continue;
			for (size_t i = 0; i < len; i++)
				sum += p[i] * y[c][from + (long)i];
			z[k] = fmax(z[k], fabs(sum) * norm);
		}
		free(p);
	}
	return z;
}

/* Nothing within two durations of a lone pulse is louder than this share of it. */
static const double NEIGHBOUR = 0.3;

/* Stretches around lone pulses, the loudest of the record.  They reach as far as a free
 * form does. */
static int pick_lone(
	struct learning *l, double *const y[2], unsigned char *const bad[2], size_t n)
{
	const struct joint_scene *s = &l->scene;
	double merit[LEARN_STRETCHES] = { 0 }, T = s->duration;
	double half = (double)(TEMPLATE_HALF + 2) / TEMPLATE_KNOTS * T +
		      fmax(s->delta_max, -s->delta_min);
	size_t points, stride = T >= 48 ? (size_t)(T / 24) : 1;
	long reach = (long)(2 * T / (double)stride), core = (long)(T / (double)stride);
	double *z = filter_record(s, y, n, stride, &points);

	l->count = 0;
	for (long k = 0; z && k < (long)points; k++) {
		long at = k * (long)stride, from = (long)((double)at - half),
		     to = (long)((double)at + half);
		int lone = z[k] > 8;

		for (long i = k - reach; lone && i <= k + reach; i++)
			if (i >= 0 && i < (long)points && i != k)
				lone = labs(i - k) <= core
					       ? z[i] < z[k] || (z[i] == z[k] && i > k)
					       : z[i] < NEIGHBOUR * z[k];
		from = from < 0 ? 0 : from;
		to = to > (long)n ? (long)n : to;
		if (lone && (double)(to - from) > half) {
			struct stretch one = { .from = from,
				.y = { y[0] + from, y[1] + from },
				.bad = { bad[0] + from, bad[1] + from },
				.n = (size_t)(to - from),
				.lone = 1 };

			offer(l, &one, LEARN_STRETCHES, (double)one.n, merit);
		}
	}
	free(z);
	return z != NULL;
}

/* --- fits */

static double pulse_energy(const struct joint_scene *s, const struct joint_pulse *p)
{
	double unit =
		shape_energy(s->shape[0]) + s->gain * s->gain * shape_energy(s->shape[1]);

	return p->a * p->a * unit * s->duration * (1 + p->delta / s->transit);
}

/* Fits the pulses of a stretch; search: looks for them anew. */
static int fit_one(struct learning *l, struct stretch *s, int search)
{
	struct joint_result r;
	enum joint_status status;

	for (int c = 0; c < 2; c++)
		l->scene.bad[c] = s->bad[c];
	if (search)
		s->m = 0;
	status = search ? joint_fit(l->joint, &l->scene, s->y[0], s->y[1], s->n, s->pulse,
				  &s->m, &r)
			: joint_refine(l->joint, &l->scene, s->y[0], s->y[1], s->n,
				  s->pulse, s->m, &r);
	l->failed |= status == JOINT_DOMAIN;
	if (status != JOINT_OK)
		return 0;
	s->chi2 = r.chi2;
	s->dof = (double)r.dof;
	s->energy = 0;
	for (int i = 0; i < s->m; i++)
		s->energy += pulse_energy(&l->scene, &s->pulse[i]);
	return 1;
}

/* Error of the form and of the noise's power from what stretches leave beside noise:
 * chi2 - dof = (level - 1) dof + error^2 energy, by least squares that leaves out what is
 * foreign.  part: every second stretch from this one on; -1: all. */
static void judge_stretches(
	struct learning *l, int part, double *level, double *error2, double *error2_se)
{
	*level = 1;
	*error2_se = 0;
	for (int i = 0; i < l->count; i++)
		l->stretch[i].foreign = 0;
	{ /* At first the median of what each leaves says what is foreign. */
		double left[LEARN_STRETCHES];
		size_t n = 0;

		for (int i = 0; i < l->count; i++)
			if (l->stretch[i].m > 0 && (part < 0 || i % 2 == part))
				left[n++] = (l->stretch[i].chi2 - l->stretch[i].dof) /
					    l->stretch[i].energy;
		*error2 = 2 * fmax(robust_median(left, n), 0);
	}
	for (int pass = 0; pass < 4; pass++) {
		double aa = 0, ae = 0, ee = 0, ay = 0, ey = 0, det, share, alpha;

		for (int i = 0; i < l->count; i++) {
			struct stretch *s = &l->stretch[i];
			double y = s->chi2 - s->dof, noise = sqrt(2 * s->dof), weight;

			s->foreign = s->m == 0 || y > (*level - 1) * s->dof +
								  BEYOND * noise +
								  4 * *error2 * s->energy;
			if (s->foreign || (part >= 0 && i % 2 != part))
				continue;
			weight = 1 / (2 * s->dof + pow(*error2 * s->energy, 2));
			aa += weight * s->dof * s->dof;
			ae += weight * s->dof * s->energy;
			ee += weight * s->energy * s->energy;
			ay += weight * s->dof * y;
			ey += weight * s->energy * y;
		}
		if (!(aa > 0) || !(ee > 0))
			return;
		/* The level is known to a few per cent without them. */
		aa += 1 / (0.05 * 0.05);
		det = aa * ee - ae * ae;
		share = (aa * ey - ae * ay) / det;
		alpha = (ee * ay - ae * ey) / det;
		if (share < 0) {
			share = 0;
			alpha = ay / aa;
		}
		*error2 = share;
		*error2_se = sqrt(aa / det);
		*level = 1 + alpha;
	}
}

static double total_chi2(const struct learning *l)
{
	double sum = 0;

	for (int i = 0; i < l->count; i++)
		if (!l->stretch[i].foreign)
			sum += l->stretch[i].chi2;
	return sum;
}

static double median_chi2(const struct learning *l)
{
	double each[LEARN_STRETCHES];
	size_t n = 0;

	for (int i = 0; i < l->count; i++)
		if (l->stretch[i].m > 0)
			each[n++] = l->stretch[i].chi2 / l->stretch[i].dof;
	return n ? robust_median(each, n) : INFINITY;
}

static int fit_all(struct learning *l, int search)
{
	double dof = 0, price = 0;

	for (int i = 0; i < l->count; i++) {
		struct stretch *s = &l->stretch[i];

		l->failed |= joint_operations(l->joint) > l->limit;
		if (l->failed || !fit_one(l, s, search))
			return 0;
		price += s->chi2 + 2 * l->scene.drop_near * s->m;
		dof += s->dof;
	}
	l->price = dof > 0 ? price / dof : INFINITY;
	return 1;
}

/* --- the pulse */

static void use_scene(struct learning *l, const struct calibration *c, int most)
{
	double negative = l->scene.negative;

	calibration_scene(c, &l->scene);
	l->scene.tones = 0; /* what is learned from is clean */
	l->scene.max_pulses = most;
	l->scene.negative = negative;
}

static int use_shape(struct learning *l, struct calibration *c, struct shape *plain)
{
	if (!plain)
		return 0;
	shape_free(c->plain);
	c->plain = plain;
	if (!calibration_set_shapes(c))
		return 0;
	l->scene.shape[0] = c->shape[0];
	l->scene.shape[1] = c->shape[1];
	return 1;
}

/* Ratio of the gains from what is left of either channel's pulses. */
static void update_gain(struct learning *l, struct calibration *c)
{
	double in[2] = { 0, 0 }, out[2] = { 0, 0 };

	for (int i = 0; i < l->count; i++) {
		struct stretch *s = &l->stretch[i];

		if (s->foreign || s->m == 0 || !fit_one(l, s, 0))
			continue;
		for (int k = 0; k < 2; k++) {
			const double *r = joint_residual(l->joint, k);

			for (size_t n = 0; n < s->n; n++) {
				double model = s->bad[k][n] ? 0 : s->y[k][n] - r[n];

				in[k] += model * model;
				out[k] += model * r[n];
			}
		}
	}
	if (in[0] > 0 && in[1] > 0)
		l->scene.gain *= (1 + out[1] / in[1]) / (1 + out[0] / in[0]);
	c->gain = l->scene.gain * c->noise[1] / c->noise[0];
}

/* The free form from stretches of a parity (-1: all). */
static int update_free(
	struct learning *l, struct template *t, int part, struct calibration *c)
{
	double scale, shift;
	struct shape *plain;

	template_clear(t);
	for (int i = 0; i < l->count; i++) {
		struct stretch *s = &l->stretch[i];

		if (s->foreign || s->m == 0 || (part >= 0 && i % 2 != part))
			continue;
		l->scene.bad[0] = s->bad[0];
		l->scene.bad[1] = s->bad[1];
		template_add(t, &l->scene, s->y[0], s->y[1], s->n, s->pulse, s->m);
	}
	plain = template_solve(t, &scale, &shift);
	l->failed |= !plain;
	if (!plain || !use_shape(l, c, plain))
		return 0;
	for (int i = 0; i < l->count; i++)
		for (int k = 0; k < l->stretch[i].m; k++) {
			l->stretch[i].pulse[k].a *= scale;
			l->stretch[i].pulse[k].t += shift * c->duration;
		}
	return 1;
}

/* One Newton step of the duration: the residual on the derivative of all pulses by it, of
 * which the part that moving and scaling them can do is gone from the residual. */
static void update_duration(struct learning *l, struct calibration *c)
{
	double step = 2e-3, before, after, behind, bend, move;

	before = total_chi2(l);
	c->duration *= 1 + step;
	l->scene.duration = c->duration;
	if (!calibration_set_shapes(c))
		return;
	l->scene.shape[0] = c->shape[0];
	l->scene.shape[1] = c->shape[1];
	fit_all(l, 0);
	after = total_chi2(l);
	c->duration *= (1 - step) / (1 + step);
	l->scene.duration = c->duration;
	if (!calibration_set_shapes(c))
		return;
	l->scene.shape[0] = c->shape[0];
	l->scene.shape[1] = c->shape[1];
	fit_all(l, 0);
	behind = total_chi2(l);
	bend = after - 2 * before + behind;
	move = bend > 0 ? 0.5 * (behind - after) / bend : behind < after ? -1 : 1;
	move = fmin(fmax(move * step, -0.05), 0.05);
	c->duration *= (1 + move) / (1 - step);
	l->scene.duration = c->duration;
	if (calibration_set_shapes(c)) {
		l->scene.shape[0] = c->shape[0];
		l->scene.shape[1] = c->shape[1];
	}
	fit_all(l, 0);
}

/* --- lone pulses: the free form */

/* Values of a stretch's first channel around its pulse, at KNOTS to the duration, of unit
 * energy. */
enum { WAVE = TEMPLATE_COUNT };
struct wave {
	double v[WAVE];
	int sign;
	long shift; /* knots it is moved by to agree with the reference */
};

static int draw_wave(const struct learning *l, const struct stretch *s, struct wave *w)
{
	double step = l->scene.duration / TEMPLATE_KNOTS, energy = 0;

	for (int k = 0; k < WAVE; k++) {
		double at = s->pulse[0].t + (k - TEMPLATE_HALF) * step;
		long i = (long)floor(at);
		double part = at - (double)i;

		w->v[k] = i >= 0 && i + 1 < (long)s->n
				  ? (1 - part) * s->y[0][i] + part * s->y[0][i + 1]
				  : 0;
		energy += w->v[k] * w->v[k];
	}
	for (int k = 0; k < WAVE; k++)
		w->v[k] /= sqrt(fmax(energy, 1e-300));
	return energy > 0;
}

/* Correlation with another, moved as is best by up to a quarter of a duration. */
static double agree(const struct wave *x, const struct wave *y, long *shift)
{
	double best = 0;

	for (long k = -TEMPLATE_KNOTS / 4; k <= TEMPLATE_KNOTS / 4; k++) {
		double sum = 0;

		for (long i = 0; i < WAVE; i++)
			if (i + k >= 0 && i + k < WAVE)
				sum += x->v[i] * y->v[i + k];
		if (fabs(sum) > fabs(best)) {
			best = sum;
			*shift = k;
		}
	}
	return best;
}

/* Takes from the lone stretches the pulse on which most of them agree within the noise;
 * the others are foreign.  Returns how many do. */
static int find_common(struct learning *l)
{
	struct wave *w = calloc(LEARN_STRETCHES, sizeof *w);
	int best = -1, most = 0;

	for (int i = 0; w && i < l->count; i++)
		l->stretch[i].foreign = !l->stretch[i].lone || l->stretch[i].m != 1 ||
					!draw_wave(l, &l->stretch[i], &w[i]);
	for (int pass = 0; w && pass < 2; pass++)
		for (int i = pass ? best : 0; i < (pass ? best + 1 : l->count) && i >= 0;
			i++) {
			int count = 0;

			for (int k = 0; k < l->count; k++) {
				struct stretch *s = &l->stretch[i], *o = &l->stretch[k];
				double noise, r;
				long shift = 0;

				if (s->foreign || o->foreign)
					continue;
				/* Half of an energy is that of channel 1, more or less.
				 */
				noise = WAVE * (2 / s->energy + 2 / o->energy) *
					(l->scene.duration / TEMPLATE_KNOTS);
				r = i == k ? 1 : agree(&w[i], &w[k], &shift);
				if (1 - r * r > 0.02 + fmin(noise, 0.2)) {
					if (pass)
						w[k].sign = 0;
					continue;
				}
				count++;
				w[k].sign = r > 0 ? 1 : -1;
				w[k].shift = shift;
			}
			if (!pass && count > most) {
				most = count;
				best = i;
			}
		}
	for (int k = 0; w && k < l->count; k++) {
		struct stretch *s = &l->stretch[k];

		if (s->foreign)
			continue;
		if (w[k].sign == 0) {
			s->foreign = 1;
			continue;
		}
		s->pulse[0].t += (double)w[k].shift * l->scene.duration / TEMPLATE_KNOTS;
		s->pulse[0].a = w[k].sign * fabs(s->pulse[0].a);
	}
	free(w);
	return most;
}

/* Chi-square of a form over that of the best so far from which it cannot come down. */
static const double HOPELESS = 4;

/* What a form costs: its chi-square, and three deviations of what so many parameters take
 * from it by chance. */
static double cost(double chi2, double parameters)
{
	return chi2 + parameters + 3 * sqrt(2 * parameters);
}

/* The free form by turns with the pulses, from stretches of a parity. */
static int turn_free(struct learning *l, struct calibration *c, int part, int rounds)
{
	struct template *t = template_new(c->duration, c->through ? NULL : c->whitening);
	double level, error2 = 0, se;
	int ok = t != NULL;

	c->pulse = CALIBRATE_ANY_PULSE;
	for (int k = 0; ok && k < rounds; k++) {
		ok = update_free(l, t, part, c) && fit_all(l, 0);
		update_gain(l, c);
		if (k > 0)
			judge_stretches(l, part, &level, &error2, &se);
	}
	template_free(t);
	return ok;
}

/* Lag at which the autocorrelation of a pulse is lowest, as a share of its duration. */
static double lowest_lag(const struct shape *shape)
{
	enum { T = 100, LAGS = 120 };
	size_t n = (size_t)(2 * shape_reach(shape) * T) + 2;
	double *p = calloc(n + LAGS, sizeof *p), low = 0.5, least = 0;

	if (p) {
		shape_sample(shape, shape_reach(shape) * T, T, 0, n, p, NULL, NULL);
		for (int k = 1; k <= LAGS; k++) {
			double r = 0;

			for (size_t i = 0; i < n; i++)
				r += p[i] * p[i + (size_t)k];
			if (r < least) {
				least = r;
				low = (double)k / T;
			}
		}
	}
	free(p);
	return low;
}

struct state {
	struct shape *plain;
	struct stretch stretch[LEARN_STRETCHES];
	double duration, gain, cost;
	int pulse, through;
};

static int save(const struct learning *l, const struct calibration *c, double cost,
	struct state *s)
{
	shape_free(s->plain);
	s->plain = shape_filter(c->plain, 256, NULL, 0, 0);
	memcpy(s->stretch, l->stretch, sizeof s->stretch);
	s->duration = c->duration;
	s->gain = c->gain;
	s->cost = cost;
	s->pulse = c->pulse;
	s->through = c->through;
	return s->plain != NULL;
}

static int restore(struct learning *l, struct calibration *c, struct state *s)
{
	struct shape *plain = shape_filter(s->plain, 256, NULL, 0, 0);

	memcpy(l->stretch, s->stretch, sizeof s->stretch);
	c->duration = s->duration;
	c->gain = s->gain;
	c->pulse = s->pulse;
	c->through = s->through;
	l->scene.duration = c->duration;
	l->scene.gain = c->gain * c->noise[0] / c->noise[1];
	return use_shape(l, c, plain);
}

/* Fits one of the pulses of sensor.h to the stretches that agree; its duration starts
 * where its autocorrelation is that of the free form. */
static int turn_known(const struct calibrate_par *par, struct learning *l,
	struct calibration *c, int pulse, double low, double best)
{
	enum { ROUNDS = 6 };
	struct shape *plain = shape_new((enum pulse_shape)pulse);

	if (!plain)
		return 0;
	c->pulse = pulse;
	c->duration = isnan(par->duration) ? low / lowest_lag(plain) : par->duration;
	l->scene.duration = c->duration;
	if (!use_shape(l, c, plain) || !fit_all(l, 0))
		return 0;
	for (int k = 0; k < ROUNDS && total_chi2(l) < HOPELESS * best; k++) {
		double before = c->duration;

		if (isnan(par->duration))
			update_duration(l, c);
		update_gain(l, c);
		if (fabs(c->duration - before) < 1e-4 * before)
			break;
	}
	return fit_all(l, 0);
}

/* Is there a pulse of sensor.h that does as well as the free form? */
static int choose_form(const struct calibrate_par *par, struct learning *l,
	struct calibration *c, int again, int known, int through_known)
{
	struct state *free_form = calloc(1, sizeof *free_form),
		     *best = calloc(1, sizeof *best);
	double low = c->duration * lowest_lag(c->plain);
	int filtered = c->whitening[0].tap != NULL && !par->filter;
	int ok = free_form && best;

	ok = ok && save(l, c, cost(total_chi2(l), TEMPLATE_COUNT), free_form) &&
	     save(l, c, free_form->cost, best);
	for (int through = 0; ok && through <= filtered; through++)
		for (int p = PULSE_SINE; ok && p <= PULSE_LORENTZ; p++) {
			double here;

			if (par->pulse != CALIBRATE_ANY_PULSE
					? p != par->pulse
					: again && (p != known ||
							   through != through_known))
				continue;
			ok = restore(l, c, free_form);
			c->through = through;
			ok = ok && turn_known(par, l, c, p, low, best->cost);
			here = cost(total_chi2(l), 2);
			if (ok && here < best->cost)
				ok = save(l, c, here, best);
		}
	ok = ok && restore(l, c, best) && fit_all(l, 0);
	for (int k = 0; k < 2; k++) {
		struct state *s = k ? best : free_form;

		if (s)
			shape_free(s->plain);
		free(s);
	}
	return ok;
}

/* --- crowds: the best of the pulses of sensor.h by joint fits */

/* Under one of these forms, as it is at first: what the pulses found by it cost. */
static int try_crowd(struct learning *l, struct calibration *c, int pulse,
	double duration, struct state *best)
{
	struct shape *plain = shape_new((enum pulse_shape)pulse);

	if (!plain)
		return 0;
	c->pulse = pulse;
	c->duration = duration;
	l->scene.duration = duration;
	l->scene.misfit = ROUGH;
	l->scene.work = QUICK;
	return use_shape(l, c, plain) && fit_all(l, 1) &&
	       (!(l->price < best->cost) || save(l, c, l->price, best));
}

/* Duration and gain of the best of them. */
static int settle_crowd(
	const struct calibrate_par *par, struct learning *l, struct calibration *c)
{
	enum { ROUNDS = 2 };
	int ok = 1;

	for (int k = 0; ok && k < ROUNDS; k++) {
		for (int i = 0; i < l->count; i++)
			l->stretch[i].foreign = 0;
		for (int turn = 0; turn < 2 && isnan(par->duration); turn++)
			update_duration(l, c);
		if (isnan(par->gain))
			update_gain(l, c);
		l->scene.misfit *= 0.1;
		ok = fit_all(l, 1);
	}
	return ok;
}

/* Duration and gain by turns with the pulses of some pieces of a crowd: the closer they
 * come, the smaller a pulse may be that is not just a misfit of its neighbour. */
static int converge(const struct calibrate_par *par, struct learning *l,
	double *const y[2], unsigned char *const bad[2], size_t n, struct calibration *c)
{
	enum { ROUNDS = 8 };
	double before = 0, level, error2, se;
	int ok = pick(l, y, bad, n, 16, 1);

	l->pieces = 1;
	l->scene.misfit = 1e-3;
	ok = ok && fit_all(l, 1);
	l->scene.misfit = 2e-4;
	for (int k = 0; ok && k < ROUNDS && fabs(c->duration / before - 1) > 3e-4; k++) {
		before = c->duration;
		judge_stretches(l, -1, &level, &error2, &se);
		if (isnan(par->duration))
			update_duration(l, c);
		if (isnan(par->gain))
			update_gain(l, c);
		/* A form as good as it was finds the same pulses. */
		ok = fit_all(l, l->scene.misfit > 1e-4 || k % 3 == 2);
		l->scene.misfit = 1e-4;
	}
	return ok;
}

static int learn_crowd(const struct calibrate_par *par, struct learning *l,
	double *const y[2], unsigned char *const bad[2], size_t n, struct calibration *c)
{
	static const double factor[] = { 1, 0.7, 1.4 };
	struct state *best = calloc(1, sizeof *best);
	struct shape *sine = shape_new(PULSE_SINE);
	double low = sine ? c->duration * lowest_lag(sine) : 0;
	int ok = best && sine && use_shape(l, c, sine);

	if (ok)
		best->cost = INFINITY;
	ok = ok && pick(l, y, bad, n, 8, 1);
	for (int k = 0; ok && k < 3 && !(best->cost < 2); k++) {
		double before = best->cost;

		for (int p = PULSE_SINE; ok && p <= PULSE_LORENTZ; p++) {
			struct shape *plain = shape_new((enum pulse_shape)p);
			double duration = isnan(par->duration) && plain
						  ? factor[k] * low / lowest_lag(plain)
						  : par->duration;

			shape_free(plain);
			if ((k > 0 && !isnan(par->duration)) ||
				(par->pulse != CALIBRATE_ANY_PULSE && p != par->pulse) ||
				duration < 8)
				continue;
			ok = try_crowd(l, c, p, duration, best);
		}
		if (ok && best->cost < before)
			ok = restore(l, c, best) && settle_crowd(par, l, c) &&
			     (!(l->price < best->cost) || save(l, c, l->price, best));
	}
	if (ok && !best->plain)
		l->count = 0; /* nothing at all */
	else
		ok = ok && restore(l, c, best) && converge(par, l, y, bad, n, c);
	if (best)
		shape_free(best->plain);
	free(best);
	return ok;
}

/* --- all together */

/* Range of the delays seen, widened by half on either side. */
static void learn_range(
	const struct calibrate_par *par, const struct learning *l, struct calibration *c)
{
	enum { RANGE_EVENTS = 12 };
	double lo = INFINITY, hi = -INFINITY, margin;
	double sum = 0, squares = 0, noise = 0;
	int events = 0;

	for (int i = 0; i < l->count; i++)
		for (int k = 0; k < l->stretch[i].m && !l->stretch[i].foreign; k++) {
			const struct joint_pulse *p = &l->stretch[i].pulse[k];

			lo = fmin(lo, p->delta);
			hi = fmax(hi, p->delta);
			sum += p->delta;
			squares += p->delta * p->delta;
			noise += p->cov[0] - 2 * p->cov[1] + p->cov[2];
			events++;
		}
	c->delta_var =
		events ? fmax((squares - sum * sum / events - noise) / events, 0) : 0;
	margin = fmax(0.5 * (hi - lo), 0.02 * c->duration);
	if (isnan(par->spread) && events >= RANGE_EVENTS) {
		c->delta_min = fmax(c->delta_min, lo - margin);
		c->delta_max = fmin(c->delta_max, hi + margin);
	}
}

/* Most pulses are taken for positive; are there others? */
static void learn_sign(struct learning *l, struct calibration *c)
{
	int positive = 0, negative = 0;

	for (int i = 0; i < l->count; i++)
		for (int k = 0; k < l->stretch[i].m && !l->stretch[i].foreign; k++)
			*(l->stretch[i].pulse[k].a > 0 ? &positive : &negative) += 1;
	c->reversed = negative > positive;
	c->negatives = negative > 0 && positive > 0;
	c->events = positive + negative;
}

static double total_energy(const struct learning *l)
{
	double sum = 0;

	for (int i = 0; i < l->count; i++)
		if (!l->stretch[i].foreign)
			sum += l->stretch[i].energy;
	return fmax(sum, 1);
}

/* How well a form learned from half of the stretches describes the other half. */
static int validate(struct learning *l, struct calibration *c)
{
	struct state *whole = calloc(1, sizeof *whole);
	double sum = 0, se2 = 0, level = 0;
	int ok = whole && save(l, c, 0, whole), form = c->pulse;

	for (int part = 0; ok && part < 2; part++) {
		double here, error2 = 0, se = 0;

		if (form == CALIBRATE_ANY_PULSE)
			ok = turn_free(l, c, part, 2);
		judge_stretches(l, 1 - part, &here, &error2, &se);
		sum += error2 / 2;
		se2 += se * se / 4;
		level += here / 2;
		ok = ok && restore(l, c, whole);
	}
	if (ok)
		ok = fit_all(l, 0);
	if (whole)
		shape_free(whole->plain);
	free(whole);
	c->level = level;
	c->error = sqrt(sum);
	c->error_least = sqrt(sqrt(se2));
	c->error_floor = sqrt(
		(form == CALIBRATE_ANY_PULSE ? TEMPLATE_COUNT : 2) / total_energy(l));
	return ok;
}

/* Lone pulses give the form; 0 where there are too few that agree. */
static int learn_lone(const struct calibrate_par *par, struct learning *l,
	double *const y[2], unsigned char *const bad[2], size_t n, int again,
	struct calibration *c, int *ok)
{
	int lone, known = c->pulse, through = c->through;

	for (int pass = 0; pass < 2; pass++) {
		struct shape *sine;
		double duration;

		use_scene(l, c, 1);
		l->scene.misfit = INFINITY;
		*ok = *ok && pick_lone(l, y, bad, n) && fit_all(l, 1);
		lone = *ok ? find_common(l) : 0;
		if (!*ok || lone < ENOUGH)
			return 0;
		*ok = turn_free(l, c, -1, again ? 3 : 5);
		sine = shape_new(PULSE_SINE);
		if (!*ok || !sine)
			return *ok = 0;
		duration = c->duration * lowest_lag(c->plain) / lowest_lag(sine);
		if (again || pass || !isnan(par->duration) ||
			fabs(log(duration / c->duration)) < SURE) {
			shape_free(sine);
			break;
		}
		/* The first guess was off: once more, as wide as the pulse is. */
		c->duration = duration;
		*ok = use_shape(l, c, sine);
	}
	*ok = *ok && choose_form(par, l, c, again, known, through);
	return 1;
}

/* Pulses that overlap others tell their form, too: where few stand alone, these are
 * fitted together and all learned from. */
static int learn_more(const struct calibrate_par *par, struct learning *l,
	double *const y[2], unsigned char *const bad[2], size_t n, struct calibration *c,
	double misfit)
{
	enum { ROUNDS = 4 };
	double level, error2 = 1, se, price = l->price;
	int ok = 1;

	for (int k = 0; ok && k < ROUNDS; k++) {
		if (l->count)
			judge_stretches(l, -1, &level, &error2, &se);
		use_scene(l, c, LEARN_PULSES);
		l->scene.misfit = fmax(misfit,
			3 * fmin(error2 + 2 * se, CALIBRATE_ERROR * CALIBRATE_ERROR));
		misfit *= 0.2;
		ok = pick(l, y, bad, n, 24, 0) && fit_all(l, 1);
		if (!ok || l->count < ENOUGH)
			break;
		if (misfit > 0 && l->price > 10 * price)
			break;
		judge_stretches(l, -1, &level, &error2, &se);
		if (c->pulse != CALIBRATE_ANY_PULSE && median_chi2(l) < FITS) {
			double before = c->duration;

			for (int turn = 0; ok && turn < 2 && isnan(par->duration); turn++)
				update_duration(l, c);
			update_gain(l, c);
			if (misfit < 1e-3 && fabs(c->duration / before - 1) < 5e-4)
				break;
			continue;
		}
		ok = ok && turn_free(l, c, -1, 2) && choose_form(par, l, c, 0, 0, 0);
	}
	return ok;
}

/* A form of its own may do with fewer pulses than those of sensor.h, each of which costs
 * what it must take away. */
static int learn_rough(const struct calibrate_par *par, struct learning *l,
	double *const y[2], unsigned char *const bad[2], size_t n, struct calibration *c)
{
	struct state *before = calloc(1, sizeof *before);
	double price = l->price;
	int count = l->count, ok = before && save(l, c, 0, before) &&
				   learn_more(par, l, y, bad, n, c, ROUGH);

	l->pieces = 0;
	if (ok && (!(l->price < price) || l->count < ENOUGH)) {
		l->pieces = 1;
		ok = restore(l, c, before);
		l->count = count;
	}
	if (before)
		shape_free(before->plain);
	free(before);
	return ok;
}

/* Errors of the form that was learned, from stretches that it was not learned from. */
static int conclude(struct learning *l, struct calibration *c)
{
	double level, error2, se;

	judge_stretches(l, -1, &level, &error2, &se);
	if (!validate(l, c))
		return 0;
	c->chi2 = median_chi2(l);
	return 1;
}

enum calibrate_status learn_pulse(const struct calibrate_par *par, double *const y[2],
	unsigned char *const bad[2], size_t n, int again, struct learning *l,
	struct calibration *c)
{
	struct shape *first =
		again ? shape_filter(c->plain, 256, NULL, 0, 0) : shape_new(PULSE_SINE);
	double duration = c->duration;
	int ok = first != NULL, lone = 0;

	c->attempts++;
	l->limit = joint_operations(l->joint) + WORK * ((double)n + AT_LEAST);
	l->failed = 0;
	if (!again)
		c->through = l->crowded = l->pieces = 0;
	l->scene.negative = l->pieces ? INFINITY : 0;
	ok = ok && use_shape(l, c, first);
	c->error = INFINITY;
	if (ok && !l->crowded)
		lone = learn_lone(par, l, y, bad, n, again, c, &ok);
	if (ok && (lone || l->crowded)) {
		use_scene(l, c, l->crowded ? LEARN_PULSES : 1);
		l->crowded |= l->count < MANY;
		if (l->crowded && l->pieces)
			ok = converge(par, l, y, bad, n, c);
		else if (l->crowded)
			ok = learn_more(par, l, y, bad, n, c, 0);
		ok = ok && conclude(l, c);
	}
	if (ok && !again &&
		!(c->error < CALIBRATE_ERROR && (l->crowded || c->chi2 < FITS))) {
		/* Perhaps none of them stands alone, or close pairs are taken for one. */
		struct state *before = calloc(1, sizeof *before);
		double error = c->error;
		int events = l->count;

		ok = before && save(l, c, 0, before);
		c->duration = duration;
		c->through = 0;
		l->scene.negative = INFINITY;
		use_scene(l, c, LEARN_PULSES);
		ok = ok && learn_crowd(par, l, y, bad, n, c);
		if (ok && l->count)
			ok = learn_rough(par, l, y, bad, n, c) && conclude(l, c);
		l->crowded = 1;
		if ((ok || l->failed) && !(c->error < error) && events) {
			ok = restore(l, c, before);
			l->count = events;
			c->error = error;
			l->crowded = l->failed = 0;
		}
		if (before)
			shape_free(before->plain);
		free(before);
	}
	if (!ok && l->failed)
		return CALIBRATE_HOPELESS;
	if (ok && l->count == 0) {
		struct shape *sine = shape_new(
			par->pulse == CALIBRATE_ANY_PULSE ? PULSE_SINE : par->pulse);

		ok = use_shape(l, c, sine);
		c->error = c->error_least = c->error_floor = 0;
		c->level = 1;
		c->duration = duration;
	}
	if (!ok)
		return CALIBRATE_MEMORY;
	c->dense = l->pieces;
	learn_sign(l, c);
	learn_range(par, l, c);
	return CALIBRATE_OK;
}
