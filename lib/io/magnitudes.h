/* magnitudes.h - are headerless samples those of another type?
 *
 * They do not state their type.  Integers, and numbers of the other byte order, have
 * random exponents if taken for float64, or where their last bytes are 0 the least ones.
 */
#ifndef IO_MAGNITUDES_H
#define IO_MAGNITUDES_H

#include <stddef.h>

struct magnitudes {
	double samples, huge, most; /* huge: those above 1e100 */
};

void magnitudes_add(struct magnitudes *m, const double *x, size_t n);
/* 1 if more than one in a hundred is huge, or some differ from 0 but none is above least.
 */
int magnitudes_absurd(const struct magnitudes *m, double least);

#endif
