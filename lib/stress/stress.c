#include "stress/influence.h"
#include "stress/stress_state.h"
#include "stress/window.h"
#include "num/fft.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 8, BLOCKS_SIDE = 64 };

/* Largest von Mises stress, times distance squared, of a point load with friction, over
 * all directions; 2 % are added for the steps of the search. */
static double largest_point_stress(double nu, double mu)
{
	double most = 0;

	for (int i = 0; i <= 90; i++)
		for (int j = 0; j < 360; j += 2) {
			double up = i * 0.017453292519943295,
			       turn = j * 0.017453292519943295;
			double s[STRESS_COMPONENTS];

			stress_point(nu, mu, cos(up) * cos(turn), cos(up) * sin(turn),
				sin(up), s);
			most = fmax(most, stress_von_mises(s));
		}
	return 1.02 * most;
}

static int par_ok(const struct stress_par *p)
{
	return p->nx > 0 && p->ny > 0 && p->nx <= 1 << 20 && p->ny <= 1 << 20 &&
	       p->ax > 0 && p->ay > 0 && p->dz > 0 && p->offset >= 0 && p->nu >= 0 &&
	       p->nu <= 0.5 && p->mu >= 0 &&
	       isfinite(p->ax + p->ay + p->dz + p->offset + p->mu);
}

struct stress *stress_new(const struct stress_par *par)
{
	struct stress *s;
	size_t n = (size_t)par->nx * par->ny;

	if (!par_ok(par)) {
		errno = EDOM;
		return NULL;
	}
	s = calloc(1, sizeof(*s));
	if (!s)
		return NULL;
	s->par = *par;
	s->side = (par->nx > par->ny ? par->nx : par->ny) / BLOCKS_SIDE;
	s->side = s->side < BLOCK ? BLOCK : s->side;
	s->bx = (par->nx + s->side - 1) / s->side;
	s->by = (par->ny + s->side - 1) / s->side;
	s->blocks = calloc((size_t)s->bx * s->by, sizeof(*s->blocks));
	s->loads = malloc(n * sizeof(*s->loads));
	s->pressure = malloc(n * sizeof(*s->pressure));
	s->layers = calloc(LAYERS_KEPT, sizeof(*s->layers));
	if (!s->blocks || !s->loads || !s->pressure || !s->layers) {
		stress_free(s);
		errno = ENOMEM;
		return NULL;
	}
	s->point = largest_point_stress(par->nu, par->mu);
	return s;
}

void stress_layer_free(struct layer *l)
{
	free(l->table);
	fft_free(l->spectra);
	memset(l, 0, sizeof(*l));
}

void stress_free(struct stress *s)
{
	if (!s)
		return;
	for (int i = 0; s->layers && i < LAYERS_KEPT; i++)
		stress_layer_free(&s->layers[i]);
	stress_layer_free(&s->spare);
	for (int i = 0; i < WINDOWS; i++)
		window_free(s->part[i].window);
	free(s->sums);
	free(s->layers);
	free(s->blocks);
	free(s->loads);
	free(s->pressure);
	free(s);
}

static void add_to_block(struct stress *s, int x, int y, double load)
{
	struct block *b = &s->blocks[(size_t)(y / s->side) * s->bx + x / s->side];

	if (b->load == 0) {
		b->x0 = b->x1 = x;
		b->y0 = b->y1 = y;
	}
	b->x0 = x < b->x0 ? x : b->x0;
	b->x1 = x > b->x1 ? x : b->x1;
	b->y1 = y;
	b->load += load;
}

/* Power of two at or below the largest magnitude; 0 where a value is not finite. */
static double unit_of(const double *pressure, size_t n)
{
	double most = 0;
	int exponent;

	for (size_t i = 0; i < n; i++) {
		if (!isfinite(pressure[i]))
			return 0;
		most = fmax(most, fabs(pressure[i]));
	}
	frexp(most, &exponent);
	return most > 0 ? ldexp(0.5, exponent) : 1;
}

int stress_load(struct stress *s, const double *pressure)
{
	int nx = s->par.nx, ny = s->par.ny;
	double area = s->par.ax * s->par.ay, unit = unit_of(pressure, (size_t)nx * ny);

	if (unit == 0) {
		errno = EDOM;
		return -1;
	}
	s->unit = unit;
	for (int i = 0; i < WINDOWS; i++)
		s->part[i].loaded = 0;
	s->nloads = 0;
	s->total = 0;
	memset(s->blocks, 0, (size_t)s->bx * s->by * sizeof(*s->blocks));
	s->x0 = nx, s->x1 = -1, s->y0 = ny, s->y1 = -1;
	for (int y = 0; y < ny; y++)
		for (int x = 0; x < nx; x++) {
			double p = pressure[(size_t)y * nx + x] / unit;

			s->pressure[(size_t)y * nx + x] = p;
			if (p == 0)
				continue;
			s->loads[s->nloads++] = (struct load){ x, y, p };
			s->x0 = x < s->x0 ? x : s->x0;
			s->x1 = x > s->x1 ? x : s->x1;
			s->y0 = y < s->y0 ? y : s->y0;
			s->y1 = y;
			s->total += p * area * unit;
			add_to_block(s, x, y, fabs(p) * area);
		}
	return 0;
}

