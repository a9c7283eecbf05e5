/* Patches of contacts, by hand and against closed forms. */
#include "contact/patches.h"
#include "contact/solver.h"
#include "num/fft.h"
#include "tap.h"
#include <stdlib.h>

static void by_hand(void)
{
	/* Two cells that touch over the edge of a period, one by itself, a corner apart.
	 */
	static const double p[12] = { 1, 0, 0, 3, /**/ 0, 0, 5, 0, /**/ 0, 0, 0, 0 };
	struct patch_grid g = { 4, 3, 2, 0.5, 1 };
	static const double part[3] = { 0, 0.5, 1 };
	double q[3];
	size_t n;
	struct contact_patch *a;

	ok(contact_patches(&g, p, &a, &n) == NUM_OK && n == 2 && a[0].cells == 2 &&
			a[1].cells == 1,
		"cells on either side of a periodic edge are one patch");
	near(a[0].load, 4, 1e-15, "the load of a patch is p dx dy");
	near(a[0].perimeter, 4 * 2 + 2 * 0.5, 1e-15,
		"the perimeter of two cells in a row is right");
	near(a[0].x, (0.5 * 1 - 0.5 * 3) / 4 * 2 + 8, 1e-15,
		"the centre of a periodic patch is in the grid");
	near(a[1].peak, 5, 1e-15, "the peak of a patch is its largest pressure");
	near(a[1].y, 0.75, 1e-15,
		"the centre of a patch of one cell is that of the cell");
	free(a);
	g.periodic = 0;
	ok(contact_patches(&g, p, &a, &n) == NUM_OK && n == 3,
		"on a free grid the cells at the edges are two patches");
	free(a);
	contact_quantiles(p, 12, part, q, 3);
	ok(q[0] == 1 && q[1] == 3 && q[2] == 5,
		"the quantiles are those of the cells in contact");
}

/* Area of a Hertz contact wherever it lies on the grid: counted, and corrected. */
static void hertz_area(void)
{
	enum { N = 64, PLACES = 12 };
	struct patch_grid g = { N, N, 1. / N, 1. / N, 0 };
	struct contact_par par = { .nx = N,
		.ny = N,
		.dx = g.dx,
		.dy = g.dy,
		.estar = 1,
		.tolerance = 1e-10,
		.max_iterations = 1000 };
	struct contact *c = contact_new(&par);
	double *h = fft_alloc(N * N), *p = fft_alloc(N * N), counted = 0, corrected = 0;

	for (int k = 0; k < PLACES; k++) {
		double a = 0.15 + 0.012 * k, exact = M_PI * a * a;
		double x0 = 0.5 + 0.37 * k / N, y0 = 0.5 - 0.23 * k / N, area = 0,
		       rim = 0;
		struct contact_patch *list;
		size_t n;

		for (int i = 0; i < N * N; i++) {
			double x = (i % N + 0.5) / N - x0, y = (i / N + 0.5) / N - y0;

			h[i] = -(x * x + y * y) / 2;
			p[i] = 0;
		}
		contact_solve(c, h, CONTACT_PRESSURE, 4 * a * a * a / 3, p, NULL);
		contact_patches(&g, p, &list, &n);
		area = list[0].area;
		rim = list[0].perimeter;
		free(list);
		counted += (area / exact - 1) / PLACES;
		corrected += (contact_corrected_area(&g, area, rim) / exact - 1) / PLACES;
	}
	ok(counted > 0.01 && fabs(corrected) < 0.25 * counted,
		"Hertz: the counted area is off by %+.3f %%, corrected for the perimeter by %+.3f %%",
		100 * counted, 100 * corrected);
	contact_free(c);
	fft_free(h);
	fft_free(p);
}

int main(void)
{
	by_hand();
	hertz_area();
	return tap_done();
}
