#include "stress/influence.h"
#include "stress/stress_state.h"
#include "stress/window.h"
#include "num/fft.h"
#include <stdlib.h>

static int round_up(int n, int step, int most)
{
	n = (n + step - 1) / step * step;
	return n < most ? n : most;
}

static struct part whole_grid(const struct stress *s)
{
	return (struct part){ .wx = s->par.nx, .wy = s->par.ny };
}

struct part stress_part(
	const struct stress *s, const struct stress_span *span, size_t count)
{
	int nx = s->par.nx, ny = s->par.ny;
	int x0 = s->x0, x1 = s->x1, y0 = s->y0, y1 = s->y1;
	struct part p = { 0 };

	if (s->nloads == 0)
		return whole_grid(s);
	for (size_t i = 0; i < count; i++) {
		x0 = span[i].begin < x0 ? span[i].begin : x0;
		x1 = larger(x1, span[i].end - 1);
		y0 = span[i].y < y0 ? span[i].y : y0;
		y1 = larger(y1, span[i].y);
	}
	p.wx = s->par.periodic ? nx : round_up(x1 - x0 + 1, larger(nx / 8, 8), nx);
	p.wy = s->par.periodic ? ny : round_up(y1 - y0 + 1, larger(ny / 8, 8), ny);
	p.x0 = x0 + p.wx < nx ? x0 : nx - p.wx;
	p.y0 = y0 + p.wy < ny ? y0 : ny - p.wy;
	return p;
}

/* The window of this size, from those kept or in place of the one not used for longest,
 * with the pressure loaded; NULL when out of memory. */
static struct part *open_part(struct stress *s, struct part want)
{
	struct part *p = &s->part[0];

	if (!s->sums)
		s->sums = malloc((size_t)s->par.nx * s->par.ny * TENSOR_NUMBERS *
				 sizeof(*s->sums));
	if (!s->sums)
		return NULL;
	for (int i = 0; i < WINDOWS; i++) {
		struct part *q = &s->part[i];

		if (q->window && q->wx == want.wx && q->wy == want.wy) {
			p = q;
			break;
		}
		if (q->used < p->used)
			p = q;
	}
	if (!p->window || p->wx != want.wx || p->wy != want.wy) {
		window_free(p->window);
		*p = want;
		p->window = window_new(&s->par, p->wx, p->wy);
	}
	if (p->window && !(p->loaded && p->x0 == want.x0 && p->y0 == want.y0)) {
		window_load(p->window, s->pressure, want.x0, want.y0);
		p->x0 = want.x0;
		p->y0 = want.y0;
		p->loaded = 1;
		s->work.transforms++;
	}
	p->used = ++s->clock;
	return p->window ? p : NULL;
}

static double complex *spectra_new(
	struct stress *s, const struct part *p, long layer, int count)
{
	double complex *out = fft_alloc_complex(count * window_size(p->window));

	if (out && window_spectra(p->window, stress_depth(s, layer), count, out)) {
		fft_free(out);
		return NULL;
	}
	if (!s->par.periodic) {
		s->work.transforms += count;
		s->work.kernel_cells += (double)p->wx * p->wy;
	}
	return out;
}

/* Spectra of the first count numbers of a layer for this window, kept if there is room.
 */
static struct layer *layer_spectra(
	struct stress *s, const struct part *p, long layer, int count)
{
	struct layer *l = layer < LAYERS_KEPT ? &s->layers[layer] : &s->spare;
	size_t bytes = count * window_size(p->window) * sizeof(*l->spectra);

	if (l->spectra && l->sx == p->wx && l->sy == p->wy && l->count >= count)
		return l;
	if (l->spectra) {
		s->used -= l->bytes;
		fft_free(l->spectra);
		l->spectra = NULL;
	}
	if (l == &s->spare || !stress_claim(s, bytes)) {
		l = &s->spare;
		stress_layer_free(l);
	}
	l->spectra = spectra_new(s, p, layer, count);
	l->sx = p->wx;
	l->sy = p->wy;
	l->count = count;
	l->bytes = bytes;
	return l->spectra ? l : NULL;
}

static void sum_numbers(
	struct stress *s, const struct part *p, const double complex *spectra, int count)
{
	size_t n = (size_t)p->wx * p->wy;

	for (int c = 0; c < count; c++)
		window_sum(p->window, spectra, c, s->sums + c * n);
	s->work.transforms += count;
	s->work.fourier_layers++;
}

int stress_mises_fourier(struct stress *s, long layer, struct part want, double *mises)
{
	struct part *p = open_part(s, want);
	struct layer *l = p ? layer_spectra(s, p, layer, MISES_NUMBERS) : NULL;
	size_t n = (size_t)want.wx * want.wy;

	if (!l)
		return -1;
	sum_numbers(s, p, l->spectra, MISES_NUMBERS);
	if (l == &s->spare)
		stress_layer_free(l);
	for (size_t i = 0; i < n; i++) {
		size_t x = p->x0 + i % p->wx, y = p->y0 + i / p->wx;
		double v[MISES_NUMBERS];

		for (int c = 0; c < MISES_NUMBERS; c++)
			v[c] = s->sums[c * n + i];
		mises[y * s->par.nx + x] = s->unit * influence_mises(v);
	}
	return 0;
}

int stress_waves_may_fail(struct stress *s, double z, double limit)
{
	struct part *p = open_part(s, whole_grid(s));

	/* Out of memory: the layer itself will tell. */
	return !p || window_bound(p->window, z) > limit;
}

int stress_tensor(struct stress *s, long layer, double *tensor)
{
	static const enum stress_component place[TENSOR_NUMBERS] = { [DEV_X] = STRESS_XX,
		[DEV_Y] = STRESS_YY,
		[DEV_XY] = STRESS_XY,
		[DEV_XZ] = STRESS_XZ,
		[DEV_YZ] = STRESS_YZ,
		[DEV_ZZ] = STRESS_ZZ };
	size_t n = (size_t)s->par.nx * s->par.ny;
	struct part *p = open_part(s, whole_grid(s));
	struct layer *l = p ? layer_spectra(s, p, layer, TENSOR_NUMBERS) : NULL;

	if (!l)
		return -1;
	sum_numbers(s, p, l->spectra, TENSOR_NUMBERS);
	if (l == &s->spare)
		stress_layer_free(l);
	for (int c = 0; c < TENSOR_NUMBERS; c++)
		for (size_t i = 0; i < n; i++) {
			double zz =
				c == DEV_X || c == DEV_Y ? s->sums[DEV_ZZ * n + i] : 0;

			tensor[place[c] * n + i] = s->unit * (s->sums[c * n + i] + zz);
		}
	s->work.nodes += (double)n;
	return 0;
}
