/* blocks.h - the load of small blocks of cells in a bounded step; for lib/contact only
 *
 * Bounds cut off what a step takes from cells near the edge of the contact.  Where the
 * contact is rough down to the cells, much of the step is cut off; restored evenly over
 * the grid, it misplaces load at every distance, which displaces far more than the step
 * itself.  So it is restored close by, in the other cells of the block.
 */
#ifndef CONTACT_BLOCKS_H
#define CONTACT_BLOCKS_H

#include "contact/state.h"

/* Shifts the direction of a step, in image, block by block, so that bounded it carries in
 * each block what it carries unbounded, but takes no more than is there. */
void blocks_keep_load(struct contact *c);

#endif
