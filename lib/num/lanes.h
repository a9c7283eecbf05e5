/* lanes.h - two doubles at a time, for passes over long arrays
 *
 * Vectors of 16 bytes, which every 64-bit processor has; sums are kept in two lanes in
 * the order of the array, so that the result does not depend on the compiler's choice.
 * Written with the vectors of GCC and Clang.  n is 2, or 1 for a last single element,
 * which then stands in both lanes and counts once in a sum.
 */
#ifndef NUM_LANES_H
#define NUM_LANES_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef double lanes __attribute__((vector_size(16)));
typedef int64_t lane_mask __attribute__((vector_size(16))); /* -1 for yes, 0 for no */
typedef uint64_t lane_words __attribute__((vector_size(16)));
typedef int32_t lane_bits __attribute__((vector_size(16)));
typedef float four __attribute__((vector_size(16))); /* in single precision */

/* Four doubles or eight floats at a time, within functions marked LANES_CLONES: these are
 * compiled for AVX2 too where the loader can choose, to the same bits, since AVX2 has no
 * fused operations; elsewhere they are two vectors of 16 bytes.  Clang gives the chosen
 * function another name, by which other files do not find it. */
typedef double lanes4 __attribute__((vector_size(32)));
typedef int lanes4_int __attribute__((vector_size(16)));
typedef float eight
	__attribute__((vector_size(32), aligned(16))); /* as malloc() aligns */
typedef int32_t eight_bits __attribute__((vector_size(32), aligned(16)));
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__)
#define LANES_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define LANES_CLONES
#endif

/* Of functions that are compiled within those marked LANES_CLONES. */
#define ALWAYS_INLINE inline __attribute__((always_inline))

static inline lanes lanes_all(double x)
{
	return (lanes){ x, x };
}

static inline lanes lanes_load(const double *x, int n)
{
	lanes v;

	if (n == 1)
		return lanes_all(x[0]);
	memcpy(&v, x, sizeof(v));
	return v;
}

static inline void lanes_store(double *x, lanes v, int n)
{
	if (n == 1)
		x[0] = v[0];
	else
		memcpy(x, &v, sizeof(v));
}

static inline lane_mask lanes_flags(const unsigned char *flag, int n)
{
	return (lane_mask){ -(int64_t)flag[0], -(int64_t)flag[n - 1] };
}

/* GCC 12 takes 64-bit masks apart where they are combined, not 32-bit ones. */
static inline lane_mask lanes_and(lane_mask a, lane_mask b)
{
	return (lane_mask)((lane_bits)a & (lane_bits)b);
}

static inline lane_mask lanes_or(lane_mask a, lane_mask b)
{
	return (lane_mask)((lane_bits)a | (lane_bits)b);
}

/* x where yes, 0 elsewhere. */
static inline lanes lanes_if(lane_mask yes, lanes x)
{
	return (lanes)((lane_bits)yes & (lane_bits)x);
}

static inline lanes lanes_pick(lane_mask yes, lanes a, lanes b)
{
	lane_bits is = (lane_bits)yes;

	return (lanes)((is & (lane_bits)a) | (~is & (lane_bits)b));
}

static inline lanes lanes_min(lanes a, lanes b)
{
	return lanes_pick(a < b, a, b);
}

static inline lanes lanes_max(lanes a, lanes b)
{
	return lanes_pick(a > b, a, b);
}

static inline lanes lanes_abs(lanes x)
{
	return (lanes)((lane_mask)x & INT64_MAX);
}

/* exp(x) for |x| <= 700, to 1 unit in the last place or two: 2^k times the series of the
 * rest, |rest| <= log(2) / 2, up to rest^13 / 13! < 2e-16, in four parts side by side. */
static inline lanes lanes_exp(lanes x)
{
	const double shift = 0x1.8p52; /* its last bit counts ones */
	lanes k = x * M_LOG2E + shift, r, r4, a, b, c, d;
	lane_words power = (lane_words)k << 52;

	k -= shift;
	/* log 2 in two parts, the first of 32 bits */
	r = (x - k * 0x1.62e42feep-1) - k * 0x1.a39ef35793c76p-33;
	r4 = r * r * (r * r);
	a = 1. / 24 + r4 * (1. / 40320 + r4 * (1. / 479001600));
	b = 1 + r4 * (1. / 120 + r4 * (1. / 362880));
	c = 0.5 + r4 * (1. / 720 + r4 * (1. / 3628800));
	d = 1. / 6 + r4 * (1. / 5040 + r4 * (1. / 39916800));
	a = 1 + (r * b + r * r * ((c + r * d) + r * r * a));
	return (lanes)((lane_words)a + power);
}

/* Two lanes as a complex number: the product, without the test for infinite parts of C's,
 * and the conjugate. */
static inline lanes lanes_complex(lanes a, lanes b)
{
	lanes turned = { a[1], a[0] }, part = { -b[1], b[1] };

	return a * b[0] + turned * part;
}

static inline lanes lanes_conj(lanes a)
{
	return (lanes){ a[0], -a[1] };
}

/* The first element from i on that is not zero, or n. */
size_t lanes_skip(const double *x, size_t i, size_t n);
static inline size_t lanes_next(const double *x, size_t i, size_t n)
{
	return i < n && x[i] == 0 ? lanes_skip(x, i, n) : i;
}

/* sum += x, lane by lane */
static inline void lanes_add(lanes *sum, lanes x, int n)
{
	*sum += n == 1 ? (lanes){ x[0], 0 } : x;
}

#endif
