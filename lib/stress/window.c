#include "stress/window.h"
#include "num/fft.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct window {
	const struct stress_par *par;
	int wx, wy;
	size_t px, py, columns, rows; /* points; coefficients along x, stored along y */
	struct fft *fft;
	double *plane;
	double complex *image; /* of the pressure */
	double complex *product;
};

struct window *window_new(const struct stress_par *par, int wx, int wy)
{
	struct window *w = calloc(1, sizeof(*w));

	if (!w)
		return NULL;
	w->par = par;
	w->wx = wx;
	w->wy = wy;
	w->px = par->periodic ? (size_t)wx : fft_good_size(2 * (size_t)wx - 1);
	w->py = par->periodic ? (size_t)wy : fft_good_size(2 * (size_t)wy - 1);
	w->columns = w->px / 2 + 1;
	w->rows = w->py / 2 + 1;
	w->plane = fft_alloc(w->px * w->py);
	w->image = fft_alloc_complex(w->columns * w->py);
	w->product = fft_alloc_complex(w->columns * w->py);
	w->fft = fft_new(w->px, w->py);
	if (!w->plane || !w->image || !w->product || !w->fft) {
		window_free(w);
		return NULL;
	}
	return w;
}

void window_free(struct window *w)
{
	if (!w)
		return;
	if (w->fft)
		fft_done(w->fft);
	fft_free(w->plane);
	fft_free(w->image);
	fft_free(w->product);
	free(w);
}

size_t window_size(const struct window *w)
{
	return w->columns * w->rows;
}

/* Influence of wave (i, j) of the grid.  The shortest wave along an axis of even size
 * stands for both directions, so that the mean of the two is taken. */
static void grid_wave(const struct window *w, size_t i, size_t j, double z,
	double complex number[TENSOR_NUMBERS])
{
	double ux = 2 * M_PI / (w->wx * w->par->ax), uy = 2 * M_PI / (w->wy * w->par->ay);
	int both_x = 2 * i == w->px, both_y = 2 * j == w->py, n = 0;
	double complex v[TENSOR_NUMBERS];

	memset(number, 0, TENSOR_NUMBERS * sizeof(*number));
	for (int sx = 1; sx >= (both_x ? -1 : 1); sx -= 2)
		for (int sy = 1; sy >= (both_y ? -1 : 1); sy -= 2, n++) {
			influence_wave(
				w->par, sx * (double)i * ux, sy * (double)j * uy, z, v);
			for (int c = 0; c < TENSOR_NUMBERS; c++)
				number[c] += v[c];
		}
	for (int c = 0; c < TENSOR_NUMBERS; c++)
		number[c] /= n;
}

static void periodic_spectra(
	const struct window *w, double z, int count, double complex *spectra)
{
	for (size_t j = 0; j < w->rows; j++)
		for (size_t i = 0; i < w->columns; i++) {
			double complex v[TENSOR_NUMBERS];

			grid_wave(w, i, j, z, v);
			for (int c = 0; c < count; c++)
				spectra[c * window_size(w) + j * w->columns + i] = v[c];
		}
}

int window_spectra(struct window *w, double z, int count, double complex *spectra)
{
	struct influence f;

	if (w->par->periodic) {
		periodic_spectra(w, z, count, spectra);
		return 0;
	}
	if (influence_new(&f, w->par, z, w->wx, w->wy))
		return -1;
	for (int c = 0; c < count; c++) {
		influence_plane(&f, c, w->plane, w->px, w->py);
		fft_forward(w->fft, w->plane, w->product);
		memcpy(spectra + c * window_size(w), w->product,
			window_size(w) * sizeof(*spectra));
	}
	influence_free(&f);
	return 0;
}

void window_load(struct window *w, const double *pressure, int x0, int y0)
{
	memset(w->plane, 0, w->px * w->py * sizeof(*w->plane));
	for (int y = 0; y < w->wy; y++)
		memcpy(w->plane + y * w->px,
			pressure + (size_t)(y0 + y) * w->par->nx + x0,
			w->wx * sizeof(*w->plane));
	fft_forward(w->fft, w->plane, w->image);
}

void window_sum(struct window *w, const double complex *spectra,
	enum influence_number number, double *out)
{
	const double complex *half = spectra + number * window_size(w);
	double scale = 1. / ((double)w->px * (double)w->py);
	/* Shear along x leaves the parity in y alone: K(kx, -ky) = +-K(kx, ky).  Shear
	 * along y leaves that in x, and K is that of a real function. */
	int turned = w->par->axis, odd = influence_odd(number, turned ? 0 : 1);
	double mirror = odd ? -scale : scale;

	for (size_t j = 0; j < w->py; j++) {
		const double complex *a = w->image + j * w->columns;
		const double complex *k =
			half + (j < w->rows ? j : w->py - j) * w->columns;
		double complex *to = w->product + j * w->columns;

		for (size_t i = 0; i < w->columns; i++)
			to[i] = j < w->rows ? scale * (a[i] * k[i])
				: turned    ? mirror * (a[i] * conj(k[i]))
					    : mirror * (a[i] * k[i]);
	}
	fft_inverse(w->fft, w->product, w->plane);
	for (int y = 0; y < w->wy; y++)
		memcpy(out + (size_t)y * w->wx, w->plane + y * w->px,
			w->wx * sizeof(*out));
}

/* Largest von Mises stress of a wave at its depth x = q z, by the norm of its tensor:
 * falls with x for all nu and mu. */
static double wave_bound(const struct stress_par *p, double x)
{
	double normal = 2 + 4 * p->nu * p->nu + 4 * x * x;
	double shear = 10 - 8 * x + 4 * x * x + 4 * p->nu * p->nu;

	return sqrt(1.5) * exp(-x) * (sqrt(normal) + p->mu * sqrt(shear));
}

double window_bound(const struct window *w, double z)
{
	double ux = 2 * M_PI / (w->wx * w->par->ax), uy = 2 * M_PI / (w->wy * w->par->ay);
	double complex mean[TENSOR_NUMBERS];
	double v[MISES_NUMBERS], sum;

	influence_wave(w->par, 0, 0, z, mean);
	for (int c = 0; c < MISES_NUMBERS; c++)
		v[c] = creal(mean[c] * w->image[0]);
	sum = influence_mises(v);
	for (size_t j = 0; j < w->py; j++)
		for (size_t i = j == 0; i < w->columns; i++) {
			double ky = j < w->rows ? j * uy : (w->py - j) * uy;
			int twice = i > 0 && 2 * i < w->px;

			sum += (twice + 1) * cabs(w->image[j * w->columns + i]) *
			       wave_bound(w->par, hypot(i * ux, ky) * z);
		}
	return sum / ((double)w->px * (double)w->py);
}
