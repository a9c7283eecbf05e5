#include "io/ends.h"
#include "cli/msg.h"
#include <stdarg.h>
#include <stdio.h>

static char missed[512]; /* the first message, "" while there is none */

void ends_miss(const char *format, ...)
{
	va_list ap;

	if (*missed)
		return;
	va_start(ap, format);
	vsnprintf(missed, sizeof missed, format, ap);
	va_end(ap);
}

void ends_check(void)
{
	if (*missed)
		die(EXIT_RUN, "%s", missed);
}
