#include "cli/progress.h"
#include <stdio.h>
#include <time.h>
#include <unistd.h>

static double started = -1, drawn; /* seconds; drawn 0 while no bar is shown */

static double now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void progress(const char *what, double done, double total)
{
	enum { WIDTH = 40 };
	double t = now();

	if (started < 0)
		started = t;
	if (t - started < 1 || t - drawn < 0.1 || !isatty(STDERR_FILENO))
		return;
	drawn = t;
	if (total > 0) {
		int full = (int)(WIDTH * (done < total ? done / total : 1));

		fprintf(stderr, "\r%s [%.*s%*s] %3.0f %%", what, full,
			"########################################", WIDTH - full, "",
			100 * done / total);
	} else {
		fprintf(stderr, "\r%s %.0f", what, done);
	}
	fflush(stderr);
}

void progress_clear(void)
{
	if (drawn > 0)
		fputs("\r\033[K", stderr);
	drawn = 0;
}
