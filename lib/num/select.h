/* select.h - partial sorting for a few order statistics */
#ifndef NUM_SELECT_H
#define NUM_SELECT_H

#include <stddef.h>

/* Reorders v[n] so that v[rank[k]] is the value it would have if v were sorted, for count
 * ascending ranks below n; smaller values come before each of them and larger ones after.
 * Expected work n log(count).  No NAN. */
void select_ranks(double *v, size_t n, const size_t *rank, size_t count);

/* Ascending order; INFINITY may be among them, NAN not. */
void sort_numbers(double *v, size_t n);
/* Quantile of n >= 1 ascending values, linear between order statistics at (n - 1) level;
 * the last ones may be INFINITY. */
double sorted_quantile(const double *sorted, size_t n, double level);
double median_of_three(double a, double b, double c);

#endif
