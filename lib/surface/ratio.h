/* ratio.h - the material ratio curve and the Sk family (ISO 25178-2, ISO 13565-2)
 *
 * The curve shows heights in descending order over the share of the surface above them. A
 * least-squares line is fitted to the 40 % of it with the least steep secant (the first
 * of equal ones); the line decreases by Sk from 0 to 100 %. The peaks above its upper end
 * and the valleys below its lower end are replaced by triangles of equal area.
 */
#ifndef SURFACE_RATIO_H
#define SURFACE_RATIO_H

#include "num/status.h"
#include <stddef.h>

struct core {
	double sk, spk, svk; /* m */
	double smr1, smr2;   /* shares above the upper and the lower end of the core */
};

/* All are nan with fewer than five points. */
enum num_status surface_core(size_t n, const double *z, struct core *core);

#endif
