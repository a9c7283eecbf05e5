/* wear.h - removal of the material whose equivalent stress exceeds the yield stress
 *
 * The potential set (2-11) is all material above yield; the actual set (2-12) is, in each
 * column, the failed material from the surface down to the first depth that does not
 * fail.  Depths are processed in order until no material below can fail, and at each
 * depth only the columns that can still fail.
 *
 * Without cells the depth at which the stress crosses the yield stress is interpolated
 * between depths that increase geometrically from an eighth of the spacing, because most
 * of the loss is near the surface, where the stress varies most.  With cells the
 * material is removed in cells of one height, each by the stress at its upper side or
 * centre, as in the thesis.
 *
 *	struct wear_par par = { .yield = 355e6, .rule = WEAR_COLUMN, .spacing = 8e-6 };
 *	struct wear *w = wear_new(nx, ny);
 *	stress_load(stress, p);
 *	wear_remove(w, stress, &par, &result);
 */
#ifndef DEBRIS_WEAR_H
#define DEBRIS_WEAR_H

#include "debris/particles.h"
#include "stress/stress.h"

enum wear_rule { WEAR_COLUMN, WEAR_POTENTIAL };

struct wear_par {
	double yield; /* Pa, > 0 */
	enum wear_rule rule;
	double spacing; /* of the grid, m: the smaller one */
	double cell;    /* height of a cell, m; 0: none, the depth is interpolated */
	double offset;  /* of a cell's node from its upper side, in cells */
	double deepest; /* fail with WEAR_DEEP below this depth, which should be far below
			 * the load, m; 0: no limit */
};

struct wear_result {
	long layers;                   /* depths evaluated */
	double depth;                  /* of the last one, m */
	double height;                 /* sum of the losses of the columns, m */
	long columns;                  /* columns with a loss */
	double stress;                 /* largest equivalent stress evaluated, Pa */
	double nodes;                  /* at which the stress was evaluated */
	double nodes_skipped;          /* at the same depths, not evaluated */
	const struct stretch *stretch; /* removed; valid until the next call */
	size_t count;
};

enum wear_status {
	WEAR_OK,
	WEAR_DEEP, /* material still fails at the deepest depth */
	WEAR_MEMORY
};

struct wear; /* memory that is kept between calls */

struct wear *wear_new(int nx, int ny); /* NULL when out of memory */
void wear_free(struct wear *w);

/* Removes the material that fails under the load of stress. */
enum wear_status wear_remove(struct wear *w, struct stress *stress,
	const struct wear_par *par, struct wear_result *result);

#endif
