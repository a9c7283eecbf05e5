/* correct.c - see examples.h */
#include "num/dot.h"
#include "signal/learn/examples.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Means of x[0..n) under a Hann window of 2 reach + 1 points, work holding n. */
static void smooth(double *x, double *work, int n, int reach)
{
	memcpy(work, x, (size_t)n * sizeof *x);
	for (int i = 0; i < n; i++) {
		x[i] = 0;
		for (int k = -reach; k <= reach; k++)
			if (i + k >= 0 && i + k < n)
				x[i] += work[i + k] * (1 + cos(M_PI * k / (reach + 1))) /
					(2 * reach + 2);
	}
}

/* Half width of the window that smooths a mean residual: a tenth of a duration for pulses
 * that barely exceed the noise, and less for clearer ones, since smoothing blurs the
 * edges of the shape. */
static int smoothing_reach(const struct examples *ex)
{
	double faint = 1e5;

	return (int)(0.1 * ex->scene.duration * fmin(pow(ex->energy / faint, -0.25), 1));
}

/* Mean residual around the pulses of the examples, sample by sample of the pulse: what
 * they have in common and the shape lacks. */
static void mean_residual(struct examples *ex, double *more, double *weight, int half)
{
	double most;

	memset(more, 0, (2 * (size_t)half + 1) * sizeof *more);
	memset(weight, 0, (2 * (size_t)half + 1) * sizeof *weight);
	for (int i = 0; i < ex->count; i++) {
		struct example *e = &ex->example[i];
		struct joint_result result;

		if (examples_refine(ex, e, e->pulse, &result) != JOINT_OK)
			continue;
		for (int p = 0; p < 2 * e->m; p++)
			examples_add_residual(ex, e, p, p % 2 ? ex->scene.width : 1, half,
				more, weight);
	}
	/* Far from the pulse few examples contribute. */
	most = largest_of(weight, 2 * (size_t)half + 1);
	for (int k = 0; k <= 2 * half; k++)
		more[k] *= weight[k] > 0 ? fmin(fmax(2 * weight[k] / most - 0.5, 0), 1) /
						   weight[k]
					 : 0;
	smooth(more, weight, 2 * half + 1, smoothing_reach(ex));
}

/* Least reduction of chi-square for the parameters of a corrected shape: twenty, one for
 * each tenth of a duration, with 4 (two deviations) each.  In the records of BAD_FIT in
 * measure.c half of it gives one more wrong row, twice of it the same rows. */
static const double CORRECTION = 80;

/* Excess chi-square of the examples that count, plus the threshold for each pulse.  With
 * half of it an echo, an eighth as high as its pulse, is taken for particles in two of 48
 * records of groups: of one 7 of 23 rows are wrong, of the other all are doubted. */
static double cost(const struct examples *ex, const unsigned char *counts)
{
	double sum = 0;

	for (int i = 0; i < ex->count; i++)
		if (counts[i])
			sum += ex->example[i].excess +
			       ex->scene.threshold_near * ex->example[i].m;
	return sum;
}

int correct_doubtful(struct examples *ex, struct calibration *c)
{
	double share = ex->share;
	int pulses, rest;

	examples_fit(ex, EXAMPLES_ROUGH);
	rest = ex->excess > 2 * sqrt(2 * ex->dof);
	pulses = examples_pulses(ex);
	ex->share = share;
	c->chi2 = examples_fit(ex, share);
	c->penalised = ex->penalised;
	return rest || examples_pulses(ex) > pulses;
}

/* Share of the energy of a pulse that one beside it must explain, over that of the last
 * correction of the shape: the next one is smaller.  16 gives the same rows within one
 * doubted in seven records of groups. */
static const double FOLLOW = 4;

/* Adds to the shape repeatedly what the pulses have in common.  At first a pulse that
 * overlaps another must be a large one, so that two pulses of a wrong shape do not stand
 * for one, later a smaller one, as the corrections become smaller.  Ends when they are
 * below what noise makes them, when more pulses than most are found or the residual
 * suddenly grows. */
static enum num_status improve_shape(struct examples *ex, struct calibration *c, int most)
{
	enum { ROUNDS = 20 };
	int half = (int)((shape_reach(c->shape) + 0.75) * c->duration);
	size_t points = 2 * (size_t)half + 1;
	double *more = malloc(2 * points * sizeof *more);
	double misfit = c->estimated ? 0.3 : 0.03, before = INFINITY, change = INFINITY;
	const struct shape *first = c->shape;

	for (int k = 0; more && k < ROUNDS; k++) {
		struct shape *better;
		double chi2 = examples_fit(ex, fmax(misfit, ex->share));

		if (k > 1 && (examples_pulses(ex) > most || chi2 > 2 * before))
			break;
		if (k > 10 && chi2 > CALIBRATE_TOLERABLE)
			break;
		if (k > 1 && misfit <= ex->share && change < ex->share)
			break;
		before = chi2;
		mean_residual(ex, more, more + points, half);
		change = dot(more, more, points) / (c->duration * shape_energy(c->shape));
		misfit = fmin(0.6 * misfit, FOLLOW * change);
		better = shape_correct(c->shape, more, half, 1 / c->duration);
		if (!better) {
			free(more);
			return NUM_MEMORY;
		}
		if (c->shape != first)
			shape_free(c->shape);
		ex->scene.shape = c->shape = better;
	}
	free(more);
	return more ? NUM_OK : NUM_MEMORY;
}

enum num_status correct_shape(struct examples *ex, struct calibration *c)
{
	unsigned char counts[EXAMPLES_MAX];
	double before, share = ex->share;
	struct shape *first = c->shape;
	enum num_status status;

	/* A shape that describes other events than particles is no better for that. */
	for (int i = 0; i < ex->count; i++)
		counts[i] = !ex->example[i].outlier;
	before = cost(ex, counts);
	ex->corrected = 1;
	status = improve_shape(ex, c, examples_pulses(ex));
	c->chi2 = examples_fit(ex, ex->share);
	/* If the noise may be the cause of the residual, the correction must remove all
	 * of it. */
	if (before - cost(ex, counts) > CORRECTION &&
		(!c->presumed_white || c->chi2 < CALIBRATE_DESCRIBES)) {
		c->penalised = ex->penalised;
		if (c->shape != first)
			shape_free(first);
		return status;
	}
	if (c->shape != first)
		shape_free(c->shape);
	ex->scene.shape = c->shape = first;
	ex->corrected = 0;
	ex->share = share;
	c->chi2 = examples_fit(ex, share);
	return status;
}
