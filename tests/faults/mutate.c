/* mutate.c - a stream with a few random faults, the same for the same seed
 *
 *	mutate SEED <stream >mutant
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t state;

static size_t below(size_t n)
{
	state ^= state << 13;
	state ^= state >> 7;
	state ^= state << 17;
	return n ? (size_t)(state % n) : 0;
}

int main(int argc, char **argv)
{
	static const char *const words[] = { "nan", "-1", "1e308", "99999999999999999999",
		"", "\n", "\t", "inf", "0", "#", "NRRD0004\n", ".snd",
		"\xff\xff\xff\xff" };
	enum { MOST = 1 << 22 };
	static unsigned char b[2 * MOST];
	size_t n = fread(b, 1, MOST, stdin);

	state = 0x9e3779b97f4a7c15u * (argc > 1 ? strtoull(argv[1], NULL, 10) + 1 : 1);
	for (size_t k = 1 + below(4); k > 0 && n > 0; k--) {
		/* more often in the header, which is text */
		size_t at = below(below(2) ? n : n < 600 ? n : 600), m;
		const char *w;

		switch (below(5)) {
		case 0:
			b[at] ^= (unsigned char)(1u << below(8));
			break;
		case 1:
			n = at;
			break;
		case 2:
			m = below(n - at < 64 ? n - at : 64);
			memmove(b + at, b + at + m, n - at - m);
			n -= m;
			break;
		case 3:
			m = below(n - at < 64 ? n - at : 64);
			if (n + m > MOST)
				break;
			memmove(b + at + m, b + at, n - at);
			n += m;
			break;
		default:
			w = words[below(sizeof words / sizeof *words)];
			m = strlen(w);
			if (n + m > MOST)
				break;
			memmove(b + at + m, b + at, n - at);
			memcpy(b + at, w, m);
			n += m;
		}
	}
	fwrite(b, 1, n, stdout);
	return 0;
}
