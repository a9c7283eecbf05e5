/* deviates.h - random numbers of a distribution from uniform or standard normal ones
 *
 * They change smoothly with the parameters of the distribution if u or z stays the same.
 */
#ifndef NUM_DEVIATES_H
#define NUM_DEVIATES_H

/* The normal deviate with probability p below it, 0 < p < 1: P. J. Acklam's rational
 * approximation, relative error 1.2e-9, and one of Halley's steps. */
double normal_quantile(double p);

/* Inverse Gaussian of that mean and variance, z normal, u uniform (Michael, Schucany,
 * Haas, The American Statistician 30 (1976) 88). */
double inverse_gaussian(double mean, double variance, double z, double u);

/* Chi-square, z normal (Wilson, Hilferty, PNAS 17 (1931) 684), kept above 0; within 2 %
 * of its quantiles from three degrees of freedom on. */
double chi_square(double freedom, double z);

#endif
