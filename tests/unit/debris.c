/* One step of wear: particles and surface agree on the lost volume under both rules,
 * and previous steps have no influence. */
#include "debris/debris.h"
#include "num/philox.h"
#include "tap.h"

#include <stdlib.h>
#include <string.h>

enum { NX = 40, NY = 28, CELLS = NX * NY };

static struct debris_par plain(enum wear_rule rule)
{
	struct debris_par par = { .yield = 1e8,
		.rule = rule,
		.stress = { .nx = NX,
			.ny = NY,
			.dx = 2e-6,
			.dy = 1e-6,
			.nu = 0.3,
			.mu = 0.3 } };

	return par;
}

/* Some loaded cells, away from the rim. */
static void press(double *p, int seed)
{
	memset(p, 0, CELLS * sizeof *p);
	for (int k = 0; k < 25; k++) {
		int x = 6 + (int)(28 * philox_uniform((uint64_t)seed, 0, RNG_NOISE,
					       3 * (uint64_t)k));
		int y = 6 + (int)(16 * philox_uniform((uint64_t)seed, 0, RNG_NOISE,
					       3 * (uint64_t)k + 1));

		p[y * NX + x] = 1e9 * philox_uniform((uint64_t)seed, 0, RNG_NOISE,
					      3 * (uint64_t)k + 2);
	}
}

/* Loads in one corner.  Beyond the border each stretch stands for the integral of the
 * depth over its height, on either side that it has there; a periodic grid has no border.
 */
static void test_beyond(enum wear_rule rule, const char *name)
{
	struct debris_par par = plain(rule);
	struct debris *d = debris_new(&par);
	double p[CELLS] = { 0 }, want = 0;
	struct debris_step step;

	for (int y = 0; y < 3; y++)
		for (int x = 0; x < 3; x++)
			p[(NY - 1 - y) * NX + x] = 1e9;
	ok(debris_step(d, NULL, p, &step) == DEBRIS_OK, "%s: a corner is loaded", name);
	for (size_t i = 0; i < step.wear.count; i++) {
		const struct stretch *s = &step.wear.stretch[i];
		double width = (s->column % NX == 0 ? 1e-6 : 0) +
			       (s->column / NX == NY - 1 ? 2e-6 : 0);

		want += width * (s->bottom * s->bottom - s->top * s->top) / 2;
	}
	ok(want > 0.05 * step.volume, "it fails at the border");
	near(step.beyond / want, 1, 1e-12, "that stands for what is lost beyond it");
	debris_free(d);
	par.stress.periodic = 1;
	d = debris_new(&par);
	ok(debris_step(d, NULL, p, &step) == DEBRIS_OK && step.beyond == 0,
		"nothing is lost beyond a periodic grid");
	debris_free(d);
}

static void test_balance(enum wear_rule rule, const char *name)
{
	struct debris_par par = plain(rule);
	struct debris *d = debris_new(&par);
	double p[CELLS], h[CELLS] = { 0 }, lost = 0, particles = 0;
	struct debris_step step;

	press(p, 1);
	enum debris_status status = debris_step(d, h, p, &step);

	ok(status == DEBRIS_OK && step.count > 1, "%s: %zu particles come loose", name,
		step.count);
	for (int i = 0; i < CELLS; i++)
		lost -= h[i] * 2e-12;
	for (size_t i = 0; i < step.count; i++)
		particles += step.particle[i].volume;
	near(lost / step.volume, 1, 1e-12, "the surface has lost the worn volume");
	near(particles / step.volume, 1, 1e-12, "the particles have the worn volume");
	debris_free(d);
}

/* The actual set lies within the potential one. */
static void test_rules(void)
{
	double p[CELLS], h[2][CELLS] = { { 0 } };
	int outside = 0, fewer = 0;

	press(p, 2);
	for (int rule = 0; rule < 2; rule++) {
		struct debris_par par = plain((enum wear_rule)rule);
		struct debris *d = debris_new(&par);
		struct debris_step step;

		debris_step(d, h[rule], p, &step);
		debris_free(d);
	}
	for (int i = 0; i < CELLS; i++) {
		double less = h[WEAR_COLUMN][i] - h[WEAR_POTENTIAL][i];

		outside += less < 1e-9 * h[WEAR_COLUMN][i];
		fewer += less > -1e-9 * h[WEAR_POTENTIAL][i];
	}
	ok(outside == 0 && fewer > 0,
		"columns lose at most the material that failed, and some lose less");
}

/* Depths are equal but for rounding, and as many columns are worn. */
static int differs(double a, double b)
{
	return (a != 0) != (b != 0) || fabs(a - b) > 1e-10 * fabs(a);
}

