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

/* For programs, before they allocate: malloc() takes arrays of any size one beside the
 * other, so that they share large pages, from so many bytes, and keeps what is freed.
 * Memory is used no sooner than otherwise.  C libraries without the choice ignore it, and
 * so do systems that have less to promise. */
void pages_reserve(size_t size);

#endif
