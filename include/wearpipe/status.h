/* status.h - error codes of the functions of the library
 *
 * Functions that make an object return NULL and store the reason in *status, which may
 * be NULL; all others return it.  WP_OK is 0.
 *
 *	if (strcmp(wp_status_text(WP_OK), "no error") != 0)
 *		return 1;
 */
#ifndef WEARPIPE_STATUS_H
#define WEARPIPE_STATUS_H

#if defined(__GNUC__)
#define WP_API __attribute__((visibility("default")))
#else
#define WP_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

enum wp_status {
	WP_OK,
	WP_NO_MEMORY,
	WP_DOMAIN,        /* a parameter is out of its range */
	WP_NUMBERS,       /* input that is not finite, or a result beyond doubles */
	WP_NOT_CONVERGED, /* a result was written but misses the tolerance */
	WP_IMPOSSIBLE,    /* no solution: load above the hardness, heights or depths that
			   * the grid cannot carry */
	WP_CUT_OFF        /* a result was written, but the border of the grid cuts off a
			   * considerable part of it */
};

/* A phrase for a message, in static memory. */
WP_API const char *wp_status_text(enum wp_status status);

/* "0.1.0" */
WP_API const char *wp_version(void);

#ifdef __cplusplus
}
#endif
#endif
