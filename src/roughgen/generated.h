/* generated.h - rough surfaces drawn from a spectrum: options of roughgen
 *
 *	struct generated *g = generated_open(threads);
 *	while (generated_next(g, &r))
 *		...
 *	generated_close(g);
 */
#ifndef GENERATED_H
#define GENERATED_H

#include "cli/opt.h"
#include "io/fields.h"

/* For OPT_TABLE: the options that do not apply to measured surfaces. */
extern struct opt generated_grid_rows[], generated_rows[];

/* Dies where options contradict one another. */
void generated_check(void);

struct generated;

/* The requested ensemble; dies if the parameters are impossible. */
struct generated *generated_open(int threads);
/* The next realisation; 0 after the last. */
int generated_next(struct generated *g, struct record *r);
int generated_more(const struct generated *g); /* 1 if one follows */
void generated_close(struct generated *g);

#endif
