/* gradient.h - steps of the projected gradient; for lib/contact only */
#ifndef CONTACT_GRADIENT_H
#define CONTACT_GRADIENT_H

#include "contact/state.h"

/* One step of the projected gradient, which always lowers the energy and
 * keeps the load, or restores it.  contact_gap() is to follow. */
void contact_gradient_step(struct contact *c);
/* How many such steps to take: now and then one, while the optimality gap does not fall,
 * and more where the energy has not fallen either.  s: sums just after contact_gap(). */
int contact_gradient_due(struct contact *c, const struct sweep *s);
/* 1 when it is time to ask that. */
int contact_lingers(const struct contact *c);

#endif
