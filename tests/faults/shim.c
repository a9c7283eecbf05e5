/* shim.c - a library to preload that lets the n-th call of a function fail
 *
 *	FAULT_CALL=malloc FAULT_AT=7 LD_PRELOAD=shim.so program     the seventh fails
 *	FAULT_CALL=malloc FAULT_COUNT=f LD_PRELOAD=shim.so program  f gets their number
 *
 * Calls count from the start of main().  A failing call behaves as documented for the
 * function, with ENOMEM, EIO, ENOSPC or EAGAIN. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *wanted, *count_path;
static long at, calls;
static __thread int inside;

static void *real(const char *name)
{
	void *f;

	inside++;
	f = dlsym(RTLD_NEXT, name);
	inside--;
	return f;
}

__attribute__((constructor)) static void start(void)
{
	const char *n = getenv("FAULT_AT");

	wanted = getenv("FAULT_CALL");
	count_path = getenv("FAULT_COUNT");
	at = n ? atol(n) : 0;
	unsetenv("LD_PRELOAD");
}

__attribute__((destructor)) static void stop(void)
{
	char text[32];
	int fd, n;

	if (!count_path)
		return;
	n = snprintf(text, sizeof text, "%ld\n", calls);
	fd = open(count_path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
	if (fd >= 0 && n > 0) {
		ssize_t (*put)(int, const void *, size_t) =
			(ssize_t(*)(int, const void *, size_t))real("write");

		(void)!put(fd, text, (size_t)n);
	}
}

/* 1 if this call must fail. */
static int fails(const char *name)
{
	if (inside || !wanted || strcmp(name, wanted) != 0)
		return 0;
	return __atomic_add_fetch(&calls, 1, __ATOMIC_RELAXED) == at;
}

#define REAL(type, name, ...)                    \
	static type (*real_##name)(__VA_ARGS__); \
	if (!real_##name)                        \
		real_##name = (type(*)(__VA_ARGS__))real(#name);

extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t),
	*__libc_realloc(void *, size_t);

void *malloc(size_t n)
{
	if (fails("malloc")) {
		errno = ENOMEM;
		return NULL;
	}
	return __libc_malloc(n);
}

void *calloc(size_t n, size_t size)
{
	if (fails("calloc")) {
		errno = ENOMEM;
		return NULL;
	}
	return __libc_calloc(n, size);
}

void *realloc(void *p, size_t n)
{
	if (fails("realloc")) {
		errno = ENOMEM;
		return NULL;
	}
	return __libc_realloc(p, n);
}

char *strdup(const char *s)
{
	char *copy;

	if (fails("strdup")) {
		errno = ENOMEM;
		return NULL;
	}
	copy = __libc_malloc(strlen(s) + 1);
	return copy ? strcpy(copy, s) : NULL;
}

ssize_t read(int fd, void *b, size_t n)
{
	REAL(ssize_t, read, int, void *, size_t)
	if (fails("read")) {
		errno = EIO;
		return -1;
	}
	return real_read(fd, b, n);
}

ssize_t write(int fd, const void *b, size_t n)
{
	REAL(ssize_t, write, int, const void *, size_t)
	if (fails("write")) {
		errno = ENOSPC;
		return -1;
	}
	return real_write(fd, b, n);
}

size_t fwrite(const void *b, size_t size, size_t n, FILE *f)
{
	REAL(size_t, fwrite, const void *, size_t, size_t, FILE *)
	if (fails("fwrite")) {
		f->_flags |= 0x20; /* the flag that ferror() tests in glibc */
		errno = ENOSPC;
		return 0;
	}
	return real_fwrite(b, size, n, f);
}

FILE *fopen(const char *path, const char *mode)
{
	REAL(FILE *, fopen, const char *, const char *)
	if (fails("fopen")) {
		errno = EMFILE;
		return NULL;
	}
	return real_fopen(path, mode);
}

int fclose(FILE *f)
{
	REAL(int, fclose, FILE *)
	if (fails("fclose")) {
		real_fclose(f);
		errno = ENOSPC;
		return EOF;
	}
	return real_fclose(f);
}

int fflush(FILE *f)
{
	REAL(int, fflush, FILE *)
	if (fails("fflush")) {
		errno = ENOSPC;
		return EOF;
	}
	return real_fflush(f);
}

FILE *open_memstream(char **text, size_t *size)
{
	REAL(FILE *, open_memstream, char **, size_t *)
	if (fails("open_memstream")) {
		errno = ENOMEM;
		return NULL;
	}
	return real_open_memstream(text, size);
}

int pthread_create(pthread_t *t, const pthread_attr_t *a, void *(*f)(void *), void *x)
{
	REAL(int, pthread_create, pthread_t *, const pthread_attr_t *, void *(*)(void *),
		void *)
	if (fails("pthread_create"))
		return EAGAIN;
	return real_pthread_create(t, a, f, x);
}
