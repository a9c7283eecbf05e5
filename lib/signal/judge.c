/* judge.c - see judge.h */
#include "signal/judge.h"
#include <math.h>

/* Chi-square of samples [from, to) of both channels, the second delta later. */
static double residual_square(
	const struct joint *joint, double from, double to, double delta, double limit)
{
	double sum = 0;

	for (int c = 0; c < 2; c++) {
		const double *r = joint_residual(joint, c);
		double a = fmax(from + (c ? delta : 0), 0);
		double b = fmin(to + (c ? delta : 0), limit);

		for (long i = (long)a; i < (long)b; i++)
			sum += r[i] * r[i];
	}
	return sum;
}

/* What is known of the noise's power. */
static const double LEVEL = 0.05;

/* Energy of pulse i on both channels, in units of chi-square. */
static double energy(const struct joint_scene *s, const struct joint_pulse *p)
{
	return p->a * p->a * s->duration * (1 + p->delta / s->transit) *
	       (shape_energy(s->shape[0]) +
		       s->gain * s->gain * shape_energy(s->shape[1]));
}

/* More than noise leaves by this many standard deviations, and than what the form of the
 * pulses may be out by? */
static int too_much(
	double error, double chi2, double dof, double power, double deviations)
{
	return chi2 >
	       dof * (1 + LEVEL) + deviations * sqrt(2 * dof) + 4 * error * error * power;
}

/* Do the channels agree on the amplitude, within four deviations or 8 %, and does either
 * see it? */
static int channels_agree(
	struct joint *joint, const struct joint_scene *s, const struct joint_pulse *p)
{
	double se[2], a[2];

	for (int c = 0; c < 2; c++) {
		a[c] = joint_amplitude(joint, s, p, c, &se[c]);
		if (!(fabs(a[c]) > 3 * se[c]) || a[c] * p->a < 0)
			return 0;
	}
	return fabs(a[0] - a[1]) <= fmax(4 * hypot(se[0], se[1]), 0.08 * fabs(p->a));
}

/* Chi-square of one common delay of all pulses: what is one object has one velocity. */
static double common_delay(const struct joint_pulse *p, int m)
{
	double w = 0, wx = 0, sum = 0;

	for (int i = 0; i < m; i++) {
		double var = p[i].cov[0] - 2 * p[i].cov[1] + p[i].cov[2];

		w += 1 / var;
		wx += p[i].delta / var;
	}
	for (int i = 0; i < m; i++)
		sum += (p[i].delta - wx / w) * (p[i].delta - wx / w) /
		       (p[i].cov[0] - 2 * p[i].cov[1] + p[i].cov[2]);
	return sum;
}

/* Probability that chi-square of k degrees of freedom is below x: the series of the
 * incomplete gamma function. */
static double chi_square_below(double x, int k)
{
	double a = 0.5 * k, term = 1 / a, sum = 0;

	x /= 2;
	for (int i = 1; i < 500 && term > 1e-12 * sum; i++) {
		sum += term;
		term *= x / (a + i);
	}
	return fmin(sum * exp(-x + a * log(x) - lgamma(a)), 1);
}

double judge_velocities(const struct joint_pulse *p, int m, double spread2, int *told)
{
	double need = 10 + 2 * (m - 2), var = 0;

	for (int i = 0; i < m; i++)
		var += (p[i].cov[0] - 2 * p[i].cov[1] + p[i].cov[2]) / m;
	*told = common_delay(p, m) >= need;
	return chi_square_below(need / (1 + spread2 / var), m - 1);
}

/* Is the residual under pulse i more than noise?  Among those of a stretch of which that
 * is known: three deviations. */
static int is_misfit(struct joint *joint, const struct joint_scene *s, size_t n,
	const struct joint_pulse *pulses, int m, int i, double error)
{
	double half = shape_reach_above(s->shape[0], 0.02) * s->duration;
	double from = fmax(pulses[i].t - half, 0),
	       to = fmin(pulses[i].t + half, (double)n);
	double dof = (1 - s->lost) * 2 * (to - from), power = 0;

	for (int k = 0; k < m; k++) {
		double near = fmax(1 - fabs(pulses[k].t - pulses[i].t) / (2 * half), 0);

		dof -= 3 * near;
		power += near * energy(s, &pulses[k]);
	}
	return too_much(error,
		residual_square(joint, from, to, pulses[i].delta, (double)n),
		fmax(dof, 1), power, 3);
}

void judge(struct joint *joint, const struct joint_scene *s, size_t n,
	const struct joint_pulse *pulses, int m, int done, double boundary, double error,
	const struct joint_result *r, struct judgement *out)
{
	double chi2 = r->chi2, dof = (double)r->dof, power = 0;
	int doubted = 0, bad;

	if (boundary < (double)n) {
		chi2 = residual_square(joint, 0, boundary, 0, (double)n);
		dof = fmax((1 - s->lost) * 2 * boundary - 3 * done, 1);
	}
	for (int i = 0; i < done; i++)
		power += energy(s, &pulses[i]);
	out->chi2 = chi2 / dof;
	out->stretch = m > 1 ? SEPARATE_OVERLAP : SEPARATE_ALONE;
	bad = too_much(error, chi2, dof, power, 5);
	for (int i = 0; i < done; i++) {
		int doubt =
			bad && (m == 1 || is_misfit(joint, s, n, pulses, m, i, error));

		doubt |= !channels_agree(joint, s, &pulses[i]);
		out->pulse[i] = doubt             ? SEPARATE_MISFIT
				: pulses[i].a < 0 ? SEPARATE_NONFERROUS
						  : out->stretch;
		doubted += doubt;
	}
	if (bad)
		out->stretch = SEPARATE_MISFIT;
	if ((bad && m >= 4 && 2 * doubted > done) || r->full)
		out->stretch = SEPARATE_UNRESOLVED;
}
