/* wear.h - removal of the material whose von Mises stress exceeds the yield stress
 *
 * The potential set (2-11) is every cell over yield; the actual set (2-12) is a column
 * of such cells from the surface down.  Layers are taken one by one until none below can
 * lose a cell, and within a layer only cells that still can.
 *
 *	struct wear_par par = { .yield = 355e6, .rule = WEAR_COLUMN };
 *	stress_load(stress, p);
 *	particles_begin(ps);
 *	wear_remove(stress, &par, nx, ny, ps, removed, &result);
 *	particles_end(ps, &list);
 */
#ifndef CONTACT_WEAR_H
#define CONTACT_WEAR_H

#include "debris/particles.h"
#include "stress/stress.h"

enum wear_rule { WEAR_COLUMN, WEAR_POTENTIAL };

struct wear_par {
	double yield; /* Pa, > 0 */
	enum wear_rule rule;
	long max_layers; /* give up below this many, which should lie far below the
			  * load; 0: never */
};

struct wear_result {
	long layers;          /* evaluated */
	double cells;         /* removed */
	long columns;         /* that lost cells */
	double mises;         /* largest von Mises stress met, Pa */
	double nodes;         /* at which the stress was needed */
	double nodes_skipped; /* of the layers evaluated */
};

enum wear_status {
	WEAR_OK,
	WEAR_DEEP, /* cells still fail at max_layers */
	WEAR_MEMORY
};

/* Removes under the load that stress holds.  removed[nx * ny] receives the number of
 * cells lost per column; particles (may be NULL) each layer's set. */
enum wear_status wear_remove(struct stress *stress, const struct wear_par *par, int nx,
	int ny, struct particles *particles, int *removed, struct wear_result *result);

#endif
