/* joint.h - joint fit of all pulses of a section of a two-sensor record
 *
 * The record, in samples of white noise of variance 1 on both channels, is
 *
 *	y1(n) = sum_i a_i p((n - t_i) / T_i) + tones + noise
 *	y2(n) = sum_i g a_i p((n - t_i - delta_i) / T_i) + tones + noise
 *
 * where T_i = duration (1 + delta_i / transit), width times as much in y2: a slow
 * particle has a long pulse, and one coil may be wider than the other.  Pulses are found
 * one by one where the matched filter of the residual is largest, each followed by a
 * Levenberg-Marquardt fit of it and its neighbours with exact derivatives (orthogonal
 * matching pursuit with Newton steps: Mamandipoor, Ramasamy, Madhow, IEEE Trans. Signal
 * Process. 64, 2016), until no further pulse reduces chi-square enough; then all are
 * fitted together.  Tones and offset are linear and are projected out exactly, as far as
 * they are not known beforehand.
 *
 * The solver uses only samples that pulses touch, and its steps stay within the range of
 * delta.  To the same chi-square gsl_multifit_nlinear, which needs the whole Jacobian,
 * takes 4 to 60 times as long, and gsl_multilarge_nlinear with a normal matrix made like
 * ours 1.1 to 1.7 times (tests/bench/solvers.c).
 */
#ifndef SIGNAL_JOINT_H
#define SIGNAL_JOINT_H

#include "signal/pulse/shape.h"
#include <math.h>
#include <stddef.h>

/* What a pulse may have of its own: the logarithm of its width from that of its velocity,
 * and that of its ratio of amplitudes at the sensors from the gain. */
enum { JOINT_WIDTH, JOINT_RATIO, JOINT_OWN };

enum { JOINT_TONES_MAX = 32, JOINT_BASELINE_MAX = 32, JOINT_PULSES_MAX = 64 };

/* Share of its range by which a delay may exceed it during a fit, and largest change of
 * an arrival in one step, in durations. */
#define JOINT_BEYOND 0.1
#define JOINT_STEP 0.25

struct joint_scene {
	const struct shape *shape;
	double duration; /* T of a particle with delta = 0 */
	double transit;  /* from sensor to sensor at delta = 0; INFINITY: one T */
	double gain;     /* g > 0 */
	double width;    /* of the pulses of sensor 2, over those of sensor 1 */
	double delta_min, delta_max; /* range of delta */
	double threshold;            /* by how much a pulse must reduce chi-square ... */
	double threshold_near; /* ... where it overlaps others: the search is narrower */
	double misfit;         /* and by this share of the energy it overlaps */
	double scatter[JOINT_OWN]; /* standard deviations of what pulses have of their
				      own; 0: none, or not known */
	int signs;                 /* 1: amplitudes may be negative too */
	/* Samples at either end in which no pulse arrives; 0: the record goes on there,
	 * and pulses may arrive beyond. */
	double quiet[2];
	int max_pulses; /* at most JOINT_PULSES_MAX */
	int give_up;    /* 1: if there are more, the fit need not be the best */
	/* 1: the search ends where the pulses that are still allowed cannot describe what
	 * is left.  To compare shapes, it must not: chi-square depends on where it ends.
	 */
	int hopeless;
	int tones;
	double omega[JOINT_TONES_MAX]; /* rad per sample */
	/* Prior variance of the cosine and sine of each tone about zero (small after
	 * tones were removed from the record); INFINITY: unknown, and constant.  Known
	 * ones are independent at knots tone_hop samples apart, with linear
	 * interpolation between; 0: constant.  tone_knot: one of the knots of either
	 * channel. */
	double tone_variance, tone_hop, tone_knot[2];
	/* Of a filtered record (whiten.h): frequencies below low, in cycles per sample,
	 * are a baseline to be projected out (up to JOINT_BASELINE_MAX in the length of
	 * the record); lost: share of the variance of the noise that the filter removed.
	 */
	double low, lost;
	/* Samples that are not known, 1 in these n flags of either channel; NULL: none.
	 */
	const unsigned char *hidden[2];
};

/* Duration of the pulse of a particle with this delta on channel c. */
static inline double joint_duration(const struct joint_scene *s, double delta, int c)
{
	return s->duration * (1 + delta / s->transit) * (c ? s->width : 1);
}

/* Energy of a pulse of amplitude 1 on both channels, in units of the noise. */
static inline double joint_energy(const struct joint_scene *s)
{
	return s->duration * shape_energy(s->shape) * (1 + s->gain * s->gain * s->width);
}

/* The same at the sensor that shows it less. */
static inline double joint_energy_least(const struct joint_scene *s)
{
	return s->duration * shape_energy(s->shape) *
	       fmin(1, s->gain * s->gain * s->width);
}

struct joint_pulse {
	double t, delta, a;
	double own[JOINT_OWN]; /* of the last fit, where these scatter; else 0 */
	/* Inverse Fisher matrix of (t, t + delta, a), lower triangle by rows. */
	double cov[6];
	/* By joint_fit(), if this pulse and another one exchange their arrivals at sensor
	 * 2: its delay then, by how much the squares of both delays exceed those of this
	 * fit, and the likelihood ratio of that fit and this one (0: not possible). */
	double other_delta, more_square, exchange;
	int partner;               /* the other one, while pulses are looked for ... */
	double kept_t, kept_delta; /* ... and where this one was then */
};

