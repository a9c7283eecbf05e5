/* lesser.h - the lesser and the larger of two numbers */
#ifndef NUM_LESSER_H
#define NUM_LESSER_H

#include <stddef.h>

static inline size_t lesser(size_t a, size_t b)
{
	return a < b ? a : b;
}

static inline int lesser_int(int a, int b)
{
	return a < b ? a : b;
}

static inline int larger_int(int a, int b)
{
	return a > b ? a : b;
}

/* In line, as fmin() and fmax(), which take care of nan, are not. */
static inline double lesser_double(double a, double b)
{
	return a < b ? a : b;
}

static inline double larger_double(double a, double b)
{
	return a > b ? a : b;
}

#endif
