/* sort.h - sorting some hundred numbers at every row
 *
 * Shell's sort with Ciura's gaps: no memory, and none of the calls that take most of the
 * time of qsort() at such sizes.
 */
#ifndef LIFE_SORT_H
#define LIFE_SORT_H

void sort_ascending(double *v, int n);

#endif
