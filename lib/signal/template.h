/* template.h - the pulse of a record, by least squares from all that is seen of it
 *
 * Arrivals, durations and amplitudes being known, a record is linear in the values of its
 * pulse: cubic B-splines, KNOTS to the duration, reaching TEMPLATE_REACH durations to
 * either side of the centre, each as the whitening of its channel leaves it.  Pulses that
 * overlap need no special care.
 */
#ifndef SIGNAL_TEMPLATE_H
#define SIGNAL_TEMPLATE_H

#include "signal/joint.h"
#include "signal/shape.h"
#include "signal/whiten.h"
#include <stddef.h>

enum { TEMPLATE_KNOTS = 24, TEMPLATE_HALF = 40, TEMPLATE_COUNT = 2 * TEMPLATE_HALF + 1 };

struct template;
/* duration: of a pulse with delta 0; whitening: NULL, none.  NULL: no memory. */
struct template *template_new(double duration, const struct whitening whitening[2]);
void template_free(struct template *t);

/* Forgets all it was given. */
void template_clear(struct template *t);
/* One more stretch of the record, and the m pulses in it. */
void template_add(struct template *t, const struct joint_scene *scene, const double *y1,
	const double *y2, size_t n, const struct joint_pulse *pulses, int m);
/* The pulse that leaves least, max |p| = 1, its first lobe positive, and s = 0 between
 * its lobes.  *scale and *shift: the pulses were of that amplitude, and so many durations
 * late.  NULL: no memory, or nothing to learn from. */
struct shape *template_solve(struct template *t, double *scale, double *shift);

#endif
