/* sort.h - as much sorting as a few quantiles need */
#ifndef LIFE_SORT_H
#define LIFE_SORT_H

/* Reorders v[n] so that v[rank[k]] is what it were if v were sorted, for count ascending
 * ranks; smaller values come before each of them and larger ones after.  Expected work
 * n log(count).  No NAN. */
void sort_at(double *v, int n, const int *rank, int count);

#endif
