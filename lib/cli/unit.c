#include "cli/unit.h"
#include "cli/msg.h"
#include "num/bytes.h"
#include <ctype.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Spellings of every unit: times / over * 10^ten of the SI unit.  power: exponent to
 * which a prefix is raised; 0 if the unit takes no prefix. */
static const struct spelling {
	enum unit unit;
	const char *text;
	int ten;
	double times, over;
	int power;
} spellings[] = {
	{ UNIT_LENGTH, "m", 0, 1, 1, 1 },
	{ UNIT_AREA, "m2", 0, 1, 1, 2 },
	{ UNIT_VOLUME, "m3", 0, 1, 1, 3 },
	{ UNIT_VOLUME, "L", -3, 1, 1, 1 },
	{ UNIT_VOLUME, "l", -3, 1, 1, 1 },
	{ UNIT_PRESSURE, "Pa", 0, 1, 1, 1 },
	{ UNIT_PRESSURE, "bar", 5, 1, 1, 0 },
	{ UNIT_FORCE, "N", 0, 1, 1, 1 },
	{ UNIT_FREQUENCY, "Hz", 0, 1, 1, 1 },
	{ UNIT_FREQUENCY, "rpm", 0, 1, 60, 0 },
	{ UNIT_TIME, "s", 0, 1, 1, 1 },
	{ UNIT_TIME, "min", 0, 60, 1, 0 },
	{ UNIT_TIME, "h", 0, 3600, 1, 0 },
	{ UNIT_TIME, "d", 0, 86400, 1, 0 },
	{ UNIT_VOLTAGE, "V", 0, 1, 1, 1 },
	{ UNIT_CURRENT, "A", 0, 1, 1, 1 },
	{ UNIT_FLOW, "m3/s", 0, 1, 1, 3 },
	{ UNIT_FLOW, "L/min", -3, 1, 60, 1 },
	{ UNIT_FLOW, "L/s", -3, 1, 1, 1 },
	{ UNIT_FLOW, "L/h", -3, 1, 3600, 1 },
	{ UNIT_FLOW, "l/min", -3, 1, 60, 1 },
	{ UNIT_FLOW, "l/s", -3, 1, 1, 1 },
	{ UNIT_FLOW, "l/h", -3, 1, 3600, 1 },
	{ UNIT_SPEED, "m/s", 0, 1, 1, 1 },
	{ UNIT_VISCOSITY, "Pa.s", 0, 1, 1, 1 },
	{ UNIT_ANGLE, "rad", 0, 1, 1, 1 },
	{ UNIT_ANGLE, "deg", 0, M_PI, 180, 0 },
	{ UNIT_FRACTION, "%", -2, 1, 1, 0 },
	{ UNIT_DECIBEL, "dB", 0, 1, 1, 0 },
	{ UNIT_CONCENTRATION, "kg/m3", 0, 1, 1, 0 },
	{ UNIT_CONCENTRATION, "g/L", 0, 1, 1, 1 },
	{ UNIT_DENSITY, "kg/m3", 0, 1, 1, 0 },
	{ UNIT_DENSITY, "g/cm3", 3, 1, 1, 0 },
};

static const struct {
	const char *text;
	int ten;
} prefixes[] = {
	{ "f", -15 },
	{ "p", -12 },
	{ "n", -9 },
	{ "u", -6 },
	{ "\xc2\xb5", -6 },
	{ "\xce\xbc", -6 }, /* micro sign, Greek mu */
	{ "m", -3 },
	{ "c", -2 },
	{ "k", 3 },
	{ "M", 6 },
	{ "G", 9 },
	{ "T", 12 },
};

enum { NSPELLINGS = sizeof spellings / sizeof *spellings };
enum { NPREFIXES = sizeof prefixes / sizeof *prefixes };

const char *unit_name(enum unit unit)
{
	for (size_t i = 0; i < NSPELLINGS; i++)
		if (spellings[i].unit == unit)
			return spellings[i].text;
	return "";
}

/* The unit of a suffix of the given length, with its prefix in the power of ten; text
 * NULL if it does not suit. */
