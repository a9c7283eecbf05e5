/* debris.h - one step of wear: stress below a contact, removal, particles, worn surface
 *
 * Combines stress.h, wear.h and particles.h.  Memory is kept between calls, so use one
 * struct for all steps of all surfaces of one grid; results do not depend on previous
 * calls or on the number of threads.
 *
 *	struct debris_par par = { .stress = { .nx = 128, .ny = 128, .dx = 8e-6,
 *		.dy = 8e-6, .nu = 0.3, .mu = 0.3 }, .yield = 355e6 };
 *	struct debris *d = debris_new(&par);
 *	if (debris_step(d, height, pressure, &step) == DEBRIS_OK)
 *		for (i = 0; i < step.count; i++)
 *			printf("%g\n", step.particle[i].diameter);
 *	debris_free(d);
 */
#ifndef DEBRIS_DEBRIS_H
#define DEBRIS_DEBRIS_H

#include "debris/particles.h"
#include "debris/wear.h"
#include "stress/stress.h"

struct debris;

struct debris_par {
	struct stress_par
		stress; /* its periodic flag also applies to particles and edges */
	double yield;   /* Pa, > 0 */
	enum wear_rule rule;
	double cell, offset; /* as in struct wear_par */
};

struct debris_step {
	double load;      /* N */
	double contact;   /* loaded cells over all cells */
	double edge_load; /* share of the load on the outermost cells; 0 if periodic */
	double max_pressure;
	double volume; /* worn in this step, m3 (2-15) */
	double depth;  /* of the deepest removed material, m */
	double beyond; /* bound of the volume that would be lost beyond the border of a
			* free grid, m3; 0 if periodic */
	struct wear_result wear;
	size_t count;
	const struct particle *particle; /* valid until the next call */
};

/* Bound of the volume lost beyond the border, over that within, that is worth a warning:
 * errors of the volumes of single surfaces are smaller (debrisgen(1), Accuracy).  Of 470
 * rough surfaces none of the 243 below it lost more beyond the border
 * (tests/bench/border.sh). */
#define DEBRIS_BEYOND 0.05

enum debris_status {
	DEBRIS_OK,
	DEBRIS_PULL,    /* a pressure below zero: nothing done */
	DEBRIS_NUMBERS, /* a pressure that is not finite: nothing done */
	DEBRIS_DEEP,    /* material fails deeper than ten times the length of the grid;
			 * height is unchanged */
	DEBRIS_FINE,    /* more than 2000 cells deep: height is unchanged */
	DEBRIS_MEMORY
};

/* NULL with errno EDOM (a parameter out of range) or ENOMEM. */
struct debris *debris_new(const struct debris_par *par);
void debris_free(struct debris *d);

/* Fills in the contact of a step before its wear: load, contact, edge_load and
 * max_pressure. */
void debris_contact(
	const struct debris *d, const double *pressure, struct debris_step *step);

/* Loads the stress with a pressure, as a step does, without wear. */
enum debris_status debris_load(struct debris *d, const double *pressure);

/* Wears the surface under a pressure (Pa, >= 0): lowers height (m, positive towards the
 * other body; or NULL) by the loss of each column. */
enum debris_status debris_step(struct debris *d, double *height, const double *pressure,
	struct debris_step *step);

/* Faces of a column on the border of a free grid: their widths, m; 0 if periodic. */
double debris_border(const struct stress_par *par, size_t ix, size_t iy);

/* Depth below which nothing may fail, m. */
double debris_deepest(const struct stress_par *par);

/* Stress under the pressure of the last step, or of debris_load(). */
struct stress *debris_stress(struct debris *d);

#endif
