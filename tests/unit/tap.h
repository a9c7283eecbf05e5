/* tap.h - functions for unit tests in C */
#ifndef TAP_H
#define TAP_H

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

static int tap_tests, tap_bad;

/* One result; the description is a printf format.  A failure names file and line. */
#define ok(good, ...) tap_ok(__FILE__, __LINE__, good, __VA_ARGS__)
__attribute__((format(printf, 4, 5))) static inline int tap_ok(
	const char *file, int line, int good, const char *format, ...)
{
	va_list ap;

	tap_bad += !good;
	printf("%sok %d - ", good ? "" : "not ", ++tap_tests);
	va_start(ap, format);
	vprintf(format, ap);
	va_end(ap);
	putchar('\n');
	if (!good)
		printf("# at %s:%d\n", file, line);
	return good;
}

/* |got - want| <= tolerance, absolute. */
#define near(got, want, tolerance, what) \
	tap_near(__FILE__, __LINE__, got, want, tolerance, what)
static inline int tap_near(const char *file, int line, double got, double want,
	double tolerance, const char *what)
{
	int good = fabs(got - want) <= tolerance;

	tap_ok(file, line, good, "%s", what);
	if (!good)
		printf("# got %.17g, want %.17g, difference %.3g > %.3g\n", got, want,
			got - want, tolerance);
	return good;
}

/* The larger of the two; nan if one is nan, which fmax() ignores. */
static inline double tap_max(double a, double b)
{
	return a >= b || isnan(a) ? a : b;
}

/* Last call of main: return tap_done(); */
static inline int tap_done(void)
{
	printf("1..%d\n", tap_tests);
	return tap_bad > 0;
}

#endif