static struct spelling find_suffix(const char *text, size_t length, enum unit unit)
{
	for (size_t i = 0; i < NSPELLINGS; i++) {
		struct spelling s = spellings[i];
		size_t n = strlen(s.text);

		if ((s.unit != unit && unit != UNIT_ANY) || n > length ||
			memcmp(text + length - n, s.text, n) != 0)
			continue;
		if (n == length)
			return s;
		for (size_t k = 0; s.power && k < NPREFIXES; k++)
			if (strlen(prefixes[k].text) == length - n &&
				memcmp(text, prefixes[k].text, length - n) == 0) {
				s.ten += s.power * prefixes[k].ten;
				return s;
			}
	}
	return (struct spelling){ .text = NULL };
}

double decimal_shift(const char *text, size_t n, int ten)
{
	enum { MOST = 100000 }; /* beyond double precision, and far from overflow */
	const char *e = memchr(text, 'e', n);
	long exponent = 0;
	char *shifted;
	double value;

	e = e ? e : memchr(text, 'E', n);
	if (e) {
		exponent = strtol(e + 1, NULL, 10);
		exponent = exponent > MOST ? MOST : exponent < -MOST ? -MOST : exponent;
		n = (size_t)(e - text);
	}
	shifted = xprintf("%.*se%ld", (int)n, text, exponent + ten);
	value = strtod(shifted, NULL);
	free(shifted);
	return value;
}

static double in_si(const char *text, size_t n, const struct spelling *s)
{
	return decimal_shift(text, n, s->ten) * s->times / s->over;
}

double unit_scale(const char *text, enum unit unit)
{
	struct spelling s = find_suffix(text, strlen(text), unit);

	return s.text ? in_si("1", 1, &s) : 0;
}

/* The unit in which a quantity is shown, where that is not the SI unit. */
static const struct spelling *shown_spelling(enum unit unit)
{
	const char *text = unit == UNIT_FLOW            ? "L/min"
			   : unit == UNIT_CONCENTRATION ? "g/L"
							: unit_name(unit);

	for (size_t i = 0; i < NSPELLINGS; i++)
		if (spellings[i].unit == unit && strcmp(spellings[i].text, text) == 0)
			return &spellings[i];
	return NULL;
}

static int prefix_ten(char prefix)
{
	for (size_t k = 0; k < NPREFIXES; k++)
		if (prefixes[k].text[0] == prefix && !prefixes[k].text[1])
			return prefixes[k].ten;
	return 0;
}

const char *quantity_text(double value, enum unit unit, char text[NUMBER_TEXT])
{
	const struct spelling *s =
		unit == UNIT_FRACTION || !(fabs(value) > 0) || isinf(value)
			? NULL
			: shown_spelling(unit);
	char prefix[2] = "";
	double scale = s ? in_si("1", 1, s) : 1;

	/* The largest prefix, "" among them, that leaves at least 1; times of a second
	 * and more stay in seconds. */
	for (const char *p = "pnum kMG"; s && s->power && *p; p++) {
		struct spelling with = *s;
		double prefixed;

		with.ten += s->power * prefix_ten(*p);
		prefixed = in_si("1", 1, &with);

		if (unit == UNIT_TIME && prefixed > 1)
			break;
		if (fabs(value) >= prefixed * (1 - 1e-12)) {
			scale = prefixed;
			prefix[0] = *p == ' ' ? '\0' : *p;
		}
	}
	snprintf(text, NUMBER_TEXT, "%.6g%s%s", value / scale, s ? prefix : "",
		s ? s->text : "");
	return text;
}

double decimal_parse(const char *text, char **end)
{
	const char *digits = text + strspn(text, " \t+-");

	if (digits[0] == '0' && tolower((unsigned char)digits[1]) == 'x') {
		*end = (char *)text;
		return NAN;
	}
	return strtod(text, end);
}

double sample_parse(const char *text, char **end)
{
	double v = decimal_parse(text, end);

	if (isinf(v) && isdigit((unsigned char)(*end)[-1]))
		*end = (char *)text;
	return v;
}

const char *unit_parse(const char *text, enum unit unit, const char *stop, double *value,
	const char **end)
{
	char *rest;
	size_t length;

	/* strtod also accepts blanks, nan and inf; options do not. */
	*value = decimal_parse(text, &rest);
	if (rest == text || !isdigit((unsigned char)text[strspn(text, "+-.")]))
		return "is not a number";
	length = strcspn(rest, stop);
	if (length > 0) {
		struct spelling s = find_suffix(rest, length, unit);

		if (!s.text)
			return unit == UNIT_COUNT || unit == UNIT_NONE
				       ? "takes no unit"
				       : "has the wrong unit";
		*value = in_si(text, (size_t)(rest - text), &s);
	}
	if (!isfinite(*value))
		return "is out of range";
	if (unit == UNIT_COUNT && *value != floor(*value))
		return "is not a whole number";
	*end = rest + length;
	return NULL;
}