/* Turned by a quarter with its shear, or mirrored across it, the scene stays the same. */
static void test_symmetry(void)
{
	struct debris_par par = plain(WEAR_COLUMN), turned = par;
	struct debris *d = debris_new(&par), *e;
	double p[CELLS], q[CELLS], h[CELLS] = { 0 }, g[CELLS] = { 0 };
	struct debris_step step;
	int bad = 0;

	turned.stress.nx = NY, turned.stress.ny = NX;
	turned.stress.dx = par.stress.dy, turned.stress.dy = par.stress.dx;
	turned.stress.axis = 1;
	press(p, 3);
	for (int i = 0; i < CELLS; i++)
		q[i % NX * NY + i / NX] = p[i];
	e = debris_new(&turned);
	debris_step(d, h, p, &step);
	debris_step(e, g, q, &step);
	for (int i = 0; i < CELLS; i++)
		bad += differs(h[i], g[i % NX * NY + i / NX]);
	ok(bad == 0 && step.count > 0, "exchanging x and y gives the same wear");
	memset(g, 0, sizeof(g));
	for (int i = 0; i < CELLS; i++)
		q[(NY - 1 - i / NX) * NX + i % NX] = p[i];
	debris_step(d, g, q, &step);
	for (int i = 0; i < CELLS; i++)
		bad += differs(h[i], g[(NY - 1 - i / NX) * NX + i % NX]);
	ok(bad == 0, "a scene mirrored across the shear gives the same wear");
	memset(g, 0, sizeof(g));
	for (int i = 0; i < CELLS; i++)
		q[i / NX * NX + NX - 1 - i % NX] = p[i];
	debris_step(d, g, q, &step);
	for (int i = 0; i < CELLS; i++)
		bad += h[i] != g[i / NX * NX + NX - 1 - i % NX];
	ok(bad > 0, "a scene mirrored along the shear gives another wear");
	debris_free(d);
	debris_free(e);
}

/* On a periodic grid of even size a scene that is mirrored across the shear, exchanged
 * with it, or moved loses the mirrored, exchanged, moved cells; the pressure has waves up
 * to the shortest. */
static void test_periodic_symmetry(void)
{
	struct debris_par par = plain(WEAR_COLUMN), turned;
	double p[CELLS], q[CELLS], h[CELLS] = { 0 }, g[CELLS] = { 0 };
	struct debris *d, *e;
	struct debris_step step;
	int mirrored = 0, exchanged = 0, moved = 0, lost = 0;

	par.stress.periodic = 1;
	turned = par;
	turned.stress.nx = NY, turned.stress.ny = NX;
	turned.stress.dx = par.stress.dy, turned.stress.dy = par.stress.dx;
	turned.stress.axis = 1;
	d = debris_new(&par);
	e = debris_new(&turned);
	for (int i = 0; i < CELLS; i++) {
		double u = philox_uniform(9, 0, RNG_NOISE, (uint64_t)i);

		p[i] = u < 0.3 ? 1e9 * u : 0;
	}
	debris_step(d, h, p, &step);
	for (int i = 0; i < CELLS; i++)
		q[(NY - 1 - i / NX) * NX + i % NX] = p[i];
	debris_step(d, g, q, &step);
	for (int i = 0; i < CELLS; i++) {
		lost += h[i] != 0;
		mirrored += differs(h[i], g[(NY - 1 - i / NX) * NX + i % NX]);
	}
	memset(g, 0, sizeof(g));
	for (int i = 0; i < CELLS; i++)
		q[i % NX * NY + i / NX] = p[i];
	debris_step(e, g, q, &step);
	for (int i = 0; i < CELLS; i++)
		exchanged += differs(h[i], g[i % NX * NY + i / NX]);
	memset(g, 0, sizeof(g));
	for (int i = 0; i < CELLS; i++)
		q[(i / NX + 5) % NY * NX + (i % NX + 11) % NX] = p[i];
	debris_step(d, g, q, &step);
	for (int i = 0; i < CELLS; i++)
		moved += differs(h[i], g[(i / NX + 5) % NY * NX + (i % NX + 11) % NX]);
	ok(lost > 20 && lost < CELLS, "periodic: %d of %d columns lose cells", lost,
		CELLS);
	ok(mirrored == 0,
		"periodic: the mirrored scene loses the mirrored cells (%d differ)",
		mirrored);
	ok(exchanged == 0,
		"periodic: x and y exchanged lose the exchanged cells (%d differ)",
		exchanged);
	ok(moved == 0, "periodic: a moved scene loses the moved cells (%d differ)",
		moved);
	debris_free(d);
	debris_free(e);
}

