/* contrasts.h - differences between the delays of a group of pulses, made independent
 *
 * If all pulses have one delay tau, their measured delays are d = tau 1 + e, where e has
 * the covariance C.  The contrasts are the components of d across the vector 1 along the
 * eigenvectors of C there: independent, with mean 0 and the eigenvalues as variances;
 * where the delays themselves scatter with variance s^2, with the eigenvalues plus s^2.
 */
#ifndef SIGNAL_CONTRASTS_H
#define SIGNAL_CONTRASTS_H

#include "num/status.h"

/* d[m], m >= 2; cov: row i of C at cov + i * stride.  square[m - 1] receives the squares
 * of the contrasts, var[m - 1] their variances.  NUM_MEMORY. */
enum num_status contrasts_of(int m, const double *d, const double *cov, int stride,
	double *square, double *var);

#endif
