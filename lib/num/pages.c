#define _DEFAULT_SOURCE /* of madvise(); NOLINT: the name is the system's */
#include "num/pages.h"

#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

void pages_large(void *memory, size_t size)
{
#ifdef MADV_HUGEPAGE
	uintptr_t begin = (uintptr_t)memory, end = begin + size;
	size_t before = (PAGES_LARGE - begin % PAGES_LARGE) % PAGES_LARGE;

	end -= end % PAGES_LARGE;
	if (memory && size >= PAGES_LARGE && begin + before < end)
		madvise((char *)memory + before, end - begin - before, MADV_HUGEPAGE);
#else
	(void)memory;
	(void)size;
#endif
}

void pages_reserve(size_t size)
{
#ifdef __GLIBC__
	void *all;

	mallopt(M_MMAP_MAX, 0);
	mallopt(M_TRIM_THRESHOLD, -1);
	all = malloc(size);
	pages_large(all, size);
	free(all); /* to where the next memory comes from */
#else
	(void)size;
#endif
}
