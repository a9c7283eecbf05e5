/* Large sets of cells; descriptions read: scene | expectation | outcome | error */
#include "debris/particles.h"
#include "tap.h"

#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

enum { N = 256, LAYERS = 160 };

static long peak_kb(void)
{
	struct rusage u;

	getrusage(RUSAGE_SELF, &u);
	return u.ru_maxrss;
}

static void fill(unsigned char *mask, int z, int every)
{
	for (int y = 0; y < N; y++)
		for (int x = 0; x < N; x++)
			mask[y * N + x] = !every || (x + y + z) % 2;
}

int main(void)
{
	struct particles_par par = {
		.nx = N, .ny = N, .ax = 1e-6, .ay = 1e-6, .az = 1e-6
	};
	struct particles *ps = particles_new(&par);
	unsigned char *mask = malloc(N * N);
	const struct particle *p;
	double want = (double)N * N * LAYERS * 1e-18;
	size_t n;

	for (int z = 0; z < LAYERS; z++) {
		fill(mask, z, 0);
		particles_layer(ps, mask);
	}
	n = particles_end(ps, &p);
	ok(n == 1 && fabs(p->volume / want - 1) < 1e-14,
		"1e7 cells in one particle | volume %g m3 | %g m3 | %.1e", want,
		p->volume, fabs(p->volume / want - 1));
	ok(fabs(p->convexity - 1) < 1e-14,
		"1e7 cells in one particle | convexity 1 | %g | %.1e", p->convexity,
		fabs(p->convexity - 1));
	ok(fabs(p->z / (LAYERS * 0.5e-6) - 1) < 1e-14,
		"1e7 cells in one particle | centroid 80 um deep | %g m | %.1e", p->z,
		fabs(p->z / (LAYERS * 0.5e-6) - 1));
	/* Two layers and the corners of the particle, not its cells. */
	ok(peak_kb() < 20000,
		"1e7 cells in one particle | memory of two layers | %ld kB | none",
		peak_kb());
	particles_begin(ps);
	for (int z = 0; z < 8; z++) {
		fill(mask, z, 1);
		particles_layer(ps, mask);
	}
	n = particles_end(ps, &p);
	ok(n == N * N * 4, "checkerboard of single cells | %d particles | %zu | %d",
		N * N * 4, n, (int)n - N * N * 4);
	ok(p[0].nodes == 1 && p[n - 1].nodes == 1,
		"checkerboard of single cells | one cell each | %g to %g | 0",
		p[n - 1].nodes, p[0].nodes);
	particles_free(ps);
	free(mask);
	return tap_done();
}
