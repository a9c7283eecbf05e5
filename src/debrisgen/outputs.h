/* outputs.h - what debrisgen writes: particles, summary, worn surfaces and stress */
#ifndef OUTPUTS_H
#define OUTPUTS_H

#include "cli/opt.h"
#include "debris/debris.h"
#include "io/fields.h"
#include "quick.h"

extern struct opt worn_rows[]; /* for OPT_TABLE: the files besides the particles */

/* A surface and what is kept of it from step to step. */
struct worn_surface {
	struct record *r; /* holds h and p */
	double *h, *p;    /* height, m, NULL if not kept, and pressure, Pa */
	double crown;     /* its drop, part of h, m */
	double sq;        /* rms height when new, the crown taken off, m */
};

/* Root mean square height, the crown taken off. */
double worn_roughness(const struct worn_surface *c);

/* The step on grids of twice and four times the spacing. */
struct grid_error {
	double volume[2], particles[2];
	double order; /* of the volume in the spacing; nan: none between 0.5 and 3 */
	double extrapolated; /* volume; nan without an order */
	double error;        /* its distance, or that of the three volumes, m3 */
};

/* A step of wear and its result. */
struct worn_step {
	long number;     /* from 1, over all programs of a pipeline */
	double distance; /* slid so far, m */
	const struct debris_step *lost, *second; /* NULL: the counterface is not worn */
	const struct record *counterface;        /* worn so far; NULL: there is none */
	const struct grid_error *grid;           /* NULL: not asked for */
	const struct quick_volumes *volumes;     /* NULL: no surrogate */
	double length;                           /* slid in this step, m */
	double hardness;                         /* of Archard's coefficient, Pa */
	struct stress *stress;                   /* below the contact */
	double dz, offset; /* layers of --stress lie (layer + offset) dz deep, m */
};

struct worn;

/* upstream: the pipeline that made what is read, NULL if unknown; richardson: the summary
 * has columns for steps on coarser grids; surrogate: there are columns for intervals. */
struct worn *worn_open(const char *upstream, int richardson, int surrogate);
/* Under what the particles were torn off, which rwl needs; NAN: not known. */
struct worn_conditions {
	double area;     /* of the grid, m2 */
	double pressure; /* nominal, Pa */
	double friction; /* shear over pressure */
	double distance; /* slid in a step, m */
};

/* Whether any output but the particles is asked for: those take heights. */
int worn_takes_heights(void);
/* What follows is of this record. */
void worn_begin(
	struct worn *w, const struct record *r, const struct worn_conditions *conditions);
void worn_put(struct worn *w, const struct worn_surface *c, const struct worn_step *s);
/* The realisation has been worn up to this step. */
void worn_end(struct worn *w, long realisation, long step);
/* Why rows are doubtful. */
void worn_doubt(struct worn *w, const char *why);
void worn_close(struct worn *w);

#endif
