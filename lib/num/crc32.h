/* crc32.h - the cyclic redundancy check of zlib, gzip and PNG (polynomial 0xedb88320)
 *
 *	uint32_t crc = 0;
 *	crc = crc32_add(crc, bytes, n);   of all bytes so far, as zlib.crc32() gives it
 */
#ifndef NUM_CRC32_H
#define NUM_CRC32_H

#include <stddef.h>
#include <stdint.h>

uint32_t crc32_add(uint32_t crc, const void *bytes, size_t n);
/* The check of bytes with that of their first part and that of the n others, each summed
 * from 0. */
uint32_t crc32_join(uint32_t first, uint32_t second, size_t n);

#endif
