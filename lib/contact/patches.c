#include "contact/patches.h"
#include "num/select.h"
#include "num/status.h"
#include <math.h>
#include <stdlib.h>

/* A cell, counted on beyond the edges of a periodic grid from where its patch began. */
struct place {
	int x, y;
};

struct search {
	const struct patch_grid *grid;
	const double *p;
	unsigned char *seen;
	struct place *stack;
	size_t depth;
};

/* Index of a place, or -1 beyond a free edge. */
static long index_of(const struct patch_grid *g, struct place a)
{
	if (g->periodic) {
		a.x = (a.x % g->nx + g->nx) % g->nx;
		a.y = (a.y % g->ny + g->ny) % g->ny;
	}
	if (a.x < 0 || a.y < 0 || a.x >= g->nx || a.y >= g->ny)
		return -1;
	return (long)a.y * g->nx + a.x;
}

/* Goes to a neighbour; what does not touch adds the side between to the perimeter. */
static void visit(
	struct search *s, struct contact_patch *patch, struct place a, double side)
{
	long i = index_of(s->grid, a);

	if (i < 0 || !(s->p[i] > 0)) {
		patch->perimeter += side;
	} else if (!s->seen[i]) {
		s->seen[i] = 1;
		s->stack[s->depth++] = a;
	}
}

static double into_grid(double x, double length, int periodic)
{
	return periodic ? x - length * floor(x / length) : x;
}

static struct contact_patch find_patch(struct search *s, size_t first)
{
	const struct patch_grid *g = s->grid;
	struct contact_patch patch = { 0 };
	double sum = 0, x = 0, y = 0, cell = g->dx * g->dy;

	s->seen[first] = 1;
	s->stack[s->depth++] = (struct place){ (int)(first % (size_t)g->nx),
		(int)(first / (size_t)g->nx) };
	while (s->depth > 0) {
		struct place a = s->stack[--s->depth];
		double p = s->p[index_of(g, a)];

		patch.cells++;
		sum += p;
		x += p * (a.x + 0.5);
		y += p * (a.y + 0.5);
		patch.peak = p > patch.peak ? p : patch.peak;
		visit(s, &patch, (struct place){ a.x - 1, a.y }, g->dy);
		visit(s, &patch, (struct place){ a.x + 1, a.y }, g->dy);
		visit(s, &patch, (struct place){ a.x, a.y - 1 }, g->dx);
		visit(s, &patch, (struct place){ a.x, a.y + 1 }, g->dx);
	}
	patch.area = patch.cells * cell;
	patch.load = sum * cell;
	patch.x = into_grid(x / sum * g->dx, g->nx * g->dx, g->periodic);
	patch.y = into_grid(y / sum * g->dy, g->ny * g->dy, g->periodic);
	return patch;
}

/* Room for one more, doubled as needed; NULL when out of memory. */
static struct contact_patch *grow(struct contact_patch *list, size_t n)
{
	struct contact_patch *more;

	if (n & (n - 1))
		return list;
	more = realloc(list, (n ? 2 * n : 1) * sizeof *list);
	if (!more)
		free(list);
	return more;
}

enum num_status contact_patches(const struct patch_grid *grid, const double *pressure,
	struct contact_patch **list, size_t *n)
{
	size_t cells = (size_t)grid->nx * (size_t)grid->ny;
	struct search s = { .grid = grid,
		.p = pressure,
		.seen = calloc(cells, 1),
		.stack = calloc(cells, sizeof *s.stack) };
	int failed = !s.seen || !s.stack;

	*list = NULL;
	*n = 0;
	for (size_t i = 0; !failed && i < cells; i++) {
		if (!(pressure[i] > 0) || s.seen[i])
			continue;
		*list = grow(*list, *n);
		failed = !*list;
		if (*list)
			(*list)[(*n)++] = find_patch(&s, i);
	}
	free(s.seen);
	free(s.stack);
	if (failed) {
		free(*list);
		*list = NULL;
		*n = 0;
	}
	return failed ? NUM_MEMORY : NUM_OK;
}

double contact_corrected_area(
	const struct patch_grid *grid, double area, double perimeter)
{
	double width = sqrt(grid->dx * grid->dy);

	return fmax(area - (M_PI - 1 + M_LN2) / 24 * perimeter * width, 0);
}

enum num_status contact_quantiles(
	const double *pressure, size_t cells, const double *part, double *quantile, int n)
{
	double *sorted = malloc(cells * sizeof *sorted);
	size_t loaded = 0;

	if (!sorted)
		return NUM_MEMORY;
	for (size_t i = 0; i < cells; i++)
		if (pressure[i] > 0)
			sorted[loaded++] = pressure[i];
	sort_numbers(sorted, loaded);
	for (int k = 0; k < n; k++)
		quantile[k] = loaded ? sorted_quantile(sorted, loaded, part[k]) : NAN;
	free(sorted);
	return NUM_OK;
}

double contact_edge_load(const struct patch_grid *grid, const double *pressure)
{
	double sum = 0, edge = 0;

	if (grid->periodic)
		return 0;
	for (int y = 0; y < grid->ny; y++) {
		const double *row = pressure + (size_t)y * (size_t)grid->nx;
		double in_row = 0;

		for (int x = 0; x < grid->nx; x++)
			in_row += row[x];
		sum += in_row;
		if (y == 0 || y == grid->ny - 1 || grid->nx < 3)
			edge += in_row;
		else
			edge += row[0] + row[grid->nx - 1];
	}
	return sum > 0 ? edge / sum : 0;
}
