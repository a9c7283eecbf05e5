#include "stats/ensemble.h"
#include "num/room.h"
#include <stdint.h>
#include <stdlib.h>

struct mark {
	long realisation, step;
};

struct ensemble {
	struct shed *row;
	size_t rows, row_room;
	struct mark *mark; /* steps known to have taken place */
	size_t marks, mark_room;
	long *id; /* realisations, ascending */
	size_t ids;
	long steps; /* up to the last */
	struct ensemble_par par;
	struct ensemble_cell *cell; /* [realisation * steps + step - 1] */
};

struct ensemble *ensemble_new(void)
{
	return calloc(1, sizeof(struct ensemble));
}

void ensemble_free(struct ensemble *e)
{
	if (!e)
		return;
	free(e->row);
	free(e->mark);
	free(e->id);
	free(e->cell);
	free(e);
}

static void note_step(struct ensemble *e, long step)
{
	e->steps = step > e->steps ? step : e->steps;
}

int ensemble_add(struct ensemble *e, const struct shed *particle)
{
	if (room_for(&e->row, &e->row_room, e->rows + 1, sizeof *e->row))
		return -1;
	e->row[e->rows++] = *particle;
	note_step(e, particle->step);
	return 0;
}

int ensemble_took_place(struct ensemble *e, long realisation, long step)
{
	if (room_for(&e->mark, &e->mark_room, e->marks + 1, sizeof *e->mark))
		return -1;
	e->mark[e->marks++] = (struct mark){ realisation, step };
	note_step(e, step);
	return 0;
}

static int by_realisation(const void *a, const void *b)
{
	const struct shed *p = a, *q = b;

	if (p->realisation != q->realisation)
		return p->realisation < q->realisation ? -1 : 1;
	return (p->step > q->step) - (p->step < q->step);
}

static int ascending(const void *a, const void *b)
{
	long p = *(const long *)a, q = *(const long *)b;

	return (p > q) - (p < q);
}

/* Appends unless it is what was appended last. */
static size_t append(long *id, size_t n, long realisation)
{
	if (n == 0 || id[n - 1] != realisation)
		id[n++] = realisation;
	return n;
}

int ensemble_sort(struct ensemble *e)
{
	size_t n = 0;

	e->id = malloc((e->rows + e->marks + 1) * sizeof *e->id);
	if (!e->id)
		return -1;
	for (size_t i = 0; i < e->rows; i++)
		n = append(e->id, n, e->row[i].realisation);
	for (size_t i = 0; i < e->marks; i++)
		n = append(e->id, n, e->mark[i].realisation);
	qsort(e->id, n, sizeof *e->id, ascending);
	for (size_t i = 0; i < n; i++)
		e->ids = append(e->id, e->ids, e->id[i]);
	if (e->rows)
		qsort(e->row, e->rows, sizeof *e->row, by_realisation);
	return 0;
}

long ensemble_clash(const struct ensemble *e)
{
	for (size_t i = 1; i < e->rows; i++)
		if (e->row[i].realisation == e->row[i - 1].realisation &&
			e->row[i].part != e->row[i - 1].part)
			return e->row[i].realisation;
	return -1;
}

size_t ensemble_told(const struct ensemble *e)
{
	return e->ids;
}

static struct ensemble_cell *find_cell(struct ensemble *e, long realisation, long step)
{
	size_t low = 0, high = e->ids;

	while (high - low > 1) {
		size_t middle = low + (high - low) / 2;

		if (e->id[middle] <= realisation)
			low = middle;
		else
			high = middle;
	}
	return &e->cell[low * (size_t)e->steps + (size_t)(step - 1)];
}

static int counts(const struct ensemble *e, const struct shed *row)
{
	return row->diameter >= e->par.low && row->diameter <= e->par.high;
}

static void sum_up(struct ensemble_cell *cell, long steps)
{
	for (long s = 0; s < steps; s++) {
		cell[s].total_count = cell[s].count + (s ? cell[s - 1].total_count : 0);
		cell[s].total_volume =
			(s ? cell[s - 1].total_volume : 0) + cell[s].volume;
	}
}

int ensemble_close(struct ensemble *e, const struct ensemble_par *par)
{
	e->par = *par;
	if (!e->par.realisations)
		e->par.realisations = e->ids;
	if (!e->par.last)
		e->par.last = e->steps;
	note_step(e, e->par.last);
	if (e->steps && e->par.realisations > (SIZE_MAX - 1) / (size_t)e->steps)
		return -1;
	e->cell = calloc(e->par.realisations * (size_t)e->steps + 1, sizeof *e->cell);
	if (!e->cell)
		return -1;
	for (size_t i = 0; i < e->marks; i++)
		find_cell(e, e->mark[i].realisation, e->mark[i].step)->there = 1;
	for (size_t i = 0; i < e->rows; i++) {
		const struct shed *row = &e->row[i];
		struct ensemble_cell *cell = find_cell(e, row->realisation, row->step);

		if (cell->end == cell->begin)
			cell->begin = i;
		cell->end = i + 1;
		cell->there = 1;
		cell->count += counts(e, row);
		cell->volume += row->volume;
	}
	for (size_t r = 0; r < e->par.realisations; r++) {
		struct ensemble_cell *cell = &e->cell[r * (size_t)e->steps];

		for (long s = 0; !par->partial && s < e->steps; s++)
			cell[s].there = 1;
		sum_up(cell, e->steps);
	}
	return 0;
}

const struct ensemble_par *ensemble_par(const struct ensemble *e)
{
	return &e->par;
}

size_t ensemble_particles(const struct ensemble *e)
{
	return e->rows;
}

const struct ensemble_cell *ensemble_cell(
	const struct ensemble *e, size_t realisation, long step)
{
	return &e->cell[realisation * (size_t)e->steps + (size_t)(step - 1)];
}

/* Diameters of one step that count go to x; returns how many. */
static size_t copy_diameters(
	const struct ensemble *e, const struct ensemble_cell *cell, double *x)
{
	size_t n = 0;

	for (size_t k = cell->begin; k < cell->end; k++)
		if (counts(e, &e->row[k]))
			x[n++] = e->row[k].diameter;
	return n;
}

double *ensemble_diameters(
	const struct ensemble *e, const size_t *pick, long first, long last, size_t *n)
{
	size_t room = 1;
	double *x;

	for (size_t i = 0; i < e->par.realisations; i++)
		for (long s = first; s <= last; s++)
			room += (size_t)ensemble_cell(e, pick ? pick[i] : i, s)->count;
	*n = 0;
	x = malloc(room * sizeof *x);
	for (size_t i = 0; x && i < e->par.realisations; i++)
		for (long s = first; s <= last; s++)
			*n += copy_diameters(
				e, ensemble_cell(e, pick ? pick[i] : i, s), x + *n);
	return x;
}

double ensemble_aspects(
	const struct ensemble *e, const double *edge, int n, double *count)
{
	double all = 0;

	for (int k = 0; k < n; k++)
		count[k] = 0;
	for (size_t i = 0; i < e->rows; i++) {
		const struct shed *row = &e->row[i];
		int k = 0;

		if (!counts(e, row) || row->step < e->par.first ||
			row->step > e->par.last)
			continue;
		while (k < n && row->aspect >= edge[k])
			k++;
		if (k > 0)
			count[k - 1]++;
		all++;
	}
	return all;
}
