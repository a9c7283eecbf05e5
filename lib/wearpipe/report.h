/* report.h - how the modules of lib/wearpipe report the reason of a failed _new() */
#ifndef WEARPIPE_REPORT_H
#define WEARPIPE_REPORT_H

#include <errno.h>
#include <stddef.h>
#include <wearpipe/status.h>

static inline void *report(enum wp_status *status, enum wp_status what)
{
	if (status)
		*status = what;
	return NULL;
}

/* What errno says after a _new() of the library has returned NULL. */
static inline enum wp_status status_of_errno(void)
{
	return errno == EDOM ? WP_DOMAIN : WP_NO_MEMORY;
}

#endif
