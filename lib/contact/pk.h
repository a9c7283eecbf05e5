/* pk.h - Polonsky and Keer's single loop; for lib/contact only */
#ifndef CONTACT_PK_H
#define CONTACT_PK_H

#include "contact/state.h"

enum contact_status contact_solve_pk(struct contact *c);

#endif
