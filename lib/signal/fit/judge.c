/* judge.c - see judge.h */
#include "signal/fit/judge.h"
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

/* More than noise leaves by this many standard deviations, and by a tenth? */
static int too_much(double chi2, double dof, double deviations)
{
	return chi2 / dof > 1.1 + deviations * sqrt(2 / dof);
}

/* Is the residual under pulse i more than noise?  Among those of a stretch of which that
 * is known: three deviations. */
static int is_misfit(const struct joint *joint, const struct joint_scene *s, size_t n,
	const struct joint_pulse *pulses, int m, int i)
{
	double half = shape_reach_above(s->shape, 0.02) * s->duration;
	double from = fmax(pulses[i].t - half, 0),
	       to = fmin(pulses[i].t + half, (double)n);
	double dof = (1 - s->lost) * 2 * (to - from);

	for (int k = 0; k < m; k++)
		dof -= 3 * fmax(1 - fabs(pulses[k].t - pulses[i].t) / (2 * half), 0);
	return too_much(residual_square(joint, from, to, pulses[i].delta, (double)n),
		fmax(dof, 1), 3);
}

void judge(const struct joint *joint, const struct joint_scene *s, size_t n,
	const struct joint_pulse *pulses, int m, int done, double boundary,
	int model_holds, const struct joint_result *r, struct judgement *out)
{
	double chi2 = r->chi2, dof = (double)r->dof;
	int doubted = 0;

	if (boundary < (double)n) {
		chi2 = residual_square(joint, 0, boundary, 0, (double)n);
		dof = fmax((1 - s->lost) * 2 * boundary - 3 * done, 1);
	}
	out->chi2 = chi2 / dof;
	out->stretch = m > 1 ? SEPARATE_OVERLAP : SEPARATE_ALONE;
	for (int i = 0; i < done; i++)
		out->pulse[i] = out->stretch;
	if (too_much(chi2, dof, 5)) {
		for (int i = 0; i < done; i++)
			if (!model_holds || m == 1 ||
				is_misfit(joint, s, n, pulses, m, i)) {
				out->pulse[i] = SEPARATE_MISFIT;
				doubted++;
			}
		out->stretch = SEPARATE_MISFIT;
		if (model_holds && m >= 4 && 2 * doubted > done)
			out->stretch = SEPARATE_UNRESOLVED;
	}
	if (r->full)
		out->stretch = SEPARATE_UNRESOLVED;
}
