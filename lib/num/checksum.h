/* checksum.h - 64-bit FNV-1a (Fowler, Noll, Vo; IETF draft-eastlake-fnv) of bytes
 *
 *	sum = checksum(a, sizeof a, CHECKSUM_START);
 *	sum = checksum(b, sizeof b, sum);
 */
#ifndef NUM_CHECKSUM_H
#define NUM_CHECKSUM_H

#include <stddef.h>
#include <stdint.h>

static const uint64_t CHECKSUM_START = 0xcbf29ce484222325u;

static inline uint64_t checksum(const void *bytes, size_t n, uint64_t sum)
{
	const unsigned char *p = bytes;

	for (size_t i = 0; i < n; i++)
		sum = (sum ^ p[i]) * 0x100000001b3u;
	return sum;
}

#endif
