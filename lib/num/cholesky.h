/* cholesky.h - small symmetric positive definite systems */
#ifndef NUM_CHOLESKY_H
#define NUM_CHOLESKY_H

#include "num/status.h"
#include <stddef.h>

/* Replaces the lower triangle of the n by n matrix a, rows stride apart, by its Cholesky
 * factor.  NUM_DOMAIN: a pivot is at most least of its diagonal element. */
enum num_status cholesky_factor(double *a, size_t n, size_t stride, double least);
/* x becomes the solution of L L^T x = x. */
void cholesky_solve(const double *a, size_t n, size_t stride, double *x);

#endif
