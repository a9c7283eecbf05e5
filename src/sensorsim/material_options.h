/* material_options.h - what the particles are made of: options of sensorsim */
#ifndef MATERIAL_OPTIONS_H
#define MATERIAL_OPTIONS_H

#include "cli/opt.h"
#include "signal/pulse/material.h"
#include "signal/simulate/passage.h"

extern struct opt material_rows[]; /* for OPT_TABLE */

/* Dies where options contradict one another or name no material. */
void material_check(void);
/* Material of this particle by the options. */
const struct material *material_draw(
	uint64_t seed, uint32_t realisation, uint64_t particle);
/* Sets the response of the particle. */
void material_respond(const struct material *material, struct passage *p);

#endif
