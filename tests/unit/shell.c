/* Units, quoting of command lines and shortest numbers */
#include "cli/unit.h"
#include "num/rng.h"
#include "tap.h"
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void test_units(void)
{
	static const struct {
		const char *text;
		enum unit unit;
		double want;
	} good[] = {
		{ "7.8um", UNIT_LENGTH, 7.8e-6 },
		{ "7.8\xc2\xb5m", UNIT_LENGTH, 7.8e-6 },
		{ "3m", UNIT_LENGTH, 3 },
		{ "3mm", UNIT_LENGTH, 3e-3 },
		{ "21MPa", UNIT_PRESSURE, 21e6 },
		{ "210bar", UNIT_PRESSURE, 21e6 },
		{ "50", UNIT_FORCE, 50 },
		{ "10kHz", UNIT_FREQUENCY, 1e4 },
		{ "4000rpm", UNIT_FREQUENCY, 4000.0 / 60 },
		{ "60L/min", UNIT_FLOW, 1e-3 },
		{ "1186h", UNIT_TIME, 1186 * 3600.0 },
		{ "5min", UNIT_TIME, 300 },
		{ "2mm3", UNIT_VOLUME, 2e-9 },
		{ "1mm2", UNIT_AREA, 1e-6 },
		{ "80%", UNIT_FRACTION, 0.8 },
		{ "180deg", UNIT_ANGLE, M_PI },
		{ "250mg/L", UNIT_CONCENTRATION, 0.25 },
		{ "-1.5e-3", UNIT_NONE, -1.5e-3 },
		{ "12", UNIT_COUNT, 12 },
		{ ".5um", UNIT_ANY, 5e-7 },
	};
	static const struct {
		const char *text;
		enum unit unit;
	} wrong[] = {
		{ "5m", UNIT_VOLTAGE },
		{ "5k", UNIT_PRESSURE },
		{ "5Pa", UNIT_LENGTH },
		{ "5 m", UNIT_LENGTH },
		{ "nan", UNIT_LENGTH },
		{ "inf", UNIT_LENGTH },
		{ "", UNIT_LENGTH },
		{ "0x10", UNIT_COUNT },
		{ "1.5", UNIT_COUNT },
		{ "1e999", UNIT_LENGTH },
		{ "--5", UNIT_NONE },
		{ "5mmin", UNIT_TIME },
		{ "5umx", UNIT_LENGTH },
		{ "1,5", UNIT_LENGTH },
		{ "m", UNIT_LENGTH },
		{ "5kbar", UNIT_PRESSURE },
	};
	const char *end;
	double v;

	for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
		const char *message =
			unit_parse(good[i].text, good[i].unit, "", &v, &end);

		ok(!message && fabs(v - good[i].want) <= 1e-15 * fabs(good[i].want) &&
				!*end,
			"'%s' is read as %g %s", good[i].text, good[i].want,
			unit_name(good[i].unit));
	}
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
		ok(unit_parse(wrong[i].text, wrong[i].unit, "", &v, &end) != NULL,
			"'%s' is refused where %s is wanted", wrong[i].text,
			*unit_name(wrong[i].unit) ? unit_name(wrong[i].unit)
						  : "a number");
	ok(!unit_parse("70:130", UNIT_FREQUENCY, ":", &v, &end) && v == 70 && *end == ':',
		"reading stops at the separator");
}

