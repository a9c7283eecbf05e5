/* bccg.h - preconditioned bound-constrained conjugate gradients; for lib/contact only */
#ifndef CONTACT_BCCG_H
#define CONTACT_BCCG_H

#include "contact/state.h"
#include "num/status.h"

enum num_status contact_make_preconditioner(
	struct contact *c, const struct contact *lender);
enum contact_status contact_solve_bccg(struct contact *c);

#endif
