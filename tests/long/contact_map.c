/* A measured contact map with independently known counts. */
#include "../unit/tap.h"
#include "debris/particles.h"
#include <stdio.h>

int main(void)
{
	static const char path[] = "../shared/data/map/contact_map_256x256.u8";
	struct particles_par par = { .nx = 256,
		.ny = 256,
		.dx = 1,
		.dy = 1,
		.dz = 1,
		.corners = 1,
		.periodic = 1 };
	static unsigned char map[256 * 256];
	FILE *f = fopen(path, "rb");
	static struct stretch stretch[256 * 256];
	size_t count = 0;
	struct particles *ps;
	const struct particle *p;
	static const double largest[5] = { 6526, 2977, 403, 370, 210 };
	double cells = 0;
	size_t n;

	if (!f || fread(map, 1, sizeof(map), f) != sizeof(map)) {
		ok(1, "the contact map has 123 patches over corners and borders # SKIP %s is not there",
			path);
		if (f)
			fclose(f);
		return tap_done();
	}
	fclose(f);
	for (size_t i = 0; i < sizeof(map); i++)
		if (map[i])
			stretch[count++] = (struct stretch){ i, 0, 1 };
	ps = particles_new(&par);
	particles_find(ps, stretch, count, &p, &n);
	ok(n == 123, "the contact map has 123 patches over corners and borders (got %zu)",
		n);
	for (size_t i = 0; i < n; i++)
		cells += (double)p[i].columns;
	ok(cells == 11412, "the contact map has 11412 cells");
	for (int i = 0; i < 5; i++)
		ok((double)p[i].columns == largest[i],
			"patch %d of the contact map has %g cells", i + 1, largest[i]);
	particles_free(ps);
	par.periodic = 0;
	par.corners = 0;
	ps = particles_new(&par);
	particles_find(ps, stretch, count, &p, &n);
	ok(n == 235, "the contact map has 235 patches over sides alone");
	particles_free(ps);
	return tap_done();
}
