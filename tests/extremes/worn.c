/* worn - the volume worn under a pressure by the column rule, by sums that share nothing
 * with lib/: the point loads of Boussinesq and Cerruti (Johnson, Contact Mechanics, 3.19
 * and 3.76, the shear xy of the first with the 2 x y that equilibrium requires) are
 * integrated over the pressure, which is bilinear between the centres of the cells
 *
 * usage: worn NX NY DX DY POISSON FRICTION YIELD <PRESSURES
 *
 * Prints the volume, the number of columns and the greatest depth.  A cell wears from the
 * surface down to the first depth at which the von Mises stress falls to the yield
 * stress.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static int nx, ny;
static double dx, dy, nu, mu, yield, *p;

/* Stress by a load of 1 under pressure and mu along x, times 2 pi: xx, yy, zz, xy, xz,
 * yz. */
static void add_load(double x, double y, double z, double load, double s[6])
{
	double r = sqrt(x * x + y * y + z * z), r2 = x * x + y * y, k = 1 - 2 * nu,
	       d = r + z;
	double r3 = r * r * r, r5 = r3 * r * r, f = 3 / r5;
	double a = 1 / (r * d) / r2, b = z / (r2 * r3); /* (1 - z / r) / r2^2 and so on */
	double c = 1 / (r * d * d), e = 1 / (r3 * d * d) + 2 / (r * r * d * d * d);

	s[0] += load * (k * (a * (x * x - y * y) + b * y * y) - f * z * x * x);
	s[1] += load * (k * (a * (y * y - x * x) + b * x * x) - f * z * y * y);
	s[2] -= load * f * z * z * z;
	s[3] += load * (k * (2 * a - b) * x * y - f * x * y * z);
	s[4] -= load * f * x * z * z;
	s[5] -= load * f * y * z * z;
	load *= mu;
	s[0] += load * x * (k * (1 / r3 - 3 * c + e * x * x) - f * x * x);
	s[1] += load * x * (k * (1 / r3 - c + e * y * y) - f * y * y);
	s[2] -= load * f * x * z * z;
	s[3] += load * y * (k * (e * x * x - c) - f * x * x);
	s[4] -= load * f * x * x * z;
	s[5] -= load * f * x * y * z;
}

/* Over a rectangle in the quadrant between a centre and its neighbours, where the
 * pressure falls linearly each way; (x, y, z) is the node as seen from the centre.  A
 * rectangle that is not small against its distance is cut in four. */
static void add_part(
	double x, double y, double z, const double box[4], double load, double s[6])
{
	static const double node[3] = { -0.774596669241483377, 0, 0.774596669241483377 };
	static const double weight[3] = { 5. / 18, 8. / 18, 5. / 18 };
	double mx = (box[0] + box[1]) / 2, my = (box[2] + box[3]) / 2;
	double wx = box[1] - box[0], wy = box[3] - box[2], size = fmax(wx, wy);
	double away_x = fmax(fabs(x - mx) - wx / 2, 0),
	       away_y = fmax(fabs(y - my) - wy / 2, 0);

	if (size * size > away_x * away_x + away_y * away_y + z * z) {
		for (int k = 0; k < 4; k++) {
			const double part[4] = { k & 1 ? mx : box[0], k & 1 ? box[1] : mx,
				k & 2 ? my : box[2], k & 2 ? box[3] : my };

			add_part(x, y, z, part, load, s);
		}
		return;
	}
	for (int j = 0; j < 3; j++)
		for (int i = 0; i < 3; i++) {
			double u = mx + node[i] * wx / 2, v = my + node[j] * wy / 2;
			double share = (1 - fabs(u) / dx) * (1 - fabs(v) / dy);

			add_load(x - u, y - v, z,
				load * share * weight[i] * weight[j] * wx * wy, s);
		}
}

static double mises(int cx, int cy, double z)
{
	double s[6] = { 0 };

	for (int y = 0; y < ny; y++)
		for (int x = 0; x < nx; x++)
			for (int k = 0; p[y * nx + x] > 0 && k < 4; k++) {
				const double box[4] = { k & 1 ? 0 : -dx, k & 1 ? dx : 0,
					k & 2 ? 0 : -dy, k & 2 ? dy : 0 };

				add_part((cx - x) * dx, (cy - y) * dy, z, box,
					p[y * nx + x], s);
			}
	return sqrt(((s[0] - s[1]) * (s[0] - s[1]) + (s[1] - s[2]) * (s[1] - s[2]) +
			    (s[2] - s[0]) * (s[2] - s[0])) /
			       2 +
		       3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])) /
	       (2 * M_PI);
}

/* The first depth at which a column holds, 0 if it does at the surface: by steps of a
 * twentieth of the cell or of the depth, then by bisection. */
static double depth(int x, int y)
{
	double side = fmin(dx, dy), low = 1e-4 * side, high = low;

	if (mises(x, y, low) <= yield)
		return 0;
	do {
		low = high;
		high += fmax(side, low) / 20;
	} while (mises(x, y, high) > yield);
	while (high - low > 1e-5 * high) {
		double middle = (low + high) / 2;

		*(mises(x, y, middle) > yield ? &low : &high) = middle;
	}
	return high;
}

int main(int argc, char **argv)
{
	double sum = 0, most = 0;
	int columns = 0;

	if (argc != 8)
		return 2;
	nx = atoi(argv[1]), ny = atoi(argv[2]);
	dx = atof(argv[3]), dy = atof(argv[4]);
	nu = atof(argv[5]), mu = atof(argv[6]), yield = atof(argv[7]);
	p = calloc((size_t)nx * (size_t)ny, sizeof *p);
	for (int i = 0; i < nx * ny; i++)
		if (scanf("%lf", &p[i]) != 1)
			return 1;
	for (int y = 0; y < ny; y++)
		for (int x = 0; x < nx; x++) {
			double z = depth(x, y);

			sum += z;
			columns += z > 0;
			most = fmax(most, z);
		}
	printf("%.17g %d %.17g\n", sum * dx * dy, columns, most);
	free(p);
	return 0;
}
