/* survive.c - messages and allocation for fuzzing: die() goes back to the target instead
 * of ending the process. The memory of a refused stream is not freed. */
#include "survive.h"
#include "cli/msg.h"
#include "cli/program.h"
#include "cli/stats.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

jmp_buf refused;
int verbose;

void program_set_name(const char *program)
{
	(void)program;
}

const char *msg_program(void)
{
	return "fuzz";
}

void die(int status, const char *format, ...)
{
	(void)format;
	longjmp(refused, status);
}

void warn(const char *format, ...)
{
	(void)format;
}

void note(const char *format, ...)
{
	(void)format;
}

void *xcalloc(size_t count, size_t size)
{
	void *p = size && count > ((size_t)1 << 28) / size
			  ? NULL
			  : calloc(count + !count, size + !size);

	if (!p)
		die(EXIT_RUN, "out of memory");
	return p;
}

void *xrealloc(void *p, size_t count, size_t size)
{
	p = realloc(p, count * size + 1);
	if (!p)
		abort();
	return p;
}

char *xstrdup(const char *s)
{
	return strcpy(xcalloc(strlen(s) + 1, 1), s);
}

char *xprintf(const char *format, ...)
{
	char *s = xcalloc(1 << 16, 1);
	va_list ap;

	va_start(ap, format);
	vsnprintf(s, 1 << 16, format, ap);
	va_end(ap);
	return s;
}

void stats_start(void) {}

void stats_open(const char *path)
{
	(void)path;
}

void stats_write(const char *program)
{
	(void)program;
}

const char *stream_of(const uint8_t *data, size_t size)
{
	static char path[] = "/tmp/wearpipe-fuzz-XXXXXX";
	static int lowest; /* file descriptor of streams; refused ones are left open */
	FILE *f;

	if (!lowest) {
		lowest = mkstemp(path);
		if (lowest < 0)
			abort();
	}
	for (int fd = lowest; fd < lowest + 4; fd++)
		close(fd);
	f = fopen(path, "wb");
	if (!f)
		abort();
	fwrite(data, 1, size, f);
	fclose(f);
	return path;
}
