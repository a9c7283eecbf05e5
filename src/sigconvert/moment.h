/* moment.h - moments of time in ISO 8601, as recordings write them */
#ifndef MOMENT_H
#define MOMENT_H

/* Days and seconds apart, so that no digit of a fraction of a second is lost. */
struct moment {
	long long second; /* since 1970-01-01 00:00:00, in the zone that is written */
	double fraction;  /* of a second, 0 to below 1 */
	char zone[8];     /* "Z", "+01:00" or "" */
	int date;         /* 1: a date alone, its midnight */
};

/* "2026-11-22T03:04:05.678Z", with a blank for T, a comma for the point, the seconds left
 * out, or "+01:00" or nothing for the zone; or a date alone.  1 if the text is that. */
int moment_parse(const char *text, struct moment *m);
/* Seconds from a to b; NAN if only one of them states its zone. */
double moment_between(const struct moment *a, const struct moment *b);
/* With T and point, digits as needed. */
enum { MOMENT_TEXT = 64 };
const char *moment_text(const struct moment *m, char text[MOMENT_TEXT]);

#endif