int stress_claim(struct stress *s, size_t bytes)
{
	if (s->used + bytes > s->par.memory)
		return 0;
	s->used += bytes;
	return 1;
}

struct stress_work stress_work(const struct stress *s)
{
	return s->work;
}

/* What nodes can fail */

/* Distance between two ranges of cells, from node centre to the edge of a loaded cell. */
static double apart(int a0, int a1, int b0, int b1, double size)
{
	int cells = b0 > a1 ? b0 - a1 : a0 > b1 ? a0 - b1 : 0;

	return cells ? (cells - 0.5) * size : 0;
}

static int block_may_fail(const struct stress *s, int bx, int by, double z, double limit)
{
	int x0 = bx * s->side, y0 = by * s->side, last = s->side - 1;
	double sum = 0;

	for (size_t i = 0; i < (size_t)s->bx * s->by; i++) {
		const struct block *b = &s->blocks[i];
		double dx, dy;

		if (b->load == 0)
			continue;
		dx = apart(x0, x0 + last, b->x0, b->x1, s->par.ax);
		dy = apart(y0, y0 + last, b->y0, b->y1, s->par.ay);
		/* Infinite (and so true) where the node may lie on the load. */
		sum += b->load * s->point / (dx * dx + dy * dy + z * z);
		if (sum > limit)
			return 1;
	}
	return 0;
}

size_t stress_spans_max(const struct stress *s)
{
	return (size_t)s->bx * s->par.ny;
}

size_t stress_reach(struct stress *s, long layer, double limit, struct stress_span *span)
{
	double z = stress_depth(s, layer);
	size_t count = 0;

	limit /= s->unit;
	if (s->nloads == 0 || (s->par.periodic && !stress_waves_may_fail(s, z, limit)))
		return 0;
	for (int by = 0; by < s->by; by++) {
		size_t first = count;
		int y0 = by * s->side,
		    y1 = y0 + s->side < s->par.ny ? y0 + s->side : s->par.ny;

		for (int bx = 0; bx < s->bx; bx++) {
			int x0 = bx * s->side;
			int x1 = x0 + s->side < s->par.nx ? x0 + s->side : s->par.nx;

			if (!s->par.periodic && !block_may_fail(s, bx, by, z, limit))
				continue;
			if (count > first && span[count - 1].end == x0)
				span[count - 1].end = x1;
			else
				span[count++] = (struct stress_span){ y0, x0, x1 };
		}
		size_t width = count - first;

		for (int y = y0 + 1; y < y1; y++)
			for (size_t k = 0; k < width; k++) {
				span[count] = span[first + k];
				span[count++].y = y;
			}
	}
	return count;
}

double stress_deep(const struct stress *s, long layer)
{
	double point[STRESS_COMPONENTS], z = stress_depth(s, layer), v[MISES_NUMBERS];
	double complex mean[TENSOR_NUMBERS];

	if (!s->par.periodic) {
		stress_point(s->par.nu, s->par.mu, 0, 0, 1, point);
		return stress_von_mises(point) * s->total / (z * z);
	}
	influence_wave(&s->par, 0, 0, z, mean);
	for (int c = 0; c < MISES_NUMBERS; c++)
		v[c] = creal(mean[c]);
	return influence_mises(v) * s->total /
	       (s->par.nx * s->par.ax * s->par.ny * s->par.ay);
}

/* Direct sums cost a multiplication per load and node, transforms some per point and
 * doubling; the factor is where both take the same time (tests/bench/stress.sh). */
static int prefer_direct(const struct stress *s, double nodes, const struct part *p)
{
	static const double CROSSOVER = 0.3;
	double points = 4. * p->wx * p->wy;

	if (s->par.periodic || s->par.method == STRESS_FOURIER)
		return 0;
	return s->par.method == STRESS_DIRECT ||
	       nodes * s->nloads < CROSSOVER * points * log2(points);
}

int stress_mises(struct stress *s, long layer, const struct stress_span *span,
	size_t count, double *mises)
{
	struct part want;
	double nodes = 0;

	for (size_t i = 0; i < count; i++)
		nodes += span[i].end - span[i].begin;
	if (nodes == 0)
		return 0;
	s->work.nodes += nodes;
	want = stress_part(s, span, count);
	if (prefer_direct(s, nodes, &want))
		return stress_mises_direct(s, layer, span, count, mises);
	return stress_mises_fourier(s, layer, want, mises);
}
