#include "io/crc32.h"
#include "io/bytes.h"

enum { SLICES = 8 }; /* bytes that one step takes */

/* table[0][b]: remainder of byte b; table[k][b]: of b followed by k zero bytes. */
static uint32_t table[SLICES][256];

static void make_table(void)
{
	for (uint32_t b = 0; b < 256; b++) {
		uint32_t r = b;

		for (int bit = 0; bit < 8; bit++)
			r = r & 1 ? r >> 1 ^ 0xedb88320u : r >> 1;
		table[0][b] = r;
	}
	for (int k = 1; k < SLICES; k++)
		for (int b = 0; b < 256; b++) {
			uint32_t r = table[k - 1][b];

			table[k][b] = r >> 8 ^ table[0][r & 255];
		}
}

uint32_t crc32_add(uint32_t crc, const void *bytes, size_t n)
{
	const unsigned char *b = bytes;

	if (!table[0][1])
		make_table();
	crc = ~crc;
	for (; n >= SLICES; n -= SLICES, b += SLICES) {
		uint32_t low = crc ^ bytes_u32_little(b), high = bytes_u32_little(b + 4);

		crc = table[7][low & 255] ^ table[6][low >> 8 & 255] ^
		      table[5][low >> 16 & 255] ^ table[4][low >> 24] ^
		      table[3][high & 255] ^ table[2][high >> 8 & 255] ^
		      table[1][high >> 16 & 255] ^ table[0][high >> 24];
	}
	for (; n > 0; n--)
		crc = crc >> 8 ^ table[0][(crc ^ *b++) & 255];
	return ~crc;
}
