#include "cli/stats.h"
#include "cli/files.h"
#include "cli/msg.h"
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

enum { STATS_MAX = 64 };

static struct {
	const char *name;
	double value;
} counters[STATS_MAX];
static int ncounters;
static struct timespec begin;
static FILE *file;
static const char *file_name;

static double *counter(const char *name)
{
	for (int i = 0; i < ncounters; i++)
		if (strcmp(counters[i].name, name) == 0)
			return &counters[i].value;
	if (ncounters == STATS_MAX)
		die(EXIT_RUN, "more than %d counters", STATS_MAX);
	counters[ncounters].name = xstrdup(name);
	return &counters[ncounters++].value;
}

void stats_add(const char *name, double amount)
{
	*counter(name) += amount;
}

void stats_set(const char *name, double value)
{
	*counter(name) = value;
}

void stats_max(const char *name, double value)
{
	double *c = counter(name);

	if (value > *c)
		*c = value;
}

void stats_start(void)
{
	clock_gettime(CLOCK_MONOTONIC, &begin);
}

static double seconds(struct timeval t)
{
	return (double)t.tv_sec + 1e-6 * (double)t.tv_usec;
}

/* Peak memory of this program in kB: ru_maxrss may be that of the parent process; it is
 * used only if the system offers nothing better. */
static long peak_memory(const struct rusage *use)
{
	FILE *f = fopen("/proc/self/status", "r");
	char line[128];
	long kb = use->ru_maxrss;

	while (f && fgets(line, sizeof line, f))
		if (sscanf(line, "VmHWM: %ld kB", &kb) == 1)
			break;
	if (f)
		fclose(f);
	return kb;
}

void stats_open(const char *path)
{
	file = file_reserve(path, &file_name);
}

void stats_write(const char *program)
{
	struct timespec end;
	struct rusage use;
	double wall, cpu;
	long memory;

	clock_gettime(CLOCK_MONOTONIC, &end);
	getrusage(RUSAGE_SELF, &use);
	memory = peak_memory(&use);
	wall = (double)(end.tv_sec - begin.tv_sec) +
	       1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
	cpu = seconds(use.ru_utime) + seconds(use.ru_stime);
	for (int i = 0; i < ncounters; i++)
		note("%s %.10g", counters[i].name, counters[i].value);
	note("seconds %.3f, cpu %.3f, memory %ld kB", wall, cpu, memory);
	if (!file)
		return;
	file_empty(file);
	fputs("program\tseconds\tcpu_seconds\tmemory_kb", file);
	for (int i = 0; i < ncounters; i++)
		fprintf(file, "\t%s", counters[i].name);
	fprintf(file, "\n%s\t%.6f\t%.6f\t%ld", program, wall, cpu, memory);
	for (int i = 0; i < ncounters; i++)
		fprintf(file, "\t%.17g", counters[i].value);
	fputc('\n', file);
	if (fflush(file) || ferror(file) || fclose(file))
		die(EXIT_RUN, "%s: cannot write:", file_name);
}
