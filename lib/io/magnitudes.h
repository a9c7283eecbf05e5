/* magnitudes.h - are headerless samples those of another type?
 *
 * They do not state their type.  Integers, and numbers of the other byte order, have
 * random exponents if taken for float64, or where their last bytes are 0 the least ones.
 * Two float32 taken for one float64 have possible magnitudes, but its lower half is a
 * float32 of a possible magnitude too.  In a float64 these are the last bits of the
 * mantissa: either few different ones, or random ones, of which 30 % are above 1e15.
 */
#ifndef IO_MAGNITUDES_H
#define IO_MAGNITUDES_H

#include <stddef.h>
#include <stdint.h>

struct magnitudes {
	double samples, huge, most; /* huge: those above 1e100 */
	double halved;              /* those whose lower half is not 0 */
	double wild;                /* whose lower half as a float32 is above 1e15 */
	uint64_t halves[4];         /* lower halves that occur, by 256 values of a hash */
};

void magnitudes_add(struct magnitudes *m, const double *x, size_t n);
/* 1 if more than one in a hundred is huge, or some differ from 0 but none is above least.
 */
int magnitudes_absurd(const struct magnitudes *m, double least);
/* 1 if they are pairs of float32: at least 64 lower halves are different, for which the
 * chance that no random one is wild is 0.7^64 = 1e-10, and one in a hundred at most is.
 */
int magnitudes_single(const struct magnitudes *m);

#endif
