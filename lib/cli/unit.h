/* unit.h - numbers with units: "7.8um", "21MPa", "60L/min", "1186h"
 *
 * A bare number is SI.  A suffix is an optional prefix (f p n u m c k M G T; also
 * the micro sign) and a unit of the quantity; a prefix without a unit is refused, because
 * m could mean metre or milli.  Powers carry the prefix along: mm3 is (1e-3 m)^3.  nan,
 * inf and trailing junk are refused.
 */
#ifndef CLI_UNIT_H
#define CLI_UNIT_H

#include <stddef.h>

enum unit {
	UNIT_NONE,          /* a plain number */
	UNIT_COUNT,         /* a whole number */
	UNIT_LENGTH,        /* m */
	UNIT_AREA,          /* m2 */
	UNIT_VOLUME,        /* m3, L */
	UNIT_PRESSURE,      /* Pa, bar */
	UNIT_FORCE,         /* N */
	UNIT_FREQUENCY,     /* Hz, rpm */
	UNIT_TIME,          /* s, min, h, d */
	UNIT_VOLTAGE,       /* V */
	UNIT_CURRENT,       /* A */
	UNIT_FLOW,          /* m3/s, L/min, L/s, L/h */
	UNIT_SPEED,         /* m/s */
	UNIT_VISCOSITY,     /* Pa.s */
	UNIT_ANGLE,         /* rad, deg */
	UNIT_FRACTION,      /* a plain number or % */
	UNIT_DECIBEL,       /* dB */
	UNIT_CONCENTRATION, /* kg/m3, mg/L, g/L */
	UNIT_DENSITY,       /* kg/m3, g/cm3 */
	UNIT_ANY            /* any unit above, converted to SI */
};

/* Name of the SI unit for messages and --help: "m", "Pa", ""; never NULL. */
const char *unit_name(enum unit unit);

/* Reads one number from text up to (not including) a character of stop or the
 * end.  Returns NULL and sets *value (SI) and *end, or returns what was wrong,
 * as a phrase to print after the option's name. */
const char *unit_parse(const char *text, enum unit unit, const char *stop, double *value,
	const char **end);

/* strtod, but not for hexadecimal numbers: of those it reads nothing. */
double decimal_parse(const char *text, char **end);
/* The same where infinity denotes a missing sample: of a number beyond double precision
 * it reads nothing, too. */
double sample_parse(const char *text, char **end);

/* k steps, to 15 digits: limits of classes and periods that are compared with decimal
 * numbers.  Three times 0.1 is 4e-17 more than 0.3, which would be below its limit. */
double decimal_multiple(double k, double step);

/* The decimal number of n characters times 10^ten: the double nearest to it, which the
 * product of two rounded numbers need not be. */
double decimal_shift(const char *text, size_t n, int ten);

/* What one of the unit is in SI: 1e-3 for "mm"; 0 if text is not a unit of this kind. */
double unit_scale(const char *text, enum unit unit);

/* Where the unit behind the number of text differs from one that suits by nothing but
 * capitals: the one that is meant ("GPa" for "210Gpa"); for a unit without a number, one
 * of it ("1um" for "um"); else NULL.  Valid until the next call. */
const char *unit_meant(const char *text, enum unit unit);

/* Shortest decimal of 15 to 17 digits that reads back as the same number, or "nan". */
enum { NUMBER_TEXT = 32 };
const char *number_text(double value, char text[NUMBER_TEXT]);
/* The same; returns its length. */
size_t number_write(double value, char text[NUMBER_TEXT]);

/* An SI value as a person writes it, with prefix and unit: "1mm", "210GPa", "10L/min".
 * Six digits; unit_parse() reads it back.  A plain number has no unit. */
const char *quantity_text(double value, enum unit unit, char text[NUMBER_TEXT]);

#endif
