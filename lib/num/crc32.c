#include "num/crc32.h"
#include "num/bytes.h"
#include <pthread.h>
#if defined(__x86_64__) && defined(__GNUC__)
#include <wmmintrin.h>
#endif

/* Bytes that one step takes: 16 take two thirds of the time of 8. */
enum { SLICES = 16 };

/* Bytes that are folded at once, in four lanes of so many. */
enum { FOLD = 64, LANE = 16 };

static const uint32_t polynomial = 0xedb88320u; /* bit 31: the power 0 */

/* table[0][b]: remainder of byte b; table[k][b]: of b followed by k zero bytes. */
static uint32_t table[SLICES][256];
static uint64_t far[2], near[2]; /* what folds a lane into that FOLD, or LANE, on */
static pthread_once_t once = PTHREAD_ONCE_INIT;

static uint32_t times_x(uint32_t a)
{
	return a & 1 ? a >> 1 ^ polynomial : a >> 1;
}

static uint32_t power_of_x(int n)
{
	uint32_t p = 1u << 31;

	while (n-- > 0)
		p = times_x(p);
	return p;
}

/* For both words of a lane, so many bytes on; a product of reflected polynomials is one
 * bit short. */
static void make_fold(uint64_t *fold, int bytes)
{
	fold[0] = (uint64_t)power_of_x(8 * bytes + 32) << 1;
	fold[1] = (uint64_t)power_of_x(8 * bytes - 32) << 1;
}

static void make_table(void)
{
	make_fold(far, FOLD);
	make_fold(near, LANE);
	for (uint32_t b = 0; b < 256; b++) {
		uint32_t r = b;

		for (int bit = 0; bit < 8; bit++)
			r = times_x(r);
		table[0][b] = r;
	}
	for (int k = 1; k < SLICES; k++)
		for (int b = 0; b < 256; b++) {
			uint32_t r = table[k - 1][b];

			table[k][b] = r >> 8 ^ table[0][r & 255];
		}
}

/* What four bytes leave that k zero bytes follow. */
static inline uint32_t shift_word(uint32_t word, int k)
{
	return table[k + 3][word & 255] ^ table[k + 2][word >> 8 & 255] ^
	       table[k + 1][word >> 16 & 255] ^ table[k][word >> 24];
}

/* Product of two polynomials, less multiples of the one of the check. */
static uint32_t multiply(uint32_t a, uint32_t b)
{
	uint32_t product = 0;

	for (; a; a <<= 1, b = times_x(b))
		if (a >> 31)
			product ^= b;
	return product;
}

uint32_t crc32_join(uint32_t first, uint32_t second, size_t n)
{
	uint32_t power = 1u << 23; /* x^8 */

	/* What the first bytes leave is shifted by the bytes that follow. */
	for (; n > 0; n >>= 1, power = multiply(power, power))
		if (n & 1)
			first = multiply(power, first);
	return first ^ second;
}

/* The remainder after the next bytes, as many as a step takes. */
static inline uint32_t step(uint32_t crc, const unsigned char *b)
{
	return shift_word(crc ^ bytes_u32_little(b), 12) ^
	       shift_word(bytes_u32_little(b + 4), 8) ^
	       shift_word(bytes_u32_little(b + 8), 4) ^
	       shift_word(bytes_u32_little(b + 12), 0);
}

#if defined(__x86_64__) && defined(__GNUC__)
#define WITH_PRODUCTS __attribute__((target("pclmul")))

static int has_products(void)
{
	return __builtin_cpu_supports("pclmul");
}

WITH_PRODUCTS static inline __m128i load_lane(const void *bytes)
{
	return _mm_loadu_si128(bytes);
}

WITH_PRODUCTS static inline __m128i fold_into(__m128i lane, __m128i fold, __m128i next)
{
	__m128i low = _mm_clmulepi64_si128(lane, fold, 0x00),
		high = _mm_clmulepi64_si128(lane, fold, 0x11);

	return _mm_xor_si128(_mm_xor_si128(low, high), next);
}

/* The remainder after a multiple of FOLD bytes, by products of polynomials over GF(2):
 * V. Gopal et al., Fast CRC computation for generic polynomials using PCLMULQDQ, Intel,
 * 2009.  A sixth of the time of steps. */
WITH_PRODUCTS static uint32_t fold_bytes(uint32_t crc, const unsigned char *b, size_t n)
{
	const unsigned char *end = b + n;
	__m128i first = load_lane(b), second = load_lane(b + LANE),
		third = load_lane(b + 2 * LANE), last = load_lane(b + 3 * LANE);
	__m128i by_far = load_lane(far), by_near = load_lane(near);
	unsigned char rest[LANE];

	first = _mm_xor_si128(first, _mm_cvtsi32_si128((int)crc));
	/* Loops are not unrolled at -O2. */
	for (b += FOLD; b < end; b += FOLD) {
		first = fold_into(first, by_far, load_lane(b));
		second = fold_into(second, by_far, load_lane(b + LANE));
		third = fold_into(third, by_far, load_lane(b + 2 * LANE));
		last = fold_into(last, by_far, load_lane(b + 3 * LANE));
	}
	second = fold_into(first, by_near, second);
	third = fold_into(second, by_near, third);
	last = fold_into(third, by_near, last);
	_mm_storeu_si128((__m128i *)rest, last);
	return step(0, rest);
}
#else
static int has_products(void)
{
	return 0;
}

static uint32_t fold_bytes(uint32_t crc, const unsigned char *b, size_t n)
{
	(void)b;
	(void)n;
	return crc;
}
#endif

uint32_t crc32_add(uint32_t crc, const void *bytes, size_t n)
{
	const unsigned char *b = bytes;

	pthread_once(&once, make_table);
	crc = ~crc;
	if (n >= FOLD && has_products()) {
		crc = fold_bytes(crc, b, n - n % FOLD);
		b += n - n % FOLD;
		n %= FOLD;
	}
	for (; n >= SLICES; n -= SLICES, b += SLICES)
		crc = step(crc, b);
	for (; n > 0; n--)
		crc = crc >> 8 ^ table[0][(crc ^ *b++) & 255];
	return ~crc;
}
