/* detection.h - probability of detection of a particle by its size
 *
 * The peak K v d^3 of a pulse in noise of deviation sigma passes a threshold of T sigma
 * with probability Phi(K v d^3 / sigma - T); half of the particles of size d50 are
 * detected, so that it is Phi(T ((d / d50)^n - 1)) with n = 3, or 5 for non-ferrous
 * particles.
 */
#ifndef COUNT_DETECTION_H
#define COUNT_DETECTION_H

struct detection {
	double d50;       /* m; 0: every particle is detected */
	double threshold; /* T, deviations */
	double exponent;  /* n */
};

double detection_probability(const struct detection *d, double diameter);
/* Diameter that is detected with this probability, 0 < p < 1. */
double detection_diameter(const struct detection *d, double p);

/* Threshold that noise with a correlation time of one pulse exceeds at the given rate per
 * second: rate exp(-T^2 / 2) / duration (Rice).  NAN if there is none. */
double detection_threshold(double duration, double rate);

#endif
