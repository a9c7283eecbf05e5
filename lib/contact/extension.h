/* extension.h - continues a residual beyond the contact; for lib/contact only
 *
 * The exact inverse of the half-space on the contact is |q| applied to a residual that
 * goes on outside so that its image there vanishes: the potential of the surface of a
 * conductor between electrodes of given potentials.  That is solved on a coarse grid and
 * refined on the way back up, without transforms.
 *
 * A coarse cell of which the contact covers the part w has contact as an electrode
 * sqrt(w) times its width, and is tied to its potential by the constriction resistance
 * between the two sizes, R (1 / sqrt(w) - 1) / width with R = 2 asinh(1) / pi that of a
 * square; what the next coarser grid gives in between, by the mean |q| of the waves that
 * this grid adds to that one.
 */
#ifndef CONTACT_EXTENSION_H
#define CONTACT_EXTENSION_H

#include "contact/problem.h"

struct extension;

/* finer: that of the grid of which this one is the next coarser, to share its levels
 * while it is not at work, or NULL; memory: room doubles to use in each call if they are
 * enough, and others if not.  NULL when out of memory. */
struct extension *extension_new(const struct contact_par *par,
	const struct extension *finer, double *memory, size_t room);
void extension_free(struct extension *e);

/* Fills in the residual, 0 on entry, where the cell is not active.  Returns the
 * transforms that took, in units of such of the whole grid. */
double extension_apply(
	struct extension *e, const unsigned char *active, double *residual);

#endif
