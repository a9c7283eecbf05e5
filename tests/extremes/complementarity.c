/* complementarity - how far a pressure is from solving its contact problem
 *
 *	complementarity free|periodic NX NY DX DY ESTAR APPROACH HARDNESS <values
 *
 * Shares no code with the library.  values: height, pressure and gap of every
 * cell, rows of NX, one line each.  The displacement is summed anew: over Love's
 * closed form for a uniformly loaded cell of a half-space, or over the waves of a
 * periodic one, 2 / (E* |q|) each.  Prints two numbers: how far the gap in the
 * values is from this one, over the largest gap or displacement or that of the
 * mean pressure over a side, as rounding goes; and sum p (g - o) / sum p (u - u0),
 * o the deepest overlap, u0 the least displacement below zero.  With a hardness H
 * the sum is p g where g > 0 and (p - H) g elsewhere.
 */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double corner(double x, double y)
{
	return (x != 0 ? x * asinh(y / fabs(x)) : 0) +
	       (y != 0 ? y * asinh(x / fabs(y)) : 0);
}

static void displace_free(
	int nx, int ny, double dx, double dy, double estar, const double *p, double *u)
{
	double *love = malloc(sizeof *love * (size_t)nx * (size_t)ny);

	for (int j = 0; j < ny; j++)
		for (int i = 0; i < nx; i++) {
			double x = i * dx, y = j * dy;

			love[j * nx + i] = (corner(x + dx / 2, y + dy / 2) -
						   corner(x - dx / 2, y + dy / 2) -
						   corner(x + dx / 2, y - dy / 2) +
						   corner(x - dx / 2, y - dy / 2)) /
					   (acos(-1) * estar);
		}
	for (int k = 0; k < nx * ny; k++)
		for (int m = 0; m < nx * ny; m++)
			u[k] += p[m] *
				love[abs(k / nx - m / nx) * nx + abs(k % nx - m % nx)];
	free(love);
}

/* One direction of a discrete Fourier transform of rows by columns, along the columns. */
static void transform(int rows, int columns, int sign, double complex *a)
{
	double complex *out = calloc((size_t)columns, sizeof *out);

	for (int r = 0; r < rows; r++) {
		for (int k = 0; k < columns; k++) {
			out[k] = 0;
			for (int i = 0; i < columns; i++)
				out[k] += a[r * columns + i] *
					  cexp(sign * 2 * acos(-1) * I *
						  (double)((long)i * k % columns) /
						  columns);
		}
		memcpy(a + r * columns, out, (size_t)columns * sizeof *out);
	}
	free(out);
}

static void transpose(int rows, int columns, const double complex *a, double complex *b)
{
	for (int r = 0; r < rows; r++)
		for (int c = 0; c < columns; c++)
			b[c * rows + r] = a[r * columns + c];
}

static void displace_periodic(
	int nx, int ny, double dx, double dy, double estar, const double *p, double *u)
{
	size_t n = (size_t)nx * (size_t)ny;
	double complex *a = calloc(n, sizeof *a), *b = calloc(n, sizeof *b);

	for (size_t k = 0; k < n; k++)
		a[k] = p[k];
	transform(ny, nx, -1, a);
	transpose(ny, nx, a, b);
	transform(nx, ny, -1, b);
	for (int i = 0; i < nx; i++)
		for (int j = 0; j < ny; j++) {
			double qx = 2 * acos(-1) * (2 * i <= nx ? i : i - nx) / (nx * dx);
			double qy = 2 * acos(-1) * (2 * j <= ny ? j : j - ny) / (ny * dy);

			b[i * ny + j] *= i || j ? 2 / (estar * hypot(qx, qy)) : 0;
		}
	transform(nx, ny, 1, b);
	transpose(nx, ny, b, a);
	transform(ny, nx, 1, a);
	for (size_t k = 0; k < n; k++)
		u[k] = creal(a[k]) / (double)n;
	free(a);
	free(b);
}

int main(int argc, char **argv)
{
	double load = 0;
	int nx = argc > 8 ? atoi(argv[2]) : 0, ny = argc > 8 ? atoi(argv[3]) : 0;
	double v[9] = { 0 }, sum = 0, work = 0, least = 0, overlap = 0, wrong = 0,
	       size = 0;
	double *field[4];
	int n = nx * ny;

	if (n < 1)
		return 2;
	for (int k = 4; k < 9; k++)
		v[k] = atof(argv[k]);
	for (int f = 0; f < 4; f++)
		field[f] = calloc((size_t)n, sizeof(double));
	double *h = field[0], *p = field[1], *g = field[2], *u = field[3];

	for (int k = 0; k < n; k++)
		if (scanf("%lf %lf %lf", &h[k], &p[k], &g[k]) != 3)
			return 1;
	(strcmp(argv[1], "free") ? displace_periodic : displace_free)(
		nx, ny, v[4], v[5], v[6], p, u);
	for (int k = 0; k < n; k++) {
		double gap = u[k] - h[k] - v[7];

		load += p[k];
		least = fmin(least, u[k]);
		size = fmax(size, fmax(fabs(u[k]), fabs(gap)));
		wrong = fmax(wrong, fabs(gap - g[k]));
		overlap = fmin(overlap, gap);
		if (p[k] < 0 || (v[8] > 0 && p[k] > v[8] * (1 + 1e-12)))
			return 1;
	}
	for (int k = 0; k < n; k++) {
		double gap = u[k] - h[k] - v[7];

		if (v[8] > 0)
			sum += gap > 0 ? p[k] * gap : (p[k] - v[8]) * gap;
		else
			sum += p[k] * (gap - overlap);
		work += p[k] * (u[k] - least);
	}
	size = fmax(size, load / n * fmax(nx * v[4], ny * v[5]) / v[6]);
	printf("%.3g %.3g\n", wrong / size, sum == 0 ? 0 : sum / work);
	return 0;
}
