/* sigmas.h - by how much noise is exceeded where something is not noise
 *
 * All tests against noise use one of these levels, standard deviations of what is tested;
 * beside each the share of normal deviates that exceed it on either side.
 */
#ifndef NUM_SIGMAS_H
#define NUM_SIGMAS_H

#define SIGMAS_SELDOM 3.0 /* 3e-3: what more samples will correct */
#define SIGMAS_RARELY 4.0 /* 6e-5: tested once for each pulse or record */
#define SIGMAS_NEVER 5.0  /* 6e-7: tested at many places, or what doubts a row */

/* Twice the logarithm of the likelihood ratio from which on a mixture has a second part:
 * that of 3.5 deviations. */
#define LIKELIHOOD_CERTAIN 12.0

/* Share by which chi-square may exceed its degrees of freedom beside that, since the
 * model of the signal and the level of the noise are not known exactly. */
#define CHI_SQUARE_MORE 0.1

#endif
