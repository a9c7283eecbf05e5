/* chords.h - length and width of a convex hull: its longest chord, and the longest one at
 * right angles to that
 *
 *	struct chords *c = chords_new();
 *	if (chords_measure(c, hull, step, &length, &width) == 0)
 *		aspect = length / width;
 *	chords_free(c);
 */
#ifndef CONTACT_CHORDS_H
#define CONTACT_CHORDS_H

#include "debris/hull.h"

struct chords; /* memory that is kept over calls */

struct chords *chords_new(void); /* NULL when out of memory */
void chords_free(struct chords *c);

/* Of the last hull built in h, a step of whose lattice is so long along x, y and z.  -1
 * when out of memory. */
int chords_measure(struct chords *c, const struct hull *h, const double step[3],
	double *length, double *width);

#endif
