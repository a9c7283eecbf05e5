/* extension.h - extends a residual beyond the contact; for lib/contact only
 *
 * The exact inverse of the half-space on the contact is |q| applied to a residual that is
 * extended outside so that its image vanishes there: the potential of a conductor surface
 * between electrodes of given potentials.  This problem is solved on a coarse grid and
 * refined grid by grid, without transforms.
 *
 * In a coarse cell with a fraction w in contact, the contact is an electrode of sqrt(w)
 * times the width of the cell.  It is coupled to the potential of the cell by the
 * constriction resistance between the two sizes, R (1 / sqrt(w) - 1) / width, where R =
 * 2 asinh(1) / pi is that of a square.  The correction by the next coarser grid is
 * coupled by the mean |q| of the waves that this grid resolves and the coarser one does
 * not.
 *
 * The preconditioner is periodic.  The residual is therefore extended over a frame beyond
 * the last column and row as well: on a free boundary by the same potential, so that
 * opposite edges are not neighbours, and on a periodic one whose size is awkward to
 * transform by the residual of both sides, one blended into the other.
 */
#ifndef CONTACT_EXTENSION_H
#define CONTACT_EXTENSION_H

#include "contact/problem.h"

struct extension;

/* finer: the extension of the next finer grid, whose levels are shared while it is not in
 * use, or NULL; memory: room doubles of scratch space, used if they are enough.  Returns
 * NULL when out of memory. */
struct extension *extension_new(const struct contact_par *par,
	const struct extension *finer, double *memory, size_t room);
void extension_free(struct extension *e);
/* Cells with the frame. */
void extension_size(const struct extension *e, size_t *mx, size_t *my);

/* Extends the residual, gap less approach, beyond the active cells.  Returns the work in
 * units of transforms of the whole grid. */
double extension_solve(struct extension *e, const unsigned char *active,
	const double *gap, double approach);
/* A row of the extended residual and its frame, in the thread worker; the arrays are
 * still those. */
void extension_row(const struct extension *e, size_t y, double *row, int worker);

#endif
