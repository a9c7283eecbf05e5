/* worn.h - what debrisgen writes: particles, summary, worn surfaces and stress */
#ifndef WORN_H
#define WORN_H

#include "contact/debris.h"
#include "shell/fields.h"
#include "shell/opt.h"

extern struct opt worn_rows[]; /* for OPT_TABLE: the files besides the particles */

/* A surface and what is kept of it from step to step. */
struct worn_surface {
	struct record *r; /* holds h and p */
	double *h, *p;    /* height and pressure */
	double crown;     /* its drop, part of h */
	double sq;        /* when new, the crown taken off */
};

/* Root mean square height, the crown taken off. */
double worn_roughness(const struct worn_surface *c);

struct worn_step {
	long number;
	double distance; /* slid so far, m */
	const struct debris_step *lost;
	struct stress *stress; /* below the contact */
	double dz, offset;     /* its layers, as in struct stress_par */
};

struct worn;

/* upstream: the pipeline that made what is read, NULL if unknown. */
struct worn *worn_open(const char *upstream);
/* What follows is of this record. */
void worn_begin(struct worn *w, const struct record *r);
void worn_put(struct worn *w, const struct worn_surface *c, const struct worn_step *s);
void worn_close(struct worn *w);

#endif
