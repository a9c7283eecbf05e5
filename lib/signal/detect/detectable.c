/* detectable.c - see detectable.h */
#include "signal/detect/detectable.h"
#include <math.h>

/* Probability that noncentral chi-square of three degrees of freedom and parameter m^2
 * exceeds r^2: the integral of s / m (f(s - m) - f(s + m)), f the normal density. */
static double exceeds(double m, double r)
{
	double below = 0.5 * erfc((r - m) / M_SQRT2),
	       above = 0.5 * erfc((r + m) / M_SQRT2);
	double density = sqrt(2 / M_PI) * exp(-(r * r + m * m) / 2);
	/* sinh(r m) / m, times the density at 0 of both */
	double slope = m > 1e-6 ? density * sinh(r * m) / m : density * r;

	if (r * m > 300) /* the other exponential is negligible */
		slope = exp(-(r - m) * (r - m) / 2) / sqrt(2 * M_PI) / m;
	return fmin(below + above + slope, 1);
}

double detectable_alone(const struct joint_scene *s, double a)
{
	return exceeds(a * sqrt(joint_energy(s)), sqrt(s->threshold));
}

/* Share of the energy of a pulse that remains beside another, this share of a duration
 * away, after the fit of amplitude and arrival of that one, whose columns are orthogonal.
 */
static double left_beside(const struct shape *shape, double away)
{
	const double T = 200; /* samples of a duration, enough for its slope */
	long reach = (long)ceil(shape_reach(shape) * T);
	double pq = 0, dq = 0, dd = 0, pp = 0;

	for (long i = -reach; i <= reach; i++) {
		double x = (double)i, p, q, slope;

		shape_sample(shape, -x, T, 0, 1, &p, &slope, NULL);
		shape_sample(shape, away * T - x, T, 0, 1, &q, NULL, NULL);
		pq += p * q;
		dq += slope * q;
		pp += p * p;
		dd += slope * slope;
	}
	return fmax(1 - pq * pq / (pp * pp) - dq * dq / (dd * pp), 0);
}

void detectable_shares(const struct shape *shape, double share[DETECTABLE_PLACES])
{
	for (int k = 0; k < DETECTABLE_PLACES; k++)
		share[k] = left_beside(shape, (k + 0.5) / DETECTABLE_PLACES);
}

double detectable_beside(const struct joint_scene *s, double a, double large,
	const double share[DETECTABLE_PLACES])
{
	double energy = joint_energy(s), sum = 0;
	double need = fmax(s->threshold, s->misfit * large * large * energy);

	for (int k = 0; k < DETECTABLE_PLACES; k++)
		sum += exceeds(a * sqrt(energy * share[k]), sqrt(need));
	return sum / DETECTABLE_PLACES;
}
