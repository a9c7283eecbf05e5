/* crc32.h - the cyclic redundancy check of zlib, gzip and PNG (polynomial 0xedb88320)
 *
 *	uint32_t crc = 0;
 *	crc = crc32_add(crc, bytes, n);   of all bytes so far, as zlib.crc32() gives it
 */
#ifndef IO_CRC32_H
#define IO_CRC32_H

#include <stddef.h>
#include <stdint.h>

uint32_t crc32_add(uint32_t crc, const void *bytes, size_t n);

#endif