/* A number with a prefix is the double nearest to it, as the compiler reads it. */
static void test_prefixes(void)
{
	static const struct {
		const char *text;
		enum unit unit;
		double want;
	} exact[] = {
		{ "40um", UNIT_LENGTH, 40e-6 },
		{ "7.8125\xc2\xb5m", UNIT_LENGTH, 7.8125e-6 },
		{ "0.3\xce\xbcm", UNIT_LENGTH, 0.3e-6 },
		{ "7fm", UNIT_LENGTH, 7e-15 },
		{ "11pm", UNIT_LENGTH, 11e-12 },
		{ "0.7nm", UNIT_LENGTH, 0.7e-9 },
		{ "0.07mm", UNIT_LENGTH, 0.07e-3 },
		{ "2.3cm", UNIT_LENGTH, 2.3e-2 },
		{ "1.1km", UNIT_LENGTH, 1.1e3 },
		{ "355.1MPa", UNIT_PRESSURE, 355.1e6 },
		{ "1e-3GPa", UNIT_PRESSURE, 1e6 },
		{ "0.21TPa", UNIT_PRESSURE, 0.21e12 },
		{ "1.1E2bar", UNIT_PRESSURE, 110e5 },
		{ "7um2", UNIT_AREA, 7e-12 },
		{ "3um3", UNIT_VOLUME, 3e-18 },
		{ "0.7mL", UNIT_VOLUME, 0.7e-6 },
		{ "9L/min", UNIT_FLOW, 9e-3 / 60 },
		{ "7%", UNIT_FRACTION, 0.07 },
		{ "8.3g/cm3", UNIT_DENSITY, 8300 },
	};
	const char *end;
	double v;

	for (size_t i = 0; i < sizeof exact / sizeof *exact; i++)
		ok(!unit_parse(exact[i].text, exact[i].unit, "", &v, &end) &&
				v == exact[i].want,
			"'%s' is the number nearest to it", exact[i].text);
	ok(unit_scale("um", UNIT_LENGTH) == 1e-6 &&
			unit_scale("um3", UNIT_VOLUME) == 1e-18,
		"units are the numbers nearest to them");
}

static void test_number_text(void)
{
	static const double values[] = { 0.1, 1.0 / 3, 5e-324, 1.7976931348623157e308,
		-0.0, 123, 6.02214076e23 };
	char text[NUMBER_TEXT];
	int same = 1;

	for (size_t i = 0; i < sizeof values / sizeof *values; i++)
		same &= strtod(number_text(values[i], text), NULL) == values[i];
	ok(same, "numbers are read back as they were written");
	ok(!strcmp(number_text(0.1, text), "0.1"),
		"numbers are written as short as possible");
	ok(!strcmp(number_text(NAN, text), "nan"), "a missing value is nan");
}

/* The shortest of 15 to 17 digits with which printf() writes the number. */
static void written_by_printf(double value, char text[NUMBER_TEXT])
{
	for (int digits = 15; digits <= 17; digits++) {
		snprintf(text, NUMBER_TEXT, "%.*g", digits, value);
		if (strtod(text, NULL) == value)
			return;
	}
}

/* Random numbers of all sizes, whole ones, short decimals, and the neighbours of powers
 * of two and ten. */
static void test_shortest(void)
{
	char text[NUMBER_TEXT], want[NUMBER_TEXT];
	long wrong = 0;

	for (uint64_t i = 0; i < 60000; i++) {
		double u = philox_uniform(3, 0, RNG_NOISE, 2 * i) - 0.5;
		double e = floor(600 * philox_uniform(3, 0, RNG_NOISE, 2 * i + 1)) - 300;
		double of[] = { u * pow(10, e), floor(u * 1e16), floor(u * 1e5) / 1e9,
			nextafter(pow(10, e), u > 0 ? INFINITY : 0),
			nextafter(ldexp(1, (int)e), u > 0 ? INFINITY : 0),
			(floor(u * 1e6) + 0.5) * ldexp(1, (int)e / 10) };
		double value = of[i % (sizeof of / sizeof *of)];

		written_by_printf(value, want);
		wrong += strcmp(number_text(value, text), want) != 0;
	}
	ok(wrong == 0, "60000 numbers have the digits of printf() (%ld do not)", wrong);
}

int main(void)
{
	test_units();
	test_prefixes();
	test_number_text();
	test_shortest();
	return tap_done();
}
