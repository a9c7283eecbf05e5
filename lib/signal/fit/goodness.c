/* goodness.c - see goodness.h */
#include "signal/fit/goodness.h"
#include "num/sigmas.h"
#include "signal/fit/joint_state.h"

/* Chi-square of samples [from, to) of both channels, the second delta later; *count: how
 * many of them are known. */
static double residual_square(
	const struct joint *j, double from, double to, double delta, double *count)
{
	double sum = 0;

	*count = 0;
	for (int c = 0; c < 2; c++) {
		double a = fmax(from + (c ? delta : 0), 0);
		double b = fmin(to + (c ? delta : 0), (double)j->n);

		for (long i = (long)a; i < (long)b; i++)
			sum += j->r[c][i] * j->r[c][i];
		if (b > a)
			*count += (double)joint_visible(j, c, (size_t)a, (size_t)b);
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
static int is_misfit(const struct joint *j, int i)
{
	const struct joint_scene *s = &j->scene;
	double half = shape_reach_above(s->shape, 0.02) * s->duration;
	double t = j->pulse[i].t, count, dof;
	double sum = residual_square(j, fmax(t - half, 0), fmin(t + half, (double)j->n),
		j->pulse[i].delta, &count);

	dof = (1 - s->lost) * count;
	for (int k = 0; k < j->m; k++)
		dof -= PAR * fmax(1 - fabs(j->pulse[k].t - t) / (2 * half), 0);
	return too_much(sum, fmax(dof, 1), SIGMAS_SELDOM);
}

/* Pulses fitted to an event that is not a particle overlap by more than half.  In a whole
 * section with quiet on either side, pulses that so overlap a doubted one, or the next
 * one, are doubted as well. */
static void spread(const struct joint *j, int m, enum separate_verdict *verdict)
{
	for (int k = 0; k < 2 * m; k++) {
		int i = k < m ? k : 2 * m - 1 - k, next = k < m ? i + 1 : i - 1;

		if (next >= 0 && next < m && verdict[i] == SEPARATE_MISFIT &&
			fabs(j->pulse[next].t - j->pulse[i].t) < 0.5 * j->scene.duration)
			verdict[next] = SEPARATE_MISFIT;
	}
}

/* Doubts the pulses from i on, and returns 1, if they sample a smooth waveform, such as
 * the lobe of a bubble: eight of one sign at nearly equal distances.  The ratio of two
 * distances of a Poisson process is within 20 % with the probability tanh(0.1), and six
 * in succession are with 1e-6.  Such pulses were 0.25 to 0.35 durations apart in two
 * records, and are 0.43 in a regular train of 300 particles a second at 12.7 m/s. */
static int mark_comb(
	const struct joint *j, int i, int done, enum separate_verdict *verdict)
{
	enum { TEETH = 8 };
	const struct joint_pulse *p = j->pulse + i;
	const double most = 0.4 * j->scene.duration, alike = 0.2;

	if (i + TEETH > done)
		return 0;
	for (int k = 1; k < TEETH; k++) {
		double step = p[k].t - p[k - 1].t;

		if (step > most || (p[k].a > 0) != (p[0].a > 0))
			return 0;
		if (k > 1 && fabs(log(step / (p[k - 1].t - p[k - 2].t))) > alike)
			return 0;
	}
	for (int k = 0; k < TEETH; k++)
		verdict[i + k] = SEPARATE_MISFIT;
	return 1;
}

void goodness_of_fit(const struct joint *j, int done, double boundary, int model_holds,
	struct goodness *out)
{
	const struct joint_scene *s = &j->scene;
	double chi2 = j->result.chi2, dof = (double)j->result.dof;
	int doubted = 0;

	if (boundary < (double)j->n) {
		chi2 = residual_square(j, 0, boundary, 0, &dof);
		dof = fmax((1 - s->lost) * dof - PAR * done, 1);
	}
	out->chi2 = chi2 / dof;
	out->stretch = j->m > 1 ? SEPARATE_OVERLAP : SEPARATE_ALONE;
	/* A pulse too small to be found alone is doubted: beside others, where the error
	 * of their shape can make such a pulse, the threshold is lower. */
	for (int i = 0; i < done; i++) {
		double energy = j->pulse[i].a * j->pulse[i].a * joint_energy(s);

		out->pulse[i] = energy < s->threshold ? SEPARATE_MISFIT : out->stretch;
	}
	if (too_much(chi2, dof, SIGMAS_NEVER)) {
		for (int i = 0; i < done; i++)
			if (!model_holds || j->m == 1 || is_misfit(j, i))
				out->pulse[i] = SEPARATE_MISFIT;
		if (s->quiet[0] > 0 && s->quiet[1] > 0)
			spread(j, done, out->pulse);
		for (int i = 0; i < done; i++)
			doubted += out->pulse[i] == SEPARATE_MISFIT;
		out->stretch = SEPARATE_MISFIT;
		if (model_holds && j->m >= 4 && 2 * doubted > done)
			out->stretch = SEPARATE_UNRESOLVED;
	}
	for (int i = 0; i < done; i++)
		if (mark_comb(j, i, done, out->pulse) && out->stretch < SEPARATE_MISFIT)
			out->stretch = SEPARATE_MISFIT;
	if (j->result.full)
		out->stretch = SEPARATE_UNRESOLVED;
}
