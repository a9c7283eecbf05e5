/* balance.h - keeps the load of a step in every square of a strip; for lib/contact only
 *
 * A load that is shared unevenly over more than the width of a strip displaces it in
 * proportion to the length of the unevenness, so the part of a step that the bounds of
 * the pressure cut off is missed where it was, and not only in total.  The strip is
 * divided into squares.  The direction is shifted, smoothly along the strip, until the
 * bounded step carries in each square the load of the unbounded one.
 */
#ifndef CONTACT_BALANCE_H
#define CONTACT_BALANCE_H

#include "contact/problem.h"
#include "num/status.h"

struct contact;
struct balance;

/* Sets *b to NULL if the grid is no strip. */
enum num_status balance_new(const struct contact_par *par, struct balance **b);
void balance_free(struct balance *b);

/* Shifts the direction (image) of the active cells for c->tau and c->shift.  size: of the
 * bounded step, sum |step|.  Returns 0, and changes nothing, if what is missed is small.
 */
int balance_direction(struct balance *b, struct contact *c, double size);
/* Removes the last shift from the direction. */
void balance_undo(struct balance *b, struct contact *c);

#endif
