#include "moment.h"
#include "cli/unit.h"
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Days from 1970-01-01, in the Gregorian calendar; the year begins with March. */
static long long days_of(long long year, int month, int day)
{
	long long y = month > 2 ? year : year - 1, m = (month + 9) % 12;

	return 365 * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + day - 1 - 719468;
}

static int days_in(long long year, int month)
{
	int leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);

	return month == 2 ? 28 + leap : 30 + ((month + month / 8) % 2);
}

/* Exactly n digits. */
static int digits(const char **s, int n, int *value)
{
	*value = 0;
	for (int i = 0; i < n; i++, ++*s) {
		if (!isdigit((unsigned char)**s))
			return 0;
		*value = 10 * *value + (**s - '0');
	}
	return 1;
}

static int take(const char **s, const char *any)
{
	if (!**s || !strchr(any, **s))
		return 0;
	++*s;
	return 1;
}

static int zone_of(const char *s, char zone[8])
{
	const char *begin = s;
	int hours, minutes;

	if (!*s || !strcmp(s, "Z")) {
		strcpy(zone, s);
		return 1;
	}
	if (!take(&s, "+-") || !digits(&s, 2, &hours) || !take(&s, ":") ||
		!digits(&s, 2, &minutes) || *s || hours > 23 || minutes > 59)
		return 0;
	strcpy(zone, begin);
	return 1;
}

int moment_parse(const char *s, struct moment *m)
{
	int year, month, day, hour = 0, minute = 0, second = 0;

	*m = (struct moment){ 0 };
	if (!digits(&s, 4, &year) || !take(&s, "-") || !digits(&s, 2, &month) ||
		!take(&s, "-") || !digits(&s, 2, &day))
		return 0;
	m->date = !*s;
	if (!m->date && (!take(&s, "T ") || !digits(&s, 2, &hour) || !take(&s, ":") ||
				!digits(&s, 2, &minute)))
		return 0;
	if (take(&s, ":") && !digits(&s, 2, &second))
		return 0;
	if (take(&s, ".,")) {
		char text[NUMBER_TEXT] = "0.";
		size_t n = strspn(s, "0123456789");

		if (n == 0)
			return 0;
		snprintf(text + 2, sizeof text - 2, "%.*s", n < 18 ? (int)n : 18, s);
		m->fraction = strtod(text, NULL);
		s += n;
	}
	if (month < 1 || month > 12 || day < 1 || day > days_in(year, month) ||
		hour > 23 || minute > 59 || second > 59 || m->fraction >= 1)
		return 0;
	m->second =
		days_of(year, month, day) * 86400 + hour * 3600 + minute * 60 + second;
	return zone_of(s, m->zone);
}

/* Offset of the time zone, s. */
static long long ahead(const char *zone)
{
	long long seconds;

	if (strlen(zone) < 6)
		return 0;
	seconds = strtol(zone + 1, NULL, 10) * 3600 + strtol(zone + 4, NULL, 10) * 60;
	return *zone == '-' ? -seconds : seconds;
}

double moment_between(const struct moment *a, const struct moment *b)
{
	if (!*a->zone != !*b->zone)
		return NAN;
	return (double)(b->second - ahead(b->zone) - a->second + ahead(a->zone)) +
	       (b->fraction - a->fraction);
}

const char *moment_text(const struct moment *m, char text[MOMENT_TEXT])
{
	long long days = m->second / 86400 - (m->second % 86400 < 0), year = 1970;
	int rest = (int)(m->second - days * 86400), month = 1, n;
	char fraction[NUMBER_TEXT];

	year += days / 366; /* at most the true year, for moments after 1970 */
	year -= days < 0;
	while (days_of(year + 1, 1, 1) <= days)
		year++;
	while (days_of(year, 1, 1) > days)
		year--;
	days -= days_of(year, 1, 1);
	while (days >= days_in(year, month))
		days -= days_in(year, month++);
	n = snprintf(text, MOMENT_TEXT, "%04lld-%02d-%02lldT%02d:%02d:%02d", year, month,
		days + 1, rest / 3600, rest / 60 % 60, rest % 60);
	if (m->fraction > 0) {
		snprintf(fraction, sizeof fraction, "%.12f", m->fraction);
		for (size_t k = strlen(fraction); k > 2 && fraction[k - 1] == '0';)
			fraction[--k] = '\0';
		n += snprintf(text + n, MOMENT_TEXT - (size_t)n, "%s", fraction + 1);
	}
	snprintf(text + n, MOMENT_TEXT - (size_t)n, "%s", m->zone);
	return text;
}
