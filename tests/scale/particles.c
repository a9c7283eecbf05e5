/* particles - a table of wear particles of any length, for the readers of large ensembles
 *
 *	particles ROWS [PER]    PER rows a realisation (default 1000), in ten steps
 *
 * Sizes follow a Weibull distribution of shape 2; the random numbers are those of a
 * linear congruential generator, the same everywhere.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
	long rows = argc > 1 ? atol(argv[1]) : 1000,
	     per = argc > 2 ? atol(argv[2]) : 1000;
	uint64_t state = 1;
	enum { SIZES = 4096 };
	static char size[SIZES][64];

	for (int i = 0; i < SIZES; i++) {
		double d = 1e-5 * sqrt(-log((i + 0.5) / SIZES));

		snprintf(size[i], sizeof size[i], "%.9g\t%.9g", M_PI / 6 * d * d * d, d);
	}
	puts("# units: 1 1 1 m3 m 1\nrealisation\tstep\tparticle\tvolume\tdiameter\taspect");
	for (long i = 0; i < rows; i++) {
		state = state * 6364136223846793005u + 1442695040888963407u;
		printf("%ld\t%ld\t%ld\t%s\t1.%02d\n", i / per, 1 + i % per * 10 / per,
			i % per, size[state >> 52], (int)(state >> 33) % 100);
	}
	return fflush(stdout) != 0;
}