/* Duration and amplitude of this pulse on channel c. */
static inline double joint_pulse_duration(
	const struct joint_scene *s, const struct joint_pulse *p, int c)
{
	return joint_duration(s, p->delta, c) * exp(p->own[JOINT_WIDTH]);
}
static inline double joint_pulse_height(
	const struct joint_scene *s, const struct joint_pulse *p, int c)
{
	return p->a * (c ? s->gain * exp(p->own[JOINT_RATIO]) : 1);
}

static inline double joint_delay_variance(const struct joint_pulse *p)
{
	return p->cov[0] - 2 * p->cov[1] + p->cov[2];
}

struct joint_result {
	double chi2;
	long dof; /* samples less parameters, at least 1 */
	int full; /* 1: there were more than max_pulses */
	/* 1: signs was 0, and a negative pulse would at some time have reduced chi-square
	 * by threshold_near, and more than any positive one. */
	int negative;
	long steps;    /* Levenberg-Marquardt steps tried */
	long searches; /* matched-filter searches */
};

enum joint_status { JOINT_OK, JOINT_MEMORY, JOINT_DOMAIN };

struct joint;
struct joint *joint_new(void);
void joint_free(struct joint *joint);

/* Finds pulses; the *m already in pulses (0 to max_pulses) are kept as first guesses.
 * On return they are sorted by t, with cov.  JOINT_DOMAIN if a parameter of the scene is
 * out of range. */
enum joint_status joint_fit(struct joint *joint, const struct joint_scene *scene,
	const double *y1, const double *y2, size_t n, struct joint_pulse *pulses, int *m,
	struct joint_result *result);

/* The same without looking for more pulses. */
enum joint_status joint_refine(struct joint *joint, const struct joint_scene *scene,
	const double *y1, const double *y2, size_t n, struct joint_pulse *pulses, int m,
	struct joint_result *result);
/* The same without the errors of the pulses and the residual. */
enum joint_status joint_adjust(struct joint *joint, const struct joint_scene *scene,
	const double *y1, const double *y2, size_t n, struct joint_pulse *pulses, int m,
	double *chi2);

/* How half of chi-square falls with the logarithms of duration and gain of the scene,
 * with the pulses fitted again: its gradient, and its curvature, [k][l] with l <= k. */
enum { JOINT_DURATION, JOINT_GAIN, JOINT_SLOPES };
struct joint_slopes {
	double gradient[JOINT_SLOPES], curvature[JOINT_SLOPES][JOINT_SLOPES];
};
/* Adds those of the last fit; 0 if its normal matrix is singular: nothing was added. */
int joint_add_slopes(struct joint *joint, struct joint_slopes *sum);

/* Is pulse i of the last fit two that arrive nearly together?  Odds by the share of the
 * smaller one, for one other arrival per duration; scatter is the standard deviation of
 * the difference of two delays.  All 0 if the normal matrix is singular.  Shares are the
 * middles of steps from a quarter, which puts the diameter out by a tenth, to a half. */
enum { JOINT_SHARES = 3 };
static const double JOINT_SHARE_STEP = 0.25 / JOINT_SHARES;
static inline double joint_share(int k)
{
	return 0.25 + (k + 0.5) * JOINT_SHARE_STEP;
}
void joint_pair_odds(
	struct joint *joint, int i, double scatter, double odds[JOINT_SHARES]);

/* Samples of pulses computed by all fits so far. */
double joint_work(const struct joint *joint);

/* Of the pulses of the last fit: by which share their sum at sensor 2 exceeds gain times
 * that at sensor 1, and the standard error of this, with the scatter of their ratios. The
 * fit of pulses that overlap takes up a part of the share, which is too small then. */
void joint_gain_error(const struct joint *joint, double *share, double *se);

/* One deviation of a pulse, whatever its prior, and the standard error of this; at: its
 * arrival; left: the share of its energy that a pulse with share leaves, over share^2. */
struct joint_deviation {
	double at, share, se, left;
};
/* Those of the pulses of the last fit: out[own] has room for them where the set has the
 * bit 1 << own; explained: by how much they reduce its chi-square.  Returns the number of
 * pulses; 0: they are not known. */
size_t joint_deviations(struct joint *joint, unsigned set,
	struct joint_deviation *const *out, double *explained);

/* Standard deviation of what n pulses have of their own from a straight line in time,
 * beside that of its errors, of maximum likelihood; 0 unless twice the logarithm of the
 * ratio of its likelihood to that of none exceeds certain, or if three of it are more
 * than a factor of two.  n: at most JOINT_SCATTER_MAX. */
enum { JOINT_SCATTER_MAX = 256 };
double joint_scatter(int own, const struct joint_deviation *of, size_t n, double certain);

/* Sets scatter[own] to this of n pulses, and misfit to at least what three standard
 * deviations of it leave of a pulse. */
void joint_set_scatter(struct joint_scene *scene, int own, double scatter,
	const struct joint_deviation *of, size_t n, double misfit);

/* Residual of the last fit, channel 0 or 1, n samples, tones and offset removed. */
const double *joint_residual(const struct joint *joint, int channel);

/* Adds sign times one pulse to y1[0..n) and y2[0..n) (either may be NULL). */
void joint_add(const struct joint_scene *scene, const struct joint_pulse *pulse,
	double sign, double *y1, double *y2, size_t n);

#endif
