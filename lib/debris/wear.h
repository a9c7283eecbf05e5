/* wear.h - removal of the material whose equivalent stress exceeds the yield stress
 *
 * The potential set (2-11) is all that is over yield; the actual set (2-12) is what a
 *column loses from the surface down to where it first holds.  Depths are taken one by one
 *until none below can lose anything, and at each only the columns that still can.
 *
 * Without cells the depth at which the stress crosses the yield stress is interpolated
 * between depths that grow geometrically, from an eighth of the spacing on: most of the
 * loss lies near the surface, where the stress changes fastest.  With cells the material
 * falls in cells of one height, each by the stress at its upper side or middle, as in the
 * thesis.
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
	double deepest; /* give up below this depth, which should lie far below the load,
			 * m; 0: never */
};

struct wear_result {
	long layers;                   /* depths evaluated */
	double depth;                  /* of the last one, m */
	double height;                 /* lost, added up over the columns, m */
	long columns;                  /* that lost something */
	double stress;                 /* largest equivalent stress met, Pa */
	double nodes;                  /* at which the stress was needed */
	double nodes_skipped;          /* of the depths evaluated */
	const struct stretch *stretch; /* lost; valid until the next call */
	size_t count;
};

enum wear_status {
	WEAR_OK,
	WEAR_DEEP, /* material still fails at the deepest depth */
	WEAR_MEMORY
};

struct wear; /* memory that is kept over calls */

struct wear *wear_new(int nx, int ny); /* NULL when out of memory */
void wear_free(struct wear *w);

/* Removes under the load that stress holds. */
enum wear_status wear_remove(struct wear *w, struct stress *stress,
	const struct wear_par *par, struct wear_result *result);

#endif