/* Number of letters of a and b that differ in case; -1 if any differ otherwise. */
static int capitals(const char *a, const char *b)
{
	int n = 0;

	for (; *a && *b; a++, b++) {
		if (tolower((unsigned char)*a) != tolower((unsigned char)*b))
			return -1;
		n += *a != *b;
	}
	return (*a && *a != ',' && *a != ':') || *b ? -1 : n;
}

const char *unit_meant(const char *text, enum unit unit)
{
	static char meant[32];
	int least = 1000;
	char *rest;

	strtod(text, &rest);
	if (rest == text && strlen(text) < sizeof meant - 1 &&
		unit_scale(text, unit) > 0) {
		snprintf(meant, sizeof meant, "1%s", text);
		return meant;
	}
	if (rest == text)
		return NULL;
	for (size_t i = 0; i < NSPELLINGS; i++) {
		if (spellings[i].unit != unit)
			continue;
		for (size_t k = 0; k <= (spellings[i].power ? NPREFIXES : 0); k++) {
			char name[32];
			int n;

			snprintf(name, sizeof name, "%s%s", k ? prefixes[k - 1].text : "",
				spellings[i].text);
			n = capitals(rest, name);
			if (n > 0 && n < least) {
				least = n;
				memcpy(meant, name, sizeof meant);
			}
		}
	}
	return least < 1000 ? meant : NULL;
}

enum { KEPT = 19, SHORTEST = 15, LONGEST = 17 }; /* decimal digits */

/* Digits that denote a number, the first of which stands for 10^exponent. */
struct decimal {
	uint64_t digits;
	int count, exponent;
};

/* A number and what was rounded off. */
struct sum {
	double value, rest;
};

static struct sum sum_of(double value, double rest)
{
	double sum = value + rest;

	return (struct sum){ sum, rest - (sum - value) };
}

/* value 10^power, to 2^-95: powers of up to 22 are exact. */
static struct sum scale_ten(double value, int power)
{
	static const double ten[] = { 1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9,
		1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21,
		1e22 };
	enum { MOST = sizeof ten / sizeof *ten - 1 };
	struct sum s = { value, 0 };

	while (power != 0) {
		int step = abs(power) < MOST ? abs(power) : MOST;
		double t = ten[step], all = power > 0 ? s.value * t : s.value / t;

		s = power > 0 ? sum_of(all, fma(s.value, t, -all) + s.rest * t)
			      : sum_of(all, (fma(-all, t, s.value) + s.rest) / t);
		power += power > 0 ? -step : step;
	}
	return s;
}

/* As few digits as denote a positive value, 15 to 17; a count of 0 where those that are
 * kept do not decide.  A number denotes the value if it is nearer than half the distance
 * of doubles. */
static struct decimal shortest(double value)
{
	int binary;
	double part = frexp(value, &binary);
	/* The power of ten below, or the one before. */
	struct decimal d = { .exponent = (int)floor((binary - 1) * M_LN2 / M_LN10) };
	struct sum s = scale_ten(value, KEPT - 1 - d.exponent);
	uint64_t kept, unit = 10000; /* of KEPT digits, that of SHORTEST */
	double half, over; /* half the distance, and what is not kept, in units of the
			    * last digit kept */

	if (s.value > 1e19 || (s.value == 1e19 && s.rest >= 0))
		s = scale_ten(value, KEPT - 1 - ++d.exponent);
	half = s.value / part * 0x1p-54;
	over = floor(s.rest);
	kept = (uint64_t)s.value + (uint64_t)(int64_t)over;
	over = s.rest - over;
	/* Below a power of two the distance is another one. */
	for (int n = SHORTEST; n <= LONGEST && part != 0.5; n++, unit /= 10) {
		double tail = (double)(kept % unit) + over, middle = 0.5 * (double)unit;
		int up = tail > middle;
		double off = up ? (double)unit - tail : tail;

		if (fabs(tail - middle) <= 1e-6 * middle ||
			fabs(off - half) <= 1e-6 * half)
			break;
		if (off > half && n < LONGEST)
			continue;
		d.digits = kept / unit + (uint64_t)up;
		d.count = n;
		if (d.digits * unit == 10000000000000000000u) { /* KEPT zeros */
			d.digits /= 10;
			d.exponent++;
		}
		break;
	}
	return d;
}

