#include "stress/window.h"
#include "num/fft.h"

#include <stdlib.h>
#include <string.h>

struct window {
	int mx, my, reach_x, reach_y;
	size_t px, py; /* padded points */
	struct fft *fft;
	double *plane;
	double complex *image; /* of the loads */
	double complex *product;
};

struct window *window_new(int mx, int my, int reach_x, int reach_y)
{
	struct window *w = calloc(1, sizeof *w);
	size_t spectrum;

	if (!w)
		return NULL;
	*w = (struct window){
		.mx = mx, .my = my, .reach_x = reach_x, .reach_y = reach_y
	};
	w->px = fft_good_size((size_t)mx + (size_t)reach_x);
	w->py = fft_good_size((size_t)my + (size_t)reach_y);
	spectrum = (w->px / 2 + 1) * w->py;
	w->plane = fft_alloc(w->px * w->py);
	w->image = fft_alloc_complex(spectrum);
	w->product = fft_alloc_complex(spectrum);
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

void window_load(struct window *w, const double *load, size_t stride)
{
	memset(w->plane, 0, w->px * w->py * sizeof *w->plane);
	for (int y = 0; y < w->my; y++)
		memcpy(w->plane + (size_t)y * w->px, load + (size_t)y * stride,
			(size_t)w->mx * sizeof *w->plane);
	fft_forward(w->fft, w->plane, w->image);
}

/* A kernel on the plane, negative offsets wrapped around.  On a line of symmetry what
 * is odd across it vanishes. */
static void put_kernel(struct window *w, const struct influence_par *par,
	const struct influence *kernel, enum stress_number number)
{
	double normal[4], shear[4]; /* signs of the mirror images, shear times mu */

	for (int m = 0; m < 4; m++) {
		int odd = ((m & 1) && influence_odd(number, 0)) ^
			  ((m >> 1) && influence_odd(number, 1));

		normal[m] = odd ? -1 : 1;
		shear[m] = (odd ^ (par->axis ? m >> 1 : m & 1)) ? -par->mu : par->mu;
	}
	memset(w->plane, 0, w->px * w->py * sizeof *w->plane);
	for (int j = 0; j <= w->reach_y; j++)
		for (int i = 0; i <= w->reach_x; i++, kernel++) {
			double n = kernel->normal[number], s = kernel->shear[number];
			double share = (i ? 1 : 0.5) * (j ? 1 : 0.5);

			for (int m = 0; m < 4; m++) {
				size_t x = (m & 1) && i ? w->px - (size_t)i : (size_t)i;
				size_t y = (m >> 1) && j ? w->py - (size_t)j : (size_t)j;

				w->plane[y * w->px + x] +=
					share * (normal[m] * n + shear[m] * s);
			}
		}
}

void window_sum(struct window *w, const struct influence_par *par,
	const struct influence *kernel, enum stress_number number, double *out,
	size_t stride)
{
	double scale = 1. / ((double)w->px * (double)w->py);
	size_t n = (w->px / 2 + 1) * w->py;

	put_kernel(w, par, kernel, number);
	fft_forward(w->fft, w->plane, w->product);
	for (size_t i = 0; i < n; i++)
		w->product[i] = scale * (w->product[i] * w->image[i]);
	fft_inverse(w->fft, w->product, w->plane);
	for (int y = 0; y < w->my; y++)
		memcpy(out + (size_t)y * stride, w->plane + (size_t)y * w->px,
			(size_t)w->mx * sizeof *out);
}
