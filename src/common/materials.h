/* materials.h - option --material: materials with shares, NAME[=SHARE],... */
#ifndef MATERIALS_H
#define MATERIALS_H

#include "signal/pulse/material.h"

enum { MATERIALS_MIXED = 16 };

struct material_mix {
	int n;
	const struct material *part[MATERIALS_MIXED];
	double share[MATERIALS_MIXED]; /* 1 where none is given */
};

/* Dies where there is none of this name; option names the one that gave it. */
const struct material *material_named(const char *option, const char *name);
/* Dies where text names no material or all shares are 0. */
struct material_mix materials_read(const char *text);
/* "ferrous, steel, ...": fresh memory. */
char *material_names(void);

#endif
