/* realisations.c - see realisations.h */
#include "num/realisations.h"
#include "num/room.h"
#include <stdlib.h>
#include <string.h>

/* Numbers of realisations from first to last. */
struct range {
	long first, last;
};

struct realisations {
	struct realisation_cell *cell;
	size_t n, room, most;
	struct range *done; /* passed on: ranges that ascend and do not touch */
	size_t ndone;
	realisations_take *take;
	void *to;
	long culprit;
};

struct realisations *realisations_new(size_t room, realisations_take *take, void *to)
{
	struct realisations *r = calloc(1, sizeof *r);

	if (r) {
		r->most = room;
		r->take = take;
		r->to = to;
	}
	return r;
}

void realisations_free(struct realisations *r)
{
	if (!r)
		return;
	free(r->cell);
	free(r->done);
	free(r);
}

static int compare_cells(const void *a, const void *b)
{
	const struct realisation_cell *x = a, *y = b;

	if (x->realisation != y->realisation)
		return x->realisation < y->realisation ? -1 : 1;
	if (x->step != y->step)
		return x->step < y->step ? -1 : 1;
	return (x->part > y->part) - (x->part < y->part);
}

/* Appends a range to list, as part of the last one where they touch; AGAIN if they
 * overlap. */
static enum realisations_status append(struct range *list, size_t *n, struct range next)
{
	if (*n && next.first <= list[*n - 1].last)
		return REALISATIONS_AGAIN;
	if (*n && next.first == list[*n - 1].last + 1)
		list[*n - 1].last = next.last;
	else
		list[(*n)++] = next;
	return REALISATIONS_OK;
}

/* Notes the realisations of the first count cells, which are sorted. */
static enum realisations_status note_done(struct realisations *r, size_t count)
{
	size_t fresh = 0, i = 0, k = 0, n = 0;
	struct range *merged;

	for (size_t c = 0; c < count; c++)
		fresh += c == 0 || r->cell[c].realisation != r->cell[c - 1].realisation;
	merged = malloc((r->ndone + fresh + 1) * sizeof *merged);
	if (!merged)
		return REALISATIONS_MEMORY;
	while (i < r->ndone || k < count) {
		long number = k < count ? r->cell[k].realisation : 0;
		int old = k == count || (i < r->ndone && r->done[i].first <= number);
		struct range next = old ? r->done[i] : (struct range){ number, number };

		if (append(merged, &n, next) != REALISATIONS_OK) {
			r->culprit = next.first;
			free(merged);
			return REALISATIONS_AGAIN;
		}
		if (old)
			i++;
		else
			while (k < count && r->cell[k].realisation == number)
				k++;
	}
	free(r->done);
	r->done = merged;
	r->ndone = n;
	return REALISATIONS_OK;
}

/* Passes on all realisations except keep, whose cells stay. */
static enum realisations_status hand_on(struct realisations *r, int all, long keep)
{
	size_t kept = 0, count;
	enum realisations_status status;

	for (size_t i = 0; !all && i < r->n; i++)
		kept += r->cell[i].realisation == keep;
	/* The cells to keep go to the end, in their order. */
	if (kept) {
		struct realisation_cell *aside = malloc(kept * sizeof *aside);
		size_t a = 0;

		count = 0;
		if (!aside)
			return REALISATIONS_MEMORY;
		for (size_t i = 0; i < r->n; i++)
			if (r->cell[i].realisation == keep)
				aside[a++] = r->cell[i];
			else
				r->cell[count++] = r->cell[i];
		memcpy(r->cell + count, aside, kept * sizeof *aside);
		free(aside);
	}
	count = r->n - kept;
	if (count)
		qsort(r->cell, count, sizeof *r->cell, compare_cells);
	status = note_done(r, count);
	for (size_t i = 0, end; status == REALISATIONS_OK && i < count; i = end) {
		for (end = i; end < count &&
			      r->cell[end].realisation == r->cell[i].realisation;)
			end++;
		r->culprit = r->cell[i].realisation;
		if (r->take(r->to, r->cell + i, end - i))
			status = REALISATIONS_STOP;
	}
	if (kept)
		memmove(r->cell, r->cell + count, kept * sizeof *r->cell);
	r->n = kept;
	return status;
}

enum realisations_status realisations_add(
	struct realisations *r, const struct realisation_cell *row)
{
	struct realisation_cell *last = r->n ? &r->cell[r->n - 1] : NULL;

	if (last && compare_cells(last, row) == 0) {
		last->volume += row->volume;
		last->count += row->count;
		last->large += row->large;
		return REALISATIONS_OK;
	}
	/* A realisation of more steps than there is room for doubles the room. */
	if (r->n >= r->most) {
		enum realisations_status status =
			hand_on(r, 0, r->cell[r->n - 1].realisation);

		if (status != REALISATIONS_OK)
			return status;
		if (r->n > r->most / 2)
			r->most *= 2;
	}
	if (room_for(&r->cell, &r->room, r->n + 1, sizeof *r->cell))
		return REALISATIONS_MEMORY;
	r->cell[r->n++] = *row;
	return REALISATIONS_OK;
}

enum realisations_status realisations_end(struct realisations *r)
{
	return hand_on(r, 1, 0);
}

long realisations_culprit(const struct realisations *r)
{
	return r->culprit;
}
