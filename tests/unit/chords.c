/* Length and width of convex hulls: known bodies, and random ones by brute force. */
#include "debris/chords.h"
#include "tap.h"

enum { POINTS = 12, LEVELS = 2000 };

static void measure(const struct hull_point *point, size_t n, const double step[3],
	double *length, double *width)
{
	struct hull *h = hull_new();
	struct chords *c = chords_new();
	struct hull_point copy[POINTS];

	for (size_t i = 0; i < n; i++)
		copy[i] = point[i];
	ok(hull_build(h, copy, n) == HULL_OK &&
			chords_measure(c, h, step, length, width) == 0,
		"the hull is measured");
	chords_free(c);
	hull_free(h);
}

static void test_known(void)
{
	static const struct hull_point cube[] = { { { 0, 0, 0 } }, { { 1, 0, 0 } },
		{ { 0, 1, 0 } }, { { 1, 1, 0 } }, { { 0, 0, 1 } }, { { 1, 0, 1 } },
		{ { 0, 1, 1 } }, { { 1, 1, 1 } } };
	static const struct hull_point tetrahedron[] = { { { 0, 0, 0 } }, { { 1, 1, 0 } },
		{ { 1, 0, 1 } }, { { 0, 1, 1 } } };
	const double one[3] = { 1, 1, 1 }, box[3] = { 3, 4, 12 };
	double length, width;

	measure(cube, 8, one, &length, &width);
	near(length, sqrt(3), 1e-15, "the length of a cube is its space diagonal");
	/* The sections through three corners are triangles of that side; the hexagon half
	 * way is no wider. */
	near(width, sqrt(2), 1e-15, "the width of a cube is the diagonal of a face");
	measure(cube, 8, box, &length, &width);
	near(length, 13, 1e-14, "the length of a box of 3 by 4 by 12 is 13");
	measure(tetrahedron, 4, one, &length, &width);
	near(length, sqrt(2), 1e-15, "the length of a tetrahedron is an edge");
	near(width, sqrt(2), 1e-15, "the width of a tetrahedron is the opposite edge");
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double distance(const double a[3], const double b[3])
{
	double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };

	return sqrt(dot(d, d));
}

/* Widest section among many, cut through the lines between all points. */
static double brute_width(double (*p)[3], size_t n, const double along[3])
{
	static double cut[POINTS * POINTS][3];
	double low = INFINITY, high = -INFINITY, most = 0;

	for (size_t i = 0; i < n; i++) {
		low = fmin(low, dot(p[i], along));
		high = tap_max(high, dot(p[i], along));
	}
	for (int l = 1; l < LEVELS; l++) {
		double level = low + (high - low) * l / LEVELS;
		size_t count = 0;

		for (size_t i = 0; i < n; i++)
			for (size_t j = 0; j < n; j++) {
				double a = dot(p[i], along) - level;
				double b = dot(p[j], along) - level;

				if (!(a < 0 && b > 0))
					continue;
				for (int k = 0; k < 3; k++)
					cut[count][k] = p[i][k] +
							(p[j][k] - p[i][k]) * a / (a - b);
				count++;
			}
		for (size_t i = 0; i < count; i++)
			for (size_t j = 0; j < i; j++)
				most = tap_max(most, distance(cut[i], cut[j]));
	}
	return most;
}

/* 0 to 99, the same everywhere. */
static int number(void)
{
	static uint32_t state = 1;

	state = state * 1664525 + 1013904223;
	return (int)((state >> 16) % 100);
}

static void test_random(void)
{
	const double step[3] = { 1.5, 1, 0.25 };

	for (int trial = 0; trial < 10; trial++) {
		struct hull_point point[POINTS];
		double p[POINTS][3], along[3] = { 0 }, most = 0, length, width, brute;

		for (size_t i = 0; i < POINTS; i++)
			for (int k = 0; k < 3; k++) {
				point[i].v[k] = number();
				p[i][k] = point[i].v[k] * step[k];
			}
		measure(point, POINTS, step, &length, &width);
		for (size_t i = 0; i < POINTS; i++)
			for (size_t j = 0; j < i; j++)
				if (distance(p[i], p[j]) > most) {
					most = distance(p[i], p[j]);
					for (int k = 0; k < 3; k++)
						along[k] = (p[i][k] - p[j][k]) / most;
				}
		brute = brute_width(p, POINTS, along);
		near(length, most, 1e-12 * most,
			"the length of random points is that of brute force");
		/* The levels miss the height of the corner by half a step at the most,
		 * which changes the width by a few steps at most. */
		ok(brute <= width * (1 + 1e-12) && brute > width * (1 - 10. / LEVELS),
			"the width %g of random points is %g by brute force", width,
			brute);
	}
}

/* The largest span for which products stay below 2^63, anywhere among the integers. */
static void test_span(void)
{
	static const int32_t from[] = { 0, -(1 << 20), INT32_MIN, INT32_MAX - HULL_SPAN };
	struct hull *h = hull_new();

	for (int k = 0; k < 4; k++) {
		struct hull_point p[16];
		int n = 0;

		for (int c = 0; c < 8; c++)
			for (int inner = 0; inner < 2; inner++, n++)
				for (int a = 0; a < 3; a++)
					p[n].v[a] =
						from[k] +
						(c >> a & 1 ? HULL_SPAN - inner * (a + 1)
							    : inner * (3 - a));
		ok(hull_build(h, p, 16) == HULL_OK &&
				hull_volume6(h) == 6 * pow(HULL_SPAN, 3),
			"a cube of the largest span at %d has its volume", from[k]);
	}
	{
		struct hull_point p[4] = { { { 0, 0, 0 } }, { { HULL_SPAN + 1, 0, 0 } },
			{ { 0, 1, 0 } }, { { 0, 0, 1 } } };

		ok(hull_build(h, p, 4) == HULL_LARGE, "a larger span is refused");
	}
	hull_free(h);
}

/* Three corners of a tetrahedron are 5, 5 and less apart: the width is the longest chord
 * perpendicular to either edge of 5, in whatever order and orientation the corners come.
 */
static void test_ties(void)
{
	static const int corner[4][3] = { { 0, 0, 0 }, { 5, 0, 0 }, { 3, 4, 0 },
		{ 2, 0, 2 } };
	const double step[3] = { 1, 1, 1 }, first[3] = { 1, 0, 0 },
		     second[3] = { 0.6, 0.8, 0 };
	double p[POINTS][3], want, length, width;
	int bad = 0;

	for (int i = 0; i < 4; i++)
		for (int k = 0; k < 3; k++)
			p[i][k] = corner[i][k];
	want = tap_max(brute_width(p, 4, first), brute_width(p, 4, second));
	ok(fabs(brute_width(p, 4, first) - brute_width(p, 4, second)) > 0.1,
		"the two longest edges have different perpendicular chords");
	for (int turn = 0; turn < 4 * 8; turn++) {
		struct hull_point point[4];

		for (int i = 0; i < 4; i++)
			for (int k = 0; k < 3; k++)
				point[(i + turn / 8) % 4].v[k] =
					turn >> k & 1 ? 100 - corner[i][k] : corner[i][k];
		measure(point, 4, step, &length, &width);
		/* Sections by brute force are up to 1/LEVELS off a corner. */
		bad += length != 5 || fabs(width / want - 1) > 2. / LEVELS;
	}
	ok(bad == 0,
		"of two longest edges both count, in any order and mirrored (%d differ)",
		bad);
}

int main(void)
{
	test_span();
	test_known();
	test_random();
	test_ties();
	return tap_done();
}
