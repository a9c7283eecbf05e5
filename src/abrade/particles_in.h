/* particles_in.h - the particles in a gap: from a table or from a cleanliness code
 */
#ifndef PARTICLES_IN_H
#define PARTICLES_IN_H

#include "abrasion/population.h"
#include "cli/opt.h"
#include <stddef.h>
#include <stdint.h>

extern struct opt particles_rows[]; /* for OPT_TABLE */

struct source;

/* The particles of one gap: of a realisation, or of one of its steps. */
struct particles_in {
	long realisation, step;
	double *diameter, *aspect; /* aspect NULL: spheres */
	size_t n;
};

/* Dies where options contradict one another. */
void particles_check(int operands, double area, double inlet);
/* NULL if a table is read. */
const struct population *particles_population(double inlet_limit);

/* Reads the table from path to its end. */
struct source *particles_read(const char *path);
/* Draws what is in an area of the gap. */
struct source *particles_drawn(
	const struct population *p, double area, double gap, uint64_t seed);
/* The next gap; 0 at the end. */
int particles_next(struct source *s, struct particles_in *in);
/* 1 if all rows have an aspect. */
int particles_shaped(const struct source *s);
/* 1 if the table has a column of realisations. */
int particles_apart(const struct source *s);
/* 1 if the table has a column of steps. */
int particles_stepped(const struct source *s);
/* Why the table says that its rows are doubtful, NULL if it does not. */
const char *particles_doubted(const struct source *s);
const char *particles_upstream(const struct source *s); /* NULL if unknown */
void particles_close(struct source *s);

#endif
