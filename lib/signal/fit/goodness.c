/* goodness.c - see goodness.h */
#include "signal/fit/goodness.h"
#include "num/sigmas.h"
#include <math.h>

/* Chi-square of samples [from, to) of both channels, the second delta later; *count: how
 * many of them are known. */
static double residual_square(const struct joint *joint, double from, double to,
	double delta, double limit, double *count)
{
	double sum = 0;

	*count = 0;
	for (int c = 0; c < 2; c++) {
		const double *r = joint_residual(joint, c);
		double a = fmax(from + (c ? delta : 0), 0);
		double b = fmin(to + (c ? delta : 0), limit);

		for (long i = (long)a; i < (long)b; i++)
			sum += r[i] * r[i];
		if (b > a)
			*count += (double)joint_visible(joint, c, (size_t)a, (size_t)b);
	}
	return sum;
}

/* 1 if chi-square exceeds that of noise by more than so many standard deviations. */
static int too_much(double chi2, double dof, double deviations)
{
	return chi2 / dof > 1 + CHI_SQUARE_MORE + deviations * sqrt(2 / dof);
}

/* 1 if the residual under pulse i exceeds the noise by three deviations; used where that
 * of the whole stretch does. */
static int is_misfit(const struct joint *joint, const struct joint_scene *s, size_t n,
	const struct joint_pulse *pulses, int m, int i)
{
	double half = shape_reach_above(s->shape, 0.02) * s->duration;
	double from = fmax(pulses[i].t - half, 0),
	       to = fmin(pulses[i].t + half, (double)n);
	double count, dof;
	double sum = residual_square(joint, from, to, pulses[i].delta, (double)n, &count);

	dof = (1 - s->lost) * count;
	for (int k = 0; k < m; k++)
		dof -= 3 * fmax(1 - fabs(pulses[k].t - pulses[i].t) / (2 * half), 0);
	return too_much(sum, fmax(dof, 1), SIGMAS_SELDOM);
}

/* 1 if a pulse is too small to be found alone.  The threshold is lower beside others,
 * where the error of their shape can make such a pulse. */
static int is_faint(const struct joint_scene *s, const struct joint_pulse *p)
{
	return p->a * p->a * joint_energy(s) < s->threshold;
}

/* Pulses fitted to an event that is not a particle overlap by more than half.  In a whole
 * section with quiet on either side, pulses that so overlap a doubted one, or the next
 * one, are doubted as well. */
static void spread(const struct joint_scene *s, const struct joint_pulse *pulses, int m,
	enum separate_verdict *verdict)
{
	for (int k = 0; k < 2 * m; k++) {
		int i = k < m ? k : 2 * m - 1 - k, next = k < m ? i + 1 : i - 1;

		if (next >= 0 && next < m && verdict[i] == SEPARATE_MISFIT &&
			fabs(pulses[next].t - pulses[i].t) < 0.5 * s->duration)
			verdict[next] = SEPARATE_MISFIT;
	}
}

void goodness_of_fit(const struct joint *joint, const struct joint_scene *s, size_t n,
	const struct joint_pulse *pulses, int m, int done, double boundary,
	int model_holds, const struct joint_result *r, struct goodness *out)
{
	double chi2 = r->chi2, dof = (double)r->dof;
	int doubted = 0;

	if (boundary < (double)n) {
		chi2 = residual_square(joint, 0, boundary, 0, (double)n, &dof);
		dof = fmax((1 - s->lost) * dof - 3 * done, 1);
	}
	out->chi2 = chi2 / dof;
	out->stretch = m > 1 ? SEPARATE_OVERLAP : SEPARATE_ALONE;
	for (int i = 0; i < done; i++)
		out->pulse[i] = is_faint(s, &pulses[i]) ? SEPARATE_MISFIT : out->stretch;
	if (too_much(chi2, dof, SIGMAS_NEVER)) {
		for (int i = 0; i < done; i++)
			if (!model_holds || m == 1 ||
				is_misfit(joint, s, n, pulses, m, i))
				out->pulse[i] = SEPARATE_MISFIT;
		if (s->quiet[0] > 0 && s->quiet[1] > 0)
			spread(s, pulses, done, out->pulse);
		for (int i = 0; i < done; i++)
			doubted += out->pulse[i] == SEPARATE_MISFIT;
		out->stretch = SEPARATE_MISFIT;
		if (model_holds && m >= 4 && 2 * doubted > done)
			out->stretch = SEPARATE_UNRESOLVED;
	}
	if (r->full)
		out->stretch = SEPARATE_UNRESOLVED;
}
