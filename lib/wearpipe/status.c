#include <wearpipe/status.h>

const char *wp_status_text(enum wp_status status)
{
	static const char *const text[] = {
		[WP_OK] = "no error",
		[WP_NO_MEMORY] = "out of memory",
		[WP_DOMAIN] = "parameter out of range",
		[WP_NUMBERS] = "numbers beyond double precision",
		[WP_NOT_CONVERGED] = "not converged to the tolerance",
		[WP_IMPOSSIBLE] = "no solution",
		[WP_CUT_OFF] = "cut off at the border of the grid",
	};

	return (unsigned)status < sizeof(text) / sizeof *text ? text[status]
							      : "unknown status";
}

const char *wp_version(void)
{
	return WEARPIPE_VERSION;
}
