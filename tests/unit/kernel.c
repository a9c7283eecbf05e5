/* Love's coefficients against 50-digit values and the closed form in long double. */
#include "contact/kernel.h"
#include "tap.h"

/* I of a cell dx * dy at (m dx, n dy), from 50-digit evaluation of the corner sum. */
static const struct {
	double dx, dy, m, n, i;
} golden[] = {
	{ 1, 1, 0, 0, 3.5254943480781721 },
	{ 1, 1, 1, 0, 1.0380497359047561 },
	{ 1, 1, 0, 1, 1.0380497359047561 },
	{ 1, 1, 1, 1, 0.724697438134329947 },
	{ 1, 1, 2, 0, 0.505091983075117499 },
	{ 1, 1, 2, 1, 0.451088988349219848 },
	{ 1, 1, 3, 2, 0.278258815588361196 },
	{ 1, 1, 5, 0, 0.200332161527130118 },
	{ 1, 1, 8, 8, 0.0884171986772396224 },
	{ 1, 1, 16, 5, 0.0596638459796261958 },
	{ 1, 1, 64, 0, 0.015625158942323859 },
	{ 1, 1, 64, 64, 0.0110485996542388136 },
	{ 1, 1, 127, 0, 0.00787403608916917536 },
	{ 1, 1, 127, 127, 0.00556777712239797758 },
	{ 1, 1, 255, 255, 0.00277296865779141801 },
	{ 1, 1, 511, 0, 0.00195694747469348608 },
	{ 1, 1, 511, 511, 0.00138377071937875337 },
	{ 1, 1, 1023, 1, 0.000977516678440458556 },
	{ 1, 1, 2047, 2047, 0.000345435654471039316 },
	{ 1, 0.5, 0, 0, 2.40605912529801724 },
	{ 1, 0.5, 1, 0, 0.540574014481350876 },
	{ 1, 0.5, 0, 1, 0.929451330513725717 },
	{ 1, 0.5, 1, 1, 0.468016890151470322 },
	{ 1, 0.5, 2, 0, 0.254678292514663191 },
	{ 1, 0.5, 2, 1, 0.246471482751609783 },
	{ 1, 0.5, 3, 2, 0.159127756969314032 },
	{ 1, 0.5, 5, 0, 0.100292884271677893 },
	{ 1, 0.5, 8, 8, 0.0559395855818772938 },
	{ 1, 0.5, 16, 5, 0.0308837008743902993 },
	{ 1, 0.5, 64, 0, 0.00781263908103641912 },
	{ 1, 0.5, 64, 64, 0.00698778635677780125 },
	{ 1, 0.5, 127, 0, 0.00393702567272256151 },
	{ 1, 0.5, 127, 127, 0.00352137635449407781 },
	{ 1, 0.5, 255, 255, 0.00175377997461963685 },
	{ 1, 0.5, 511, 0, 0.000978473854447020288 },
	{ 1, 0.5, 511, 511, 0.000875173521948318942 },
	{ 1, 0.5, 1023, 1, 0.000488758528950288164 },
	{ 1, 0.5, 2047, 2047, 0.000218472691805006366 },
};

static long double corner(long double x, long double y)
{
	return (x == 0 ? 0 : x * asinhl(y / fabsl(x))) +
	       (y == 0 ? 0 : y * asinhl(x / fabsl(y)));
}

static double closed_form(double dx, double dy, double x, double y)
{
	long double x1 = x - (long double)dx / 2, x2 = x + (long double)dx / 2;
	long double y1 = y - (long double)dy / 2, y2 = y + (long double)dy / 2;

	return (double)(corner(x2, y2) - corner(x2, y1) - corner(x1, y2) +
			corner(x1, y1));
}

/* Largest relative error along a ray of cells out to distance r (in the long side);
 * the reference itself is good to 5e-20 r^2 dx / dy. */
static double worst_along(double dx, double dy, int sx, int sy, int cells)
{
	double worst = 0;

	for (int i = 0; i < cells; i++) {
		double x = i * sx * dx, y = i * sy * dy, want = closed_form(dx, dy, x, y);

		worst = tap_max(worst, fabs(kernel_patch(dx, dy, x, y) / want - 1));
	}
	return worst;
}

/* Solves a small system by elimination. */
static void eliminate(int n, double a[6][7])
{
	for (int k = 0; k < n; k++) {
		int best = k;

		for (int i = k; i < n; i++)
			if (fabs(a[i][k]) > fabs(a[best][k]))
				best = i;
		for (int j = 0; j <= n; j++) {
			double swap = a[k][j];

			a[k][j] = a[best][j];
			a[best][j] = swap;
		}
		for (int i = 0; i < n; i++)
			for (int j = n; i != k && j >= k; j--)
				a[i][j] -= a[i][k] / a[k][k] * a[k][j];
	}
}

/* One of the solutions of plane strain that vary as a wave along x, of unit wave
 * number: ux = -U sin x, uz = W cos x with W = e^(s z) or z e^(s z), s = -1 or 1, and the
 * U that equilibrium asks for.  col: ux and uz over their waves, sigma_xz, sigma_zz. */
static void wave_part(double g, double nu, int s, int grows, double z, double col[4])
{
	double e = exp(s * z), w = grows ? z : 1, dw = grows ? 1 + s * z : s;
	double u = grows ? s * z + 3 - 4 * nu : s, du = grows ? s + s * u : 1;

	col[0] = -u * e;
	col[1] = w * e;
	col[2] = g * (-du - w) * e;
	col[3] = 2 * g / (1 - 2 * nu) * ((1 - nu) * dw - nu * u) * e;
}

