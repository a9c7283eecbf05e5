#include "cli/progress.h"
#include "cli/program.h"
#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static double started = -1, drawn; /* seconds; drawn is 0 while no line is shown */
static int terminal = -1;
static int due;             /* what is counted has changed: draw at once */
static const char *counted; /* what progress() counts, NULL: nothing */
static double count, count_total;
static double used, input_size, worked; /* bytes; worked: nothing of them is left to do */
static double within = 1;               /* share of the bytes in between that is done */
static int line, lines = 1; /* number of this program, and of all in its pipeline */

static double now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The directory of a program's file, "" where the system does not provide it. */
static void folder_of(const char *process, char folder[PATH_MAX])
{
	char path[300], *slash;
	ssize_t n;

	snprintf(path, sizeof path, "/proc/%.255s/exe", process);
	n = readlink(path, folder, PATH_MAX - 1);
	folder[n > 0 ? n : 0] = '\0';
	slash = strrchr(folder, '/');
	if (slash)
		*slash = '\0';
}

/* Programs of the suite in the same process group belong to one pipeline. */
static void find_line(void)
{
	char mine[PATH_MAX], other[PATH_MAX];
	DIR *all = opendir("/proc");
	struct dirent *e;

	folder_of("self", mine);
	while (all && *mine && (e = readdir(all))) {
		long pid = strtol(e->d_name, NULL, 10);

		if (pid <= 0 || pid == getpid() || getpgid((pid_t)pid) != getpgrp())
			continue;
		folder_of(e->d_name, other);
		if (strcmp(mine, other) == 0) {
			lines++;
			line += pid < getpid();
		}
	}
	if (all)
		closedir(all);
}

/* Writes the text into the line of this program in one call, so that no other program
 * writes in between: makes room below, moves down, and returns. */
static void put(const char *text)
{
	char all[512];
	size_t n = 0;

	for (int i = 1; i < lines && i < 32; i++)
		all[n++] = '\n';
	if (n > 0)
		n += (size_t)snprintf(all + n, sizeof all - n, "\033[%zuA", n);
	if (line > 0)
		n += (size_t)snprintf(all + n, sizeof all - n, "\033[%dB", line);
	n += (size_t)snprintf(all + n, sizeof all - n, "\r%.300s\033[K", text);
	if (line > 0)
		n += (size_t)snprintf(all + n, sizeof all - n, "\033[%dA", line);
	n += (size_t)snprintf(all + n, sizeof all - n, "\r");
	if (write(STDERR_FILENO, all, n) < 0)
		terminal = 0;
}

static const char *duration(double seconds, char text[32])
{
	double h = seconds / 3600;

	snprintf(text, 32,
		seconds < 100 ? "%.0f s"
		: h < 2       ? "%.0f min"
			      : "%.1f h",
		seconds < 100 ? seconds
		: h < 2       ? seconds / 60
			      : h);
	return text;
}

static void draw(void)
{
	double t = now(), done = count, total = count_total;
	const char *what = counted;
	char text[256], left[32];

	if (terminal < 0)
		terminal = isatty(STDERR_FILENO);
	if (started < 0)
		started = t;
	if (!terminal || t - started < 1 || (t - drawn < 0.2 && !due))
		return;
	due = 0;
	if (!(total > 0) && input_size > 0) {
		done = worked + within * (used - worked);
		total = input_size;
	}
	if (!what) {
		what = "MB";
		done = total > 0 ? done : 1e-6 * used;
	}
	if (drawn == 0 && line == 0 && lines == 1)
		find_line();
	drawn = t;
	if (total > 0 && done > 0 && done < 0.01 * total)
		snprintf(text, sizeof text, "%s: 0 %%", program_name());
	else if (total > 0 && done > 0 && done <= total)
		snprintf(text, sizeof text, "%s: %.0f %%, %s left", program_name(),
			100 * done / total,
			duration((t - started) * (total - done) / done, left));
	else
		snprintf(text, sizeof text, "%s: %.0f %s, %s", program_name(), done, what,
			duration(t - started, left));
	put(text);
}

void progress_begin(void)
{
	started = now();
}

void progress(const char *what, double done, double total)
{
	due |= counted != what;
	counted = what;
	count = done;
	count_total = total;
	draw();
}

void progress_read(double bytes, double total)
{
	if (bytes < used || total != input_size) /* another input */
		worked = 0;
	used = bytes;
	input_size = total;
	draw();
}

void progress_within(double share, int last)
{
	within = share;
	due |= last && input_size != used;
	if (last)
		input_size = used;
	draw();
	if (share >= 1)
		worked = used;
}

void progress_clear(void)
{
	if (drawn > 0)
		put("");
	drawn = 0;
}
