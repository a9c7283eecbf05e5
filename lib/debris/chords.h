/* chords.h - length and width of a convex hull: its largest Feret diameter, and its
 * longest chord perpendicular to that; if several diameters are largest, the longest
 * chord perpendicular to any of them
 *
 *	struct chords *c = chords_new();
 *	if (chords_measure(c, hull, step, &length, &width) == 0)
 *		aspect = length / width;
 *	chords_free(c);
 */
#ifndef CONTACT_CHORDS_H
#define CONTACT_CHORDS_H

#include "debris/hull.h"
#include "num/status.h"

struct chords; /* memory that is kept between calls */

struct chords *chords_new(void); /* NULL when out of memory */
void chords_free(struct chords *c);

/* Measures the last hull built in h; step: lattice spacings along x, y and z. */
enum num_status chords_measure(struct chords *c, const struct hull *h,
	const double step[3], double *length, double *width);

#endif
