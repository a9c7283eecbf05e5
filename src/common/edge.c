#include "common/edge.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "contact/patches.h"

/* Share of the load on the outermost cells that is worth a warning: what they carry in
 * full contact of 80 x 80 cells. */
static const double EDGE_LOAD = 0.05;

void edge_note(struct edge *e, double share, double limit, long realisation, long step)
{
	e->steps += share > limit;
	if (share > e->most) {
		e->most = share;
		e->realisation = realisation;
		e->step = step;
	}
}

int edge_load_note(struct edge *e, double share, long realisation, long step)
{
	edge_note(e, share, EDGE_LOAD, realisation, step);
	return share > CONTACT_EDGE_MOST;
}

void edge_load_warn(const struct edge *e, const char *name)
{
	stats_add("edge_load_steps", (double)e->steps);
	if (e->steps)
		warn("%s: %ld contacts with more than 5 %% of the load on the outermost "
		     "cells, worst %.0f %% (realisation %ld, step %ld): use a larger area, "
		     "roughgen --crown auto, or --boundary periodic",
			name, e->steps, 100 * e->most, e->realisation, e->step);
}
