/* grids.h - between a grid and the next coarser one, down to some 32 cells a side; for
 * lib/contact only */
#ifndef CONTACT_GRIDS_H
#define CONTACT_GRIDS_H

#include "contact/state.h"

int contact_can_coarsen(const struct contact_par *par, struct contact_par *coarse);
void contact_average_height(struct contact *c);
/* Returns the sum of the pressures. */
double contact_interpolate_pressure(struct contact *c);

#endif