static void coated(void)
{
	double worst = 0, deep = 0, thin = 0, same = 0;

	for (int k = 0; k < 200; k++) {
		struct kernel_coating c = { .thickness = pow(10, -2 + 3 * (k % 20) / 19.),
			.young = pow(10, -2 + 4 * (k / 20) / 9.),
			.poisson = 0.1 + 0.03 * (k % 11),
			.base_young = 1,
			.base_poisson = 0.05 + 0.05 * (k % 9) };
		struct contact_kernel kernel = kernel_coated(&c);
		double t = c.thickness, g = c.young / (2 * (1 + c.poisson));
		double base = c.base_young / (2 * (1 + c.base_poisson));
		double a[6][7] = { { 0 } }, col[4], u = 0, v;

		/* Layer: four parts; below: the two that decay.  sigma_zz = -1 and no
		 * shear above, all four continuous below. */
		for (int part = 0; part < 4; part++) {
			wave_part(g, c.poisson, part < 2 ? -1 : 1, part % 2, 0, col);
			a[0][part] = col[2];
			a[1][part] = col[3];
			wave_part(g, c.poisson, part < 2 ? -1 : 1, part % 2, t, col);
			for (int i = 0; i < 4; i++)
				a[2 + i][part] = col[i];
		}
		for (int part = 0; part < 2; part++) {
			wave_part(base, c.base_poisson, -1, part, t, col);
			for (int i = 0; i < 4; i++)
				a[2 + i][4 + part] = -col[i];
		}
		a[1][6] = -1;
		eliminate(6, a);
		for (int part = 0; part < 4; part++) {
			wave_part(g, c.poisson, part < 2 ? -1 : 1, part % 2, 0, col);
			u += col[1] * a[part][6] / a[part][part];
		}
		v = kernel.wave(kernel.context, 1);
		worst = tap_max(worst, fabs(v / u - 1));
		c.thickness = 40;
		deep = tap_max(deep, fabs(kernel.wave(&c, 1) * c.young /
						     (2 * (1 - c.poisson * c.poisson)) -
					     1));
		c.thickness = 1e-9;
		thin = tap_max(thin,
			fabs(kernel.wave(&c, 1) /
					(2 * (1 - c.base_poisson * c.base_poisson)) -
				1));
		c.thickness = t;
		c.young = c.base_young;
		c.poisson = c.base_poisson;
		same = tap_max(same,
			fabs(kernel.wave(&c, 1) / (2 * (1 - c.poisson * c.poisson)) - 1));
	}
	ok(worst < 1e-9,
		"the wave factor of a coating solves the layered equations to %.1e",
		worst);
	ok(deep < 1e-12, "a thick coating is a half-space of its own, to %.1e", deep);
	ok(thin < 1e-6, "a thin coating is the half-space below, to %.1e", thin);
	ok(same < 1e-14,
		"a coating of the substrate's material makes no difference, to %.1e",
		same);
}

int main(void)
{
	static const double aspects[] = { 1, 1.5, 3, 100 }, estar = 4;
	struct contact_kernel half = kernel_halfspace(&estar);
	double worst = 0;

	for (size_t k = 0; k < sizeof(golden) / sizeof(golden[0]); k++) {
		double got = kernel_patch(golden[k].dx, golden[k].dy,
			golden[k].m * golden[k].dx, golden[k].n * golden[k].dy);

		worst = tap_max(worst, fabs(got / golden[k].i - 1));
	}
	ok(worst < 2e-15, "the coefficients are Love's: relative error %.1e", worst);
	for (size_t k = 0; k < sizeof(aspects) / sizeof(aspects[0]); k++) {
		double a = aspects[k], e = worst_along(a, 1, 1, 0, 50);

		e = tap_max(e, worst_along(a, 1, 0, 1, 500));
		e = tap_max(e, worst_along(a, 1, 1, 1, 50));
		e = tap_max(e, worst_along(1, a, 1, 0, 500));
		ok(e < 4e-15,
			"the coefficients of cells 1:%g are right along rows, columns and the diagonal: relative error %.1e",
			a, e);
	}
	near((kernel_patch_along(1, 3, 2, 5) + kernel_patch_along(3, 1, 5, 2)) /
			kernel_patch(1, 3, 2, 5),
		1, 1e-13, "the parts along x and y are the whole");
	near(kernel_patch(1, 1, 0, 0), 4 * asinh(1), 1e-15,
		"the coefficient under its own square cell is 4 asinh 1");
	near(kernel_patch(2, 1, -6, 3) / kernel_patch(2, 1, 6, 3), 1, 1e-15,
		"the coefficients are even in x and y");
	near(kernel_modulus(210e9, 0.3, 210e9, 0.3) / (210e9 / 1.82), 1, 1e-15,
		"the contact modulus of two like steels is E / 1.82");
	near(kernel_modulus(210e9, 0.3, INFINITY, 0.3) / (210e9 / 0.91), 1, 1e-15,
		"the contact modulus against a rigid body is E / 0.91");
	near(kernel_modulus(1, 0, 1e6, 0), 1 / (1 + 1e-6), 1e-15,
		"a body a million times stiffer acts as a rigid one");
	near(half.wave(half.context, 5), 0.1, 1e-17, "the wave factor is 2 / (E* q)");
	coated();
	return tap_done();
}
