/* following.c - flow, gain and what pulses have of their own, followed by them */
#include "num/sigmas.h"
#include "signal/separate/separate_state.h"
#include <math.h>

/* Largest amount by which a delay may fall short of the transit time, as a share of it:
 * no particle of laminar flow is faster than twice the mean.  In eight laminar records
 * 0.3, 0.5 and 0.7 find 188, 189 and 139 of 400 particles.  Of a wide range that was
 * learned, it is the least delay. */
static const double LEAST = 0.5;

int separate_is_range_free(const struct separate *s)
{
	return isnan(s->par.known.spread) && !isinf(s->cal.transit);
}

void separate_widen(struct separate *s)
{
	double middle = 0.5 * (s->scene.delta_min + s->scene.delta_max);
	double half = calibration_reach(
		CALIBRATE_WIDE, s->cal.transit + middle, s->cal.duration);

	s->scene.delta_min =
		fmin(s->scene.delta_min, fmax(middle - half, -LEAST * s->cal.transit));
	s->scene.delta_max = fmax(s->scene.delta_max, middle + half);
}

/* The range of the last delays, widened by half of it on either side, as in learning.
 * That of laminar flow is no narrower than it was learned: its velocities are not normal,
 * and a particle that is slower than the range is fitted by many. */
static void follow_delay(struct separate *s, double delay)
{
	size_t n;
	double lo = INFINITY, hi = -INFINITY;
	double wide = calibration_reach(CALIBRATE_WIDE, s->cal.transit, s->cal.duration);

	s->delay[s->delays++ % TRACKED] = delay;
	n = s->delays < TRACKED ? s->delays : TRACKED;
	for (size_t i = 0; i < n; i++) {
		lo = fmin(lo, s->delay[i]);
		hi = fmax(hi, s->delay[i]);
	}
	calibration_widen(s->cal.duration, &lo, &hi);
	if (s->cal.delta_max - s->cal.delta_min > 2 * wide) {
		lo = fmin(s->cal.delta_min, lo);
		hi = fmax(s->cal.delta_max, hi);
	}
	if (n < ENOUGH) { /* the present range was learned from other pulses */
		lo = fmin(s->scene.delta_min, lo);
		hi = fmax(s->scene.delta_max, hi);
	}
	s->scene.delta_min = fmax(lo, fmin(-LEAST * s->cal.transit, s->cal.delta_min));
	s->scene.delta_max =
		fmin(hi, calibration_most(s->cal.transit, s->scene.delta_min));
	validation_range(
		s->validation, s->cal.transit, s->scene.delta_min, s->scene.delta_max);
}

double separate_gain_at(const struct separate *s, double at)
{
	return s->gain * exp(s->drift * (fmin(at, s->drifts_to) - s->gain_at));
}

/* The gain is kept, or goes on drifting, until the mean of the last GAINS windows differs
 * from it by three standard errors; then it is set to their mean, and has drifted since
 * it was set last.  In 24 records of 40 to 300 particles whose gain drifts by 10 to 50 %,
 * 3676, 3682 and 3683 of 3734 are found rightly if none, half and all of the deviation is
 * put down to the drift. */
static void follow_gain(struct separate *s, double time)
{
	double share, se, at, off;

	joint_gain_error(s->joint, &share, &se);
	if (!(se > 0) || isinf(se))
		return;
	s->gain_off += share / se;
	s->gain_sum += share / (se * se);
	s->gain_weight += 1 / (se * se);
	s->gain_time += time / GAINS;
	if (++s->gains % GAINS)
		return;
	at = s->gain_time;
	off = s->gain_sum / s->gain_weight;
	if (fabs(s->gain_off) > SIGMAS_SELDOM * sqrt(GAINS) && off > -1) {
		s->gain = separate_gain_at(s, at) * (1 + off);
		if (at > s->gain_at)
			s->drift += log(1 + off) / (at - s->gain_at);
		s->gain_at = at;
	}
	s->drifts_to = fmax(2 * at - s->learned_at, s->drifts_to);
	s->gain_off = s->gain_sum = s->gain_weight = s->gain_time = 0;
}

void separate_set_gain(struct separate *s, long long from)
{
	const double at[2] = { (double)from, (double)(from + s->cal.shift) };

	s->scene.gain = separate_gain_at(s, at[0]) *
			following_at(&s->buffer[0].noise, at[0]) /
			following_at(&s->buffer[1].noise, at[1]);
	for (int c = 0; c < 2 && has_quadrature(s); c++)
		s->quadrature.noise[c] = separate_noise_at(s, c + 2, at[c]) /
					 separate_noise_at(s, c, at[c]);
}

/* The scatter of what the last pulses that stand alone have of their own, whenever there
 * are ENOUGH others.  One that was found is kept until these show another: fewer of them
 * may not be significant. */
static void follow_scatter(struct separate *s, const struct account *a)
{
	double misfit = s->cal.misfit;

	for (int own = 0; own < JOINT_OWN; own++) {
		struct joint_deviation *out[JOINT_OWN], *kept = s->own[own];
		struct joint_deviation *last = out[own] = &kept[s->owns[own] % TRACKED];
		double explained, scatter;
		size_t n;

		if (joint_deviations(s->joint, 1U << own, out, &explained) != 1)
			continue;
		last->at = (double)a->from + a->pulse[0].t;
		/* The ratio itself, whatever the gain followed meanwhile. */
		if (own == JOINT_RATIO)
			last->share += log(separate_gain_at(s, last->at));
		if (++s->owns[own] % ENOUGH != 0)
			continue;
		n = s->owns[own] < TRACKED ? s->owns[own] : TRACKED;
		scatter = joint_scatter(own, kept, n, SIGMAS_NEVER * SIGMAS_NEVER);
		if (!(scatter > 0))
			continue;
		joint_set_scatter(&s->scene, own, scatter, kept, n, misfit);
		misfit = s->scene.misfit;
	}
}

/* Share of the false alarms that noise may take for a pulse to follow: by following those
 * themselves, whose delays are anywhere in the range, it would grow without limit. */
static const double FOLLOWED = 1e-3;

static int is_clear(const struct separate *s, const struct joint_pulse *p)
{
	return p->a * p->a > (s->scene.threshold - 2 * log(FOLLOWED)) * p->cov[5];
}

void separate_follow(struct separate *s, const struct account *a)
{
	if (a->m == 1 && a->goodness.stretch == SEPARATE_ALONE &&
		is_clear(s, &a->pulse[0])) {
		if (separate_is_range_free(s))
			follow_delay(s, a->pulse[0].delta);
		follow_scatter(s, a);
	}
	if (a->m > 0 && isnan(s->par.known.gain))
		follow_gain(s, (double)a->from + a->pulse[0].t);
}