static char *write_exponent(int exponent, char *to)
{
	int size = abs(exponent);

	*to++ = 'e';
	*to++ = exponent < 0 ? '-' : '+';
	if (size > 99)
		*to++ = (char)('0' + size / 100);
	*to++ = (char)('0' + size / 10 % 10);
	*to++ = (char)('0' + size % 10);
	return to;
}

/* Eight digits: halves of four, pairs, and digits are split side by side, each quotient
 * by a product that is exact for numbers of so many digits. */
static void write_eight(uint64_t value, char *to)
{
	uint64_t half = value / 10000 | value % 10000 << 32, pair, digit;

	pair = half * 5243 >> 19 & 0x7f0000007f;
	pair |= (half - 100 * pair) << 16;
	digit = pair * 103 >> 10 & 0xf000f000f000f;
	digit |= (pair - 10 * digit) << 8;
	digit |= 0x3030303030303030; /* '0' */
	bytes_put_u32_little((unsigned char *)to, (uint32_t)digit);
	bytes_put_u32_little((unsigned char *)to + 4, (uint32_t)(digit >> 32));
}

/* As printf() does for %g with as many digits; returns the end. */
static char *write_decimal(const struct decimal *d, int negative, char *to)
{
	enum { HALF_UNIT = 100000000 };
	char all[LONGEST], *digit = all + LONGEST - d->count;
	int used = d->count, plain = d->exponent >= -4 && d->exponent < used;
	int before = plain ? d->exponent + 1 : 1, whole; /* digits before the point */
	uint64_t high = d->digits / HALF_UNIT;

	all[0] = (char)('0' + high / HALF_UNIT);
	write_eight(high % HALF_UNIT, all + 1);
	write_eight(d->digits % HALF_UNIT, all + 9);
	while (used > 1 && digit[used - 1] == '0')
		used--;
	if (negative)
		*to++ = '-';
	whole = before < 0 ? 0 : before < used ? before : used;
	if (before <= 0) {
		*to++ = '0';
		*to++ = '.';
	}
	for (int i = before; i < 0; i++)
		*to++ = '0';
	memcpy(to, digit, (size_t)whole);
	to += whole;
	for (int i = whole; i < before; i++)
		*to++ = '0';
	if (before > 0 && used > before)
		*to++ = '.';
	memcpy(to, digit + whole, (size_t)(used - whole));
	to += used - whole;
	return plain ? to : write_exponent(d->exponent, to);
}

/* A whole number of less than 15 digits. */
static char *write_whole(long long value, char *to)
{
	char digits[24];
	int n = 0;

	if (value < 0) {
		*to++ = '-';
		value = -value;
	}
	do
		digits[n++] = (char)('0' + value % 10);
	while ((value /= 10) > 0);
	while (n > 0)
		*to++ = digits[--n];
	return to;
}

/* The same, digit by digit. */
static char *write_slowly(double value, char text[NUMBER_TEXT])
{
	for (int digits = SHORTEST; digits <= LONGEST; digits++) {
		snprintf(text, NUMBER_TEXT, "%.*g", digits, value);
		if (strtod(text, NULL) == value)
			break;
	}
	return text + strlen(text);
}

size_t number_write(double value, char text[NUMBER_TEXT])
{
	double size = fabs(value);
	int whole = size < 1e14 && value == floor(value);
	struct decimal d = { .count = 0 };
	char *end;

	/* Powers of ten stay normal. */
	if (size > 1e-280 && size < 1e280 && !whole)
		d = shortest(size);
	if (isnan(value))
		end = strcpy(text, "nan") + 3;
	else if (whole && !(size == 0 && signbit(value)))
		end = write_whole((long long)value, text);
	else if (d.count > 0)
		end = write_decimal(&d, value < 0, text);
	else
		end = write_slowly(value, text);
	*end = '\0';
	return (size_t)(end - text);
}

double decimal_multiple(double k, double step)
{
	char text[NUMBER_TEXT];

	snprintf(text, sizeof text, "%.15g", k * step);
	return strtod(text, NULL);
}

const char *number_text(double value, char text[NUMBER_TEXT])
{
	number_write(value, text);
	return text;
}
