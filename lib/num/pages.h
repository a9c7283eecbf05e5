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

#endif
