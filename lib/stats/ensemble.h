/* ensemble.h - wear particles of many realisations, step by step
 *
 *	struct ensemble_par par = { .first = 1, .high = INFINITY, .confidence = 0.95 };
 *	struct ensemble *e = ensemble_new();
 *	ensemble_add(e, &particle);
 *	...
 *	if (ensemble_close(e, &par) == 0)
 *		x = ensemble_diameters(e, NULL, 1, 10, &n);
 *	ensemble_free(e);
 *
 * Functions that return int give 0, or -1 when out of memory.  SI units throughout.
 */
#ifndef CONTACT_ENSEMBLE_H
#define CONTACT_ENSEMBLE_H

#include <stddef.h>

struct ensemble;

/* One wear particle. */
struct shed {
	long realisation, step; /* from 0; from 1 */
	double diameter, volume, aspect;
	long part; /* of the table; a realisation stands in one */
};

struct ensemble_par {
	size_t realisations; /* with those that shed nothing; 0: those told of */
	long first, last;    /* steps that count; last 0: up to the last told of */
	int partial;         /* only steps told of took place, else all of them */
	double low, high;    /* diameters that count */
	int truncated;       /* distributions are cut off at low and high */
	int per_step;        /* growth: particles of a step, not all so far */
	double confidence;   /* of intervals */
};

/* A step of one realisation. */
struct ensemble_cell {
	int there;            /* it took place */
	double count, volume; /* count: of the diameters that count; volume: of all */
	double total_count, total_volume; /* of the steps up to this one */
	size_t begin, end;
};

struct ensemble *ensemble_new(void); /* NULL when out of memory */
void ensemble_free(struct ensemble *e);

int ensemble_add(struct ensemble *e, const struct shed *particle);
/* A step that took place, whether or not it shed a particle. */
int ensemble_took_place(struct ensemble *e, long realisation, long step);
/* Puts the realisations in order; afterwards ensemble_told() knows how many there are. */
int ensemble_sort(struct ensemble *e);
/* A realisation that stands in two parts, -1 without. */
long ensemble_clash(const struct ensemble *e);
size_t ensemble_told(const struct ensemble *e);
/* Once, after ensemble_sort(); the functions below are for closed ensembles.  par is
 * copied; par->realisations is 0 or at least ensemble_told(). */
int ensemble_close(struct ensemble *e, const struct ensemble_par *par);

/* As given, with the values that 0 stands for. */
const struct ensemble_par *ensemble_par(const struct ensemble *e);
size_t ensemble_particles(const struct ensemble *e); /* all, whether they count or not */
/* realisation: 0, 1, ... in ascending order of their numbers. */
const struct ensemble_cell *ensemble_cell(
	const struct ensemble *e, size_t realisation, long step);

/* The diameters that count in steps first to last, fresh memory, NULL without: of as many
 * realisations as there are, those in pick (NULL: of each one). */
double *ensemble_diameters(
	const struct ensemble *e, const size_t *pick, long first, long last, size_t *n);

/* Sorts the aspect ratios of what counts into n classes from edge[k] to edge[k + 1], the
 * last one open; returns how many there are, with those below the first edge. */
double ensemble_aspects(
	const struct ensemble *e, const double *edge, int n, double *count);

#endif
