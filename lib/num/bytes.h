/* bytes.h - IEEE numbers from and to bytes of a stated order, on any host */
#ifndef NUM_BYTES_H
#define NUM_BYTES_H

#include <stdint.h>
#include <string.h>

static inline uint32_t bytes_u32_big(const unsigned char *b)
{
	return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static inline uint32_t bytes_u32_little(const unsigned char *b)
{
	return (uint32_t)b[3] << 24 | (uint32_t)b[2] << 16 | (uint32_t)b[1] << 8 | b[0];
}

static inline float bytes_float(uint32_t bits)
{
	float x;

	memcpy(&x, &bits, sizeof x);
	return x;
}

static inline double bytes_double(uint64_t bits)
{
	double x;

	memcpy(&x, &bits, sizeof x);
	return x;
}

static inline double bytes_double_big(const unsigned char *b)
{
	return bytes_double((uint64_t)bytes_u32_big(b) << 32 | bytes_u32_big(b + 4));
}

static inline double bytes_double_little(const unsigned char *b)
{
	return bytes_double(
		(uint64_t)bytes_u32_little(b + 4) << 32 | bytes_u32_little(b));
}

static inline void bytes_put_u32_big(unsigned char *b, uint32_t v)
{
	b[0] = (unsigned char)(v >> 24);
	b[1] = (unsigned char)(v >> 16);
	b[2] = (unsigned char)(v >> 8);
	b[3] = (unsigned char)v;
}

static inline void bytes_put_u32_little(unsigned char *b, uint32_t v)
{
	b[0] = (unsigned char)v;
	b[1] = (unsigned char)(v >> 8);
	b[2] = (unsigned char)(v >> 16);
	b[3] = (unsigned char)(v >> 24);
}

static inline void bytes_put_double_little(unsigned char *b, double x)
{
	uint64_t bits;

	memcpy(&bits, &x, sizeof bits);
	bytes_put_u32_little(b, (uint32_t)bits);
	bytes_put_u32_little(b + 4, (uint32_t)(bits >> 32));
}

static inline void bytes_put_double_big(unsigned char *b, double x)
{
	uint64_t bits;

	memcpy(&bits, &x, sizeof bits);
	bytes_put_u32_big(b, (uint32_t)(bits >> 32));
	bytes_put_u32_big(b + 4, (uint32_t)bits);
}

static inline void bytes_put_float_big(unsigned char *b, float x)
{
	uint32_t bits;

	memcpy(&bits, &x, sizeof bits);
	bytes_put_u32_big(b, bits);
}

static inline void bytes_put_float_little(unsigned char *b, float x)
{
	uint32_t bits;

	memcpy(&bits, &x, sizeof bits);
	bytes_put_u32_little(b, bits);
}

#endif
