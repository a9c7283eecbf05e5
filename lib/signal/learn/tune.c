/* tune.c - see examples.h */
#include "num/sigmas.h"
#include "signal/learn/examples.h"
#include <math.h>

/* Chi-square above which noise of a suspected colour is not white; half and twice of it
 * give the same rows in the records of BAD_FIT in measure.c. */
static const double HOPELESS = 100;

/* Steps from the middle to the least of the parabola through three points a step apart,
 * at most two. */
static double to_least(double below, double middle, double above)
{
	double bend = below - 2 * middle + above;
	double move = bend > 0 ? 0.5 * (below - above) / bend : below < above ? -1 : 1;

	return fmax(fmin(move, 2), -2);
}

/* The step to the least of chi-square by its slopes, of the parameters that are not
 * known, at most so far. */
static void find_step(const struct joint_slopes *s, const int known[JOINT_SLOPES],
	double most, double step[JOINT_SLOPES])
{
	const double *g = s->gradient, h = s->curvature[1][0];
	const double det = s->curvature[0][0] * s->curvature[1][1] - h * h;

	for (int k = 0; k < JOINT_SLOPES; k++) {
		const double own = s->curvature[k][k], other = s->curvature[1 - k][1 - k];

		step[k] = known[k] || !(own > 0) ? 0
			  : known[1 - k] || !(det > 0)
				  ? g[k] / own
				  : (other * g[k] - h * g[1 - k]) / det;
		step[k] = fmax(fmin(step[k], most), -most);
	}
}

/* By Newton's method.  Pieces, which contain parts of pulses, are fitted well by longer
 * pulses, too: in crowds their duration is not believed against the spectrum. */
void tune(struct examples *ex, double most, int steps)
{
	const int known[] = { !isnan(ex->par->duration), !isnan(ex->par->gain) };
	struct joint_slopes slopes, next = { .gradient = { 0 } };
	double least = examples_chi2(ex, &slopes);

	if (isfinite(least))
		examples_keep(ex);
	for (int k = 0; k < steps && isfinite(least); k++) {
		const struct joint_scene before = ex->scene;
		double step[JOINT_SLOPES], now;

		find_step(&slopes, known, most, step);
		ex->scene.duration *= exp(step[JOINT_DURATION]);
		ex->scene.gain *= exp(step[JOINT_GAIN]);
		now = examples_chi2(ex, k + 1 < steps ? &next : NULL);
		if (now < least) {
			least = now;
			slopes = next;
			examples_keep(ex);
		} else {
			ex->scene = before;
			most = 0.25 * fmax(fabs(step[0]), fabs(step[1]));
		}
	}
	if (fabs(ex->scene.duration - ex->spectral) > ex->within && ex->within > 0)
		ex->scene.duration = ex->spectral;
}

/* Chi-square with this width.  Mean duration and energy at sensor 2 are kept: duration
 * and gain that go with the width then hardly change with it. */
static double chi2_of_width(struct examples *ex, double log_width)
{
	double change = sqrt(exp(log_width) / ex->scene.width);

	ex->scene.width = exp(log_width);
	ex->scene.duration /= isnan(ex->par->duration) ? change : 1;
	ex->scene.gain /= isnan(ex->par->gain) ? change : 1;
	return examples_chi2(ex, NULL);
}

/* Chi-square if the logarithm of the gain changes by this much in what is learned from.
 */
static double chi2_of_drift(struct examples *ex, double change)
{
	ex->drift = change / (2 * ex->middle);
	return examples_chi2(ex, NULL);
}

typedef double chi2_of(struct examples *, double);

/* Adjusts a parameter that is 0 in most instruments to the least chi-square, by a
 * parabola; 1 if it has changed.  It is 0 unless it reduces chi-square by more than
 * noise, and what the shape leaves, would. */
static int tune_rare(struct examples *ex, chi2_of *of, double before, double step)
{
	const double small = 5e-4;
	const struct joint_scene scene = ex->scene;
	const double drift = ex->drift;
	double middle = of(ex, before), best, now, below, above, none;

	below = of(ex, before - step);
	above = of(ex, before + step);
	now = before + step * to_least(below, middle, above);
	best = of(ex, now);
	none = before == 0 ? middle : of(ex, 0);
	if (none - best > SIGMAS_NEVER * SIGMAS_NEVER * fmax(best / ex->dof, 1))
		of(ex, now);
	else
		now = 0;
	if (fabs(now - before) > small)
		return 1;
	ex->scene = scene;
	ex->drift = drift;
	return 0;
}

/* The closer duration and gain are, the smaller a pulse may be without being a misfit of
 * its neighbour.  Pulses kept from round to round may stay where others describe the
 * examples better: the last round also finds them anew. */
enum separate_status tune_pulse(struct examples *ex, struct calibration *c)
{
	enum { ROUNDS = 16 };
	double step = 0.01, misfit = 0.01, moved, before;

	for (int k = 0; k < ROUNDS; k++) {
		before = c->chi2;
		c->chi2 = examples_fit(ex, fmax(misfit, ex->share));
		c->penalised = ex->penalised;
		if ((k > 1 || c->whitening.tap) && c->presumed_white &&
			c->chi2 > HOPELESS)
			break;
		tune(ex, 2 * step, 2);
		moved = fabs(log(ex->scene.duration / c->duration));
		step = fmin(fmax(3 * moved, 0.002), 0.02);
		c->duration = ex->scene.duration;
		c->gain = ex->scene.gain * c->noise[1] / c->noise[0];
		c->width = ex->scene.width;
		if (c->whitening.tap && moved > 1e-3 && !c->measured) {
			if (known_shape_set(c, c->pulse) != NUM_OK)
				return SEPARATE_MEMORY;
			ex->scene.shape = c->shape;
		}
		if (k > 1 &&
			(examples_full(ex) || (c->chi2 > 10 && c->chi2 > 0.8 * before)))
			break; /* too dense, or other pulses: no use */
		if (k > 2 && moved < 5e-4 &&
			(calibration_describes(c) || c->chi2 > 0.95 * before)) {
			if (ex->by == EXAMPLES_BETTER)
				break;
			ex->by = EXAMPLES_BETTER;
		} else {
			ex->by = EXAMPLES_AGAIN;
			misfit *= 0.3;
		}
	}
	ex->by = EXAMPLES_ANEW;
	return SEPARATE_OK;
}

/* Adjusts width and drift of the gain; 1 if one has changed. */
static int tune_rest(struct examples *ex, int round)
{
	double finest = 0.01, step = fmax(0.1 * pow(0.3, round), finest);
	int changed = tune_rare(ex, chi2_of_width, log(ex->scene.width), finest);

	if (isnan(ex->par->gain))
		changed |= tune_rare(ex, chi2_of_drift, ex->drift * 2 * ex->middle, step);
	return changed;
}

enum separate_status tune_all(struct examples *ex, struct calibration *c)
{
	enum { ROUNDS = 6 };
	enum separate_status status = tune_pulse(ex, c);

	for (int k = 0; k < ROUNDS && status == SEPARATE_OK && !ex->pieces &&
			ex->status == SEPARATE_OK && tune_rest(ex, k);
		k++)
		status = tune_pulse(ex, c);
	return status;
}