/* Previous surfaces do not change the bits of a result. */
static void test_history(void)
{
	struct debris_par par = plain(WEAR_POTENTIAL);
	struct debris *d = debris_new(&par);
	double p[CELLS], h[CELLS], g[CELLS];
	struct debris_step step;
	int bad = 0;

	for (int seed = 4; seed < 10; seed++) {
		struct debris *e = debris_new(&par);

		memset(h, 0, sizeof(h));
		memset(g, 0, sizeof(g));
		press(p, seed);
		debris_step(d, h, p, &step);
		bad += step.count == 0;
		debris_step(e, g, p, &step);
		bad += memcmp(h, g, sizeof(h)) != 0;
		debris_free(e);
	}
	ok(bad == 0, "six surfaces in a row give the same bits as each alone");
	debris_free(d);
}

/* Pressure of a ball on an odd grid: p0 is 4 times yield, its radius a third of the side.
 */
static double hertz_volume(int n, double cell, double offset, enum wear_rule rule)
{
	double *p = calloc((size_t)n * (size_t)n, sizeof *p),
	       *h = calloc((size_t)n * (size_t)n, sizeof *h);
	struct debris_par par = { .yield = 0.25,
		.rule = rule,
		.cell = cell,
		.offset = offset,
		.stress = { .nx = n,
			.ny = n,
			.dx = 3. / n,
			.dy = 3. / n,
			.nu = 0.3,
			.mu = 0.4 } };
	struct debris *d = debris_new(&par);
	struct debris_step step;

	for (int i = 0; i < n * n; i++) {
		double x = (i % n + 0.5) * 3 / n - 1.5, y = (i / n + 0.5) * 3 / n - 1.5;

		p[i] = sqrt(fmax(0, 1 - x * x - y * y));
	}
	debris_step(d, h, p, &step);
	debris_free(d);
	free(p);
	free(h);
	return step.volume;
}

/* Cells that shrink tend to the depth that is interpolated, which hardly depends on the
 * grid. */
static void test_depth(enum wear_rule rule, const char *name)
{
	double grid = hertz_volume(45, 0, 0, rule), fine = hertz_volume(90, 0, 0, rule);
	double h = 3. / 45, top = hertz_volume(45, h, 0, rule),
	       cells = hertz_volume(45, h / 16, 0.5, rule);

	near(cells / grid, 1, 0.006, name);
	ok(fabs(fine / grid - 1) < 0.02, "half the spacing changes the volume by %.2g %%",
		100 * (fine / grid - 1));
	ok(top / grid > 1.02 && top / grid < 1.06,
		"cells as high as the spacing overestimate the volume by half a layer (%.3f)",
		top / grid);
}

static void test_refusals(void)
{
	struct debris_par par = plain(WEAR_COLUMN);
	struct debris *d = debris_new(&par);
	double p[CELLS] = { 0 }, h[CELLS] = { 0 };
	struct debris_step step;
	int changed = 0;

	p[300] = -1;
	ok(debris_step(d, h, p, &step) == DEBRIS_PULL, "a negative pressure is refused");
	p[300] = NAN;
	ok(debris_step(d, h, p, &step) == DEBRIS_NUMBERS,
		"a pressure that is not a number is refused");
	p[300] = 1e30;
	ok(debris_step(d, h, p, &step) == DEBRIS_DEEP,
		"material without strength is refused");
	for (int i = 0; i < CELLS; i++)
		changed += h[i] != 0;
	ok(changed == 0, "a refused step does not change the surface");
	p[300] = 1e9;
	ok(debris_step(d, h, p, &step) == DEBRIS_OK && step.count == 1,
		"the step after a refused one is right");
	debris_free(d);
	par.yield = 0;
	ok(!debris_new(&par), "a yield stress of zero is refused");
}

int main(void)
{
	test_beyond(WEAR_COLUMN, "columns");
	test_balance(WEAR_COLUMN, "columns");
	test_beyond(WEAR_POTENTIAL, "all that fails");
	test_balance(WEAR_POTENTIAL, "all that fails");
	test_rules();
	test_symmetry();
	test_periodic_symmetry();
	test_history();
	test_depth(WEAR_COLUMN,
		"column: cells of 1/16 of the spacing lose the volume interpolated");
	test_depth(WEAR_POTENTIAL,
		"potential: cells of 1/16 of the spacing lose all that fails");
	test_refusals();
	return tap_done();
}
