#include "stress/influence.h"
#include "stress/stress_state.h"
#include <stdlib.h>

enum { TABLE_STEP = 16 };

struct direct {
	struct stress *s;
	const struct stress_span *span;
	size_t count;
	const double *table;
	int wx, wy;
	const ptrdiff_t *place; /* of the loads in the table, against a node's */
	double *mises;
};

static void sum_span(void *context, size_t job, int worker)
{
	const struct direct *d = context;
	const struct stress_span *r = &d->span[job];
	const struct stress *s = d->s;
	ptrdiff_t stride = 2 * (ptrdiff_t)d->wx - 1;

	(void)worker;
	for (int x = r->begin; x < r->end; x++) {
		const double *node =
			d->table +
			((r->y + d->wy - 1) * stride + x + d->wx - 1) * MISES_NUMBERS;
		double v[MISES_NUMBERS] = { 0 };

		for (size_t i = 0; i < s->nloads; i++) {
			const double *k = node - d->place[i];
			double p = s->loads[i].pressure;

			for (int c = 0; c < MISES_NUMBERS; c++)
				v[c] += p * k[c];
		}
		d->mises[(size_t)r->y * s->par.nx + x] = s->unit * influence_mises(v);
	}
}

/* Offsets a table must hold: between all nodes of the spans and all loads. */
static void table_extent(const struct stress *s, const struct stress_span *span,
	size_t count, int *wx, int *wy)
{
	int x = 0, y = 0;

	for (size_t i = 0; i < count; i++) {
		x = larger(x, larger(s->x1 - span[i].begin, span[i].end - 1 - s->x0));
		y = larger(y, larger(s->y1 - span[i].y, span[i].y - s->y0));
	}
	x = (x / TABLE_STEP + 1) * TABLE_STEP;
	y = (y / TABLE_STEP + 1) * TABLE_STEP;
	*wx = x < s->par.nx ? x : s->par.nx;
	*wy = y < s->par.ny ? y : s->par.ny;
}

static size_t table_bytes(int wx, int wy)
{
	return (2 * (size_t)wx - 1) * (2 * (size_t)wy - 1) * MISES_NUMBERS *
	       sizeof(double);
}

static double *table_new(struct stress *s, double z, int wx, int wy)
{
	double *table = malloc(table_bytes(wx, wy));
	struct influence f;

	if (!table || influence_new(&f, &s->par, z, wx, wy)) {
		free(table);
		return NULL;
	}
	influence_table(&f, table);
	influence_free(&f);
	s->work.kernel_cells += (double)wx * wy;
	return table;
}

/* The layer's kernel for direct sums, kept if there is room. */
static struct layer *layer_table(struct stress *s, long layer, int wx, int wy)
{
	struct layer *l = layer < LAYERS_KEPT ? &s->layers[layer] : &s->spare;

	if (l->table && (l->wx < wx || l->wy < wy)) {
		wx = larger(wx, l->wx);
		wy = larger(wy, l->wy);
		s->used -= table_bytes(l->wx, l->wy);
		free(l->table);
		l->table = NULL;
	}
	if (l->table)
		return l;
	if (l == &s->spare || !stress_claim(s, table_bytes(wx, wy))) {
		l = &s->spare;
		stress_layer_free(l);
	}
	l->table = table_new(s, stress_depth(s, layer), wx, wy);
	l->wx = wx;
	l->wy = wy;
	return l->table ? l : NULL;
}

int stress_mises_direct(struct stress *s, long layer, const struct stress_span *span,
	size_t count, double *mises)
{
	struct direct d = { .s = s, .span = span, .count = count, .mises = mises };
	ptrdiff_t *place = malloc((s->nloads + 1) * sizeof(*place));
	struct layer *l;
	int wx, wy;

	table_extent(s, span, count, &wx, &wy);
	l = place ? layer_table(s, layer, wx, wy) : NULL;
	if (!l) {
		free(place);
		return -1;
	}
	for (size_t i = 0; i < s->nloads; i++)
		place[i] = (s->loads[i].y * (2 * (ptrdiff_t)l->wx - 1) + s->loads[i].x) *
			   MISES_NUMBERS;
	d.table = l->table;
	d.wx = l->wx;
	d.wy = l->wy;
	d.place = place;
	pool_run(s->par.pool, count, sum_span, &d);
	free(place);
	if (l == &s->spare)
		stress_layer_free(l);
	s->work.direct_layers++;
	return 0;
}
