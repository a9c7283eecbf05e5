/* passage.h - first passage of a gamma process */
#ifndef NUM_PASSAGE_H
#define NUM_PASSAGE_H

#include <gsl/gsl_rng.h>

/* Time until a gamma process has grown by left (0: it has already), whose increments over
 * one unit of time have this mean and variance and are never negative (van Noortwijk,
 * Reliab. Eng. Syst. Saf. 94, 2009); INFINITY for a mean of 0 or less; without
 * variance the rate is constant, and rng may be NULL.  Exact in distribution to a
 * relative 1e-6, at a cost independent of the number of steps: the path is doubled until
 * it is past, then bisected by beta bridges. */
double gamma_passage(double left, double mean, double variance, gsl_rng *rng);

#endif
