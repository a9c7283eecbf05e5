/* pages.h - large pages for large arrays
 *
 * The system hands out memory page by page when it is first used, which on virtual
 * machines can take as long as the work on a large field; pages of 2 MB take a small part
 * of that.
 */
#ifndef NUM_PAGES_H
#define NUM_PAGES_H

#include <stddef.h>

/* Size and alignment of a large page. */
enum { PAGES_LARGE = 2 << 20 };

/* Asks for large pages within fresh memory; NULL and systems without them are ignored. */
void pages_large(void *memory, size_t size);

/* For programs, before they allocate: from then on malloc() places arrays of any size
 * side by side in a heap of this many bytes, so that they share large pages, and keeps
 * freed memory.  Pages are still mapped on first use.  No effect with C libraries that do
 * not support this, or on systems that cannot reserve as much. */
void pages_reserve(size_t size);

#endif
