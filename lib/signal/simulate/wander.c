/* wander.c - a pair of slow random processes */
#include "signal/simulate/wander.h"
#include <math.h>

enum { KNOTS = 32 }; /* per correlation time */

static void next_knot(struct wander *w)
{
	double keep = exp(-1.0 / KNOTS), n[2];

	normals_pair(w->normals, w->place + w->knot + 2, n);
	for (int c = 0; c < 2; c++) {
		w->value[0][c] = w->value[1][c];
		w->value[1][c] = keep * w->value[0][c] + sqrt(1 - keep * keep) * n[c];
	}
	w->knot++;
}

void wander_start(
	struct wander *w, const struct normals *normals, uint64_t place, double time)
{
	w->normals = normals;
	w->place = place;
	w->step = time / KNOTS;
	w->knot = UINT64_MAX; /* one before knot 0 */
	w->part = 0;
	normals_pair(normals, place, w->value[1]);
	next_knot(w);
}

void wander_move(struct wander *w, double t)
{
	double place = t / w->step;

	while (place - (double)w->knot >= 1)
		next_knot(w);
	w->part = place > (double)w->knot ? place - (double)w->knot : 0;
}

double wander_value(const struct wander *w, int process)
{
	return w->value[0][process] +
	       w->part * (w->value[1][process] - w->value[0][process]);
}
