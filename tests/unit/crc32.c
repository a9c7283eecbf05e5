/* The cyclic redundancy check: its published value, and bytes in any parts */
#include "num/crc32.h"
#include "tap.h"

#include <string.h>

enum { BYTES = 1000 };
static unsigned char bytes[BYTES];

/* Bit by bit. */
static uint32_t slowly(const unsigned char *b, size_t n)
{
	uint32_t crc = ~0u;

	for (size_t i = 0; i < 8 * n; i++) {
		crc ^= (uint32_t)b[i / 8] >> i % 8 & 1;
		crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
	}
	return ~crc;
}

int main(void)
{
	int whole = 0, added = 0, joined = 0;

	for (uint32_t i = 0, x = 1; i < BYTES; i++, x = x * 1664525 + 1013904223)
		bytes[i] = (unsigned char)(x >> 24);
	ok(crc32_add(0, "123456789", 9) == 0xcbf43926u,
		"the check of 123456789 is cbf43926");
	for (size_t n = 0; n <= BYTES; n++) {
		const unsigned char *b = bytes + (BYTES - n) / 2;
		uint32_t want = slowly(b, n);
		size_t first = n * 2 / 3;
		uint32_t one = crc32_add(0, b, first),
			 other = crc32_add(0, b + first, n - first);

		whole += crc32_add(0, b, n) == want;
		added += crc32_add(one, b + first, n - first) == want;
		joined += crc32_join(one, other, n - first) == want;
	}
	ok(whole == BYTES + 1, "of 0 to %d bytes it is the remainder, bit by bit", BYTES);
	ok(added == BYTES + 1, "bytes may be added in parts");
	ok(joined == BYTES + 1, "the checks of two parts may be joined");
	return tap_done();
}
