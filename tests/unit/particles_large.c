/* Large sets of cells: rows of the table of extreme scenes */
#include "debris/particles.h"
#include "tap.h"

#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

enum { N = 256, LAYERS = 160, EVERY = 2 };

static long peak_kb(void)
{
	struct rusage u;

	getrusage(RUSAGE_SELF, &u);
	return u.ru_maxrss;
}

int main(void)
{
	struct particles_par par = {
		.nx = N, .ny = N, .dx = 1e-6, .dy = 1e-6, .dz = 1e-6
	};
	struct particles *ps = particles_new(&par);
	struct stretch *s = malloc(sizeof *s * N * N * LAYERS / EVERY);
	const struct particle *p;
	double want = (double)N * N * LAYERS * 1e-18;
	size_t n, count = 0;

	for (size_t i = 0; i < N * N; i++)
		s[count++] = (struct stretch){ i, 0, LAYERS * 1e-6 };
	particles_find(ps, s, count, &p, &n);
	ok(n == 1 && fabs(p->volume / want - 1) < 1e-12,
		"the scene \"1e7 cells in one particle\" leads to \"%g m3\" where \"volume %g m3\" is expected (error %.1e)",
		p->volume, want, fabs(p->volume / want - 1));
	ok(fabs(p->solidity - 1) < 1e-12,
		"the scene \"1e7 cells in one particle\" leads to \"%g\" where \"solidity 1\" is expected (error %.1e)",
		p->solidity, fabs(p->solidity - 1));
	ok(fabs(p->z / (LAYERS * 0.5e-6) - 1) < 1e-12,
		"the scene \"1e7 cells in one particle\" leads to \"%g m\" where \"centroid 80 um deep\" is expected (error %.1e)",
		p->z, fabs(p->z / (LAYERS * 0.5e-6) - 1));
	/* Columns, their corners and their stretches, not the cells. */
	ok(peak_kb() < 60000,
		"the scene \"1e7 cells in one particle\" leads to \"%ld kB\" where \"memory of the columns\" is expected (error none)",
		peak_kb());
	count = 0;
	for (size_t i = 0; i < N * N; i++)
		for (size_t z = (i + i / N) % 2; z < 8; z += 2)
			s[count++] = (struct stretch){ i, (double)z * 1e-6,
				(double)(z + 1) * 1e-6 };
	particles_find(ps, s, count, &p, &n);
	ok(n == N * N * 4,
		"the scene \"checkerboard of single cells\" leads to \"%zu\" where \"%d particles\" is expected (error %d)",
		n, N * N * 4, (int)n - N * N * 4);
	ok(fabs(p[0].volume * 1e18 - 1) < 1e-9 && fabs(p[n - 1].volume * 1e18 - 1) < 1e-9,
		"the scene \"checkerboard of single cells\" leads to \"%g to %g m3\" where \"1 um3 each\" is expected (error 0)",
		p[n - 1].volume, p[0].volume);
	particles_free(ps);
	free(s);
	return tap_done();
}
