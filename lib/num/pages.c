#define _DEFAULT_SOURCE /* madvise() */
#include "num/pages.h"

#include <stdint.h>
#include <sys/mman.h>

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
