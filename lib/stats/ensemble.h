/* ensemble.h - wear particles of many realisations, summed up step by step
 *
 *	struct ensemble_par par = { .first = 1, .high = INFINITY, .confidence = 0.95 };
 *	struct ensemble *e = ensemble_new(&par);
 *	ensemble_add(e, &particle);
 *	...
 *	if (ensemble_close(e) == ENSEMBLE_OK)
 *		estimate_all(e, out);
 *	ensemble_free(e);
 *
 * One pass over the particles, in any order as long as the rows of a realisation are
 * contiguous or the table is short (num/realisations.h); memory grows with the steps but
 * not with the particles or the realisations.  Up to SKETCH_MOST diameters are kept
 * one by one, more in classes of nearly equal ones (sketch.h).  SI units.
 */
#ifndef CONTACT_ENSEMBLE_H
#define CONTACT_ENSEMBLE_H

#include "stats/sketch.h"
#include "stats/statistics.h"
#include <stddef.h>

struct ensemble;

/* One wear particle. */
struct particle_row {
	long realisation, step; /* from 0; from 1 */
	double diameter, volume;
	long part; /* of the table; a realisation is in one part */
};

enum ensemble_status {
	ENSEMBLE_OK,
	ENSEMBLE_MEMORY,
	ENSEMBLE_APART, /* the rows of a realisation are too far apart */
	ENSEMBLE_CLASH, /* a realisation occurs in two parts */
	ENSEMBLE_MORE   /* more realisations than specified */
};

struct ensemble_par {
	double realisations; /* including those without particles; 0: those that are known
			      */
	long first, last;    /* steps that count; last 0: up to the last with a row */
	int partial;         /* 1: only steps with a row took place, else all of them */
	double low, high;    /* diameters that count */
	int truncated;       /* distributions are truncated at low and high */
	int per_step;        /* growth: particles of a step, not all so far */
	double confidence;   /* of intervals */
	int by_step;         /* keep the diameters of every step separately */
	int groups; /* largest number of groups of realisations for a bootstrap; each
		       realisation is a group if there are no more */
	void (*progress)(long done, long draws); /* called in a bootstrap; or NULL */
};

/* One step over the realisations it took place in. */
struct ensemble_step {
	struct running count,
		volume; /* count: of the diameters that count; volume: of all */
	struct running total_volume; /* of the steps up to this one */
	double total_count;          /* sum over all realisations and the steps so far */
};

/* Some realisations; sums over them, of the steps and diameters that count. */
struct ensemble_group {
	double realisations;
	double worn, volume; /* those with steps; sum of their mean volumes per step */
	double *count;       /* per step, from step 1 */
	size_t steps;        /* in count */
	struct sketch diameters;
};

struct ensemble *ensemble_new(const struct ensemble_par *par); /* NULL: out of memory */
void ensemble_free(struct ensemble *e);

enum ensemble_status ensemble_add(
	struct ensemble *e, const struct particle_row *particle);
/* A step that took place, with or without particles. */
enum ensemble_status ensemble_took_place(struct ensemble *e, long realisation, long step);
/* At least so many realisations and steps took place, with or without particles. */
enum ensemble_status ensemble_simulated(
	struct ensemble *e, double realisations, long steps);
/* Once; the functions below are for closed ensembles. */
enum ensemble_status ensemble_close(struct ensemble *e);
/* The realisation that ENSEMBLE_APART or ENSEMBLE_CLASH refers to. */
long ensemble_culprit(const struct ensemble *e);
size_t ensemble_reported(const struct ensemble *e); /* realisations with rows */

/* As given, with 0 replaced by the values it stands for. */
const struct ensemble_par *ensemble_par(const struct ensemble *e);
double ensemble_particles(const struct ensemble *e); /* all, whether they count or not */
const struct ensemble_step *ensemble_step(const struct ensemble *e, long step);
/* Mean volumes per step of the realisations. */
const struct running *ensemble_volume(const struct ensemble *e);
/* Diameters that count; their ascending values, and with by_step those of a step. */
const struct running *ensemble_diameter(const struct ensemble *e);
const struct sketch *ensemble_diameters(const struct ensemble *e);
const struct sketch *ensemble_step_diameters(const struct ensemble *e, long step);
/* The groups of realisations with rows. */
const struct ensemble_group *ensemble_groups(const struct ensemble *e, size_t *n);
double ensemble_empty(const struct ensemble *e); /* realisations in no group */

#endif
