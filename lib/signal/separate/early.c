/* early.c - see early.h */
#include "signal/separate/early.h"
#include <math.h>
#include <stdlib.h>

/* Samples that may show the instrument, or twice or four times as many: 0.8 s at 10 kHz.
 */
enum { FEW = 8192 };

struct early {
	struct renewal *whole;
	struct separate *first; /* NULL: there are no more early rows */
	double given; /* arrivals before this sample are those of rows given early */
};

static void end(struct early *e)
{
	separate_free(e->first);
	e->first = NULL;
}

struct early *early_new(const struct separate_par *given)
{
	struct early *e = calloc(1, sizeof *e);
	struct separate_par par = *given;
	int any = par.learn == 0 && !par.kept && !par.known.filter &&
		  par.method == SEPARATE_FIT;

	if (!e)
		return NULL;
	e->given = -INFINITY;
	e->whole = renewal_new(given);
	par.learn = FEW;
	par.clearly = 1;
	par.want_sources = 0;
	par.on_section = NULL;
	e->first = any && e->whole ? separate_new(&par) : NULL;
	if (e->whole && (e->first || !any))
		return e;
	early_free(e);
	return NULL;
}

void early_free(struct early *e)
{
	if (!e)
		return;
	end(e);
	renewal_free(e->whole);
	free(e);
}

/* Early rows are those of the samples that are learned from, whatever the sizes of the
 * pieces. */
enum separate_status early_push(struct early *e, const double *x, size_t n)
{
	if (e->first) {
		size_t left =
			SEPARATE_LEARN - (size_t)separate_counters(e->first)->samples;

		if (separate_push(e->first, x, n < left ? n : left) != SEPARATE_OK)
			end(e);
	}
	return renewal_push(e->whole, x, n);
}

enum separate_status early_end(struct early *e)
{
	return renewal_end(e->whole);
}

int early_next(struct early *e, struct transit *p)
{
	if (e->first && separate_next(e->first, p)) {
		if (p->verdict == SEPARATE_ALONE) {
			e->given = p->t1 + separate_calibration(e->first)->duration / 2;
			return 1;
		}
		end(e);
	}
	while (renewal_next(e->whole, p))
		if (!(p->t1 < e->given)) /* nan: an event at sensor 2 alone */
			return 1;
	return 0;
}

const struct renewal *early_whole(const struct early *e)
{
	return e->whole;
}
