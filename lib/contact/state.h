/* state.h - data and functions shared by the solvers; for lib/contact only */
#ifndef CONTACT_STATE_H
#define CONTACT_STATE_H

#include "contact/extension.h"
#include "contact/mlms.h"
#include "contact/problem.h"
#include "contact/transfer.h"
#include "num/convolve.h"
#include "num/status.h"
#include "num/sweep.h"
#include <math.h>

/* Iterations without a fall of the optimality gap by a tenth between checks whether the
 * energy falls.  Of the 2600 random problems of contact_stalls() all but six fall by a
 * tenth within 17, and those six do after the steps that this check makes. */
enum { GRADIENT_ROUND = 25 };

struct contact {
	struct contact_par par;
	size_t n;               /* cells */
	double cap;             /* hardness or INFINITY */
	double near_cap;        /* cap minus a margin for rounding */
	struct convolve *plane; /* transforms of displacement = kernel * pressure */
	double *kernel;
	struct contact_kernel body; /* whose displacement is computed */
	struct mlms *mlms;          /* in place of plane and kernel */
	double *memory;             /* holds the arrays below, unless borrowed */
	double *gap;                /* g */
	double *step, *image;       /* step of the pressure, and its displacement */
	struct contact_result result;

	/* preconditioned solver only */
	struct convolve *periodic;   /* transforms of the preconditioner */
	double *inverse;             /* its kernel */
	double *residual;            /* preconditioned */
	unsigned char *active;       /* 1 for cells that contribute to the residual */
	struct extension *extension; /* of the residual beyond the contact */
	struct contact *coarse;      /* grid of half as many cells each way, or NULL */
	struct transfer transfer;    /* to coarse */
	double *coarse_height, *coarse_pressure; /* parts of residual */

	/* the problem being solved */
	const double *h;
	/* The highest of h.  Gaps and approaches are counted from it: those of cells in
	 * contact then keep their digits however far all heights are from 0. */
	double top;
	double *p;
	enum contact_control control;
	double target; /* mean pressure, or approach from first contact */
	double tolerance;
	double work;  /* sum p u, updated since the last contact_gap() */
	double least; /* least u at that call, or 0 */

	/* of the iteration in progress, for the passes over the cells */
	double shift;   /* of the direction, which keeps the load constant */
	double beta;    /* weight of the previous step; also a factor of pressures */
	double tau;     /* predicted step length */
	double stretch; /* its correction by the line search */
	double best;    /* smallest duality gap so far */
	long since;     /* iterations since then */
	double energy;  /* least energy at the last call of contact_gradient_due() */
};

/* A cell is free where its pressure is strictly between the bounds. */
static inline int is_free(const struct contact *c, double p)
{
	return (p > 0) & (p < c->cap);
}

static inline double within(const struct contact *c, double p)
{
	p = p > 0 ? p : 0;
	return p < c->near_cap ? p : c->cap;
}

/* Gap of cell i; the array holds it for approach 0. */
static inline double gap_at(const struct contact *c, size_t i)
{
	return c->gap[i] - c->result.approach;
}

typedef void contact_pass(void *context, size_t begin, size_t end, struct sweep *s);
struct sweep contact_sweep(struct contact *c, contact_pass *pass);
/* The image of the step; returns the sum of their product. */
double contact_multiply_step(struct contact *c);
/* Recomputes the gap from the pressure, and the approach. */
void contact_gap(struct contact *c);
/* Sets the approach: the given one; or the mean gap of the free cells; or, without free
 * cells, the approach with the least duality gap. */
void contact_find_approach(struct contact *c);
/* Sums for the duality gap: sum p g, sum p, sum of g^2 over free cells (for other uses),
 * and over cells with g < 0 sum p g and sum g; the maximum is the deepest overlap. */
struct sweep contact_optimality_sums(struct contact *c);
/* The relative duality gap from these sums. */
double contact_optimality_gap(struct contact *c, const struct sweep *s);
/* The energy that the solution minimises, sum p u / 2 - sum p h, less approach sum p
 * where the approach is given; from the same sums immediately after contact_gap(). */
double contact_energy(const struct contact *c, const struct sweep *s);
/* Approximate pressure on one cell that causes unit displacement there. */
double contact_cell_stiffness(const struct contact *c);
/* Sets cells without pressure to this pressure. */
void contact_fill_empty(struct contact *c, double pressure);
/* 1 if this sum of the pressures is the prescribed load. */
int contact_carries(const struct contact *c, double sum);
/* Scales the free pressures so that they carry the prescribed load.  With gently, leaves
 * them unchanged if the factor would be large.  Returns the sum of the pressures. */
double contact_scale_load(struct contact *c, int gently);
/* If all cells are empty or at the hardness and the load differs from the prescribed one
 * by less than a cell carries, assigns the difference to the cell with the next gap in
 * rank.  sum: of the pressures; returns the new sum. */
double contact_place_rest(struct contact *c, double sum);
/* Finds the shift for which the step of a pass carries the missing load, to slack times
 * the size of the step, by Newton's method with bracketing.  The pass sums step * gap,
 * the step, its size, and the number of cells that remain free, each of which moves by
 * rate times the shift.  s: sums for the present shift; on return those for the last one.
 * Returns the load that is still missing. */
double contact_share_load(struct contact *c, contact_pass *pass, double missing,
	double rate, double slack, struct sweep *s);
/* 1 if the duality gap has not decreased for many calls, because only rounding errors
 * remain or the method fails. */
int contact_stalls(struct contact *c, double optimality_gap);

/* bccg.c: preconditioned bound-constrained conjugate gradients. */
enum num_status contact_make_preconditioner(
	struct contact *c, const struct contact *lender);
enum contact_status contact_solve_bccg(struct contact *c);
/* blocks.c: shifts the direction of a step, in image, block by block, so that bounded it
 * carries in each block what it carries unbounded, but takes no more than is there. */
void contact_keep_load(struct contact *c);

/* pk.c: Polonsky and Keer's single loop. */
enum contact_status contact_solve_pk(struct contact *c);

/* gradient.c: one step of the projected gradient, which always lowers the energy and
 * keeps the load, or restores it.  contact_gap() is to follow. */
void contact_gradient_step(struct contact *c);
/* How many such steps to take: now and then one, while the optimality gap does not fall,
 * and more where the energy has not fallen either.  s: sums just after contact_gap(). */
int contact_gradient_due(struct contact *c, const struct sweep *s);
/* 1 when it is time to ask that. */
int contact_lingers(const struct contact *c);

/* grids.c: between a grid and the next coarser one, down to some 32 cells a side. */
int contact_can_coarsen(const struct contact_par *par, struct contact_par *coarse);
void contact_average_height(struct contact *c);
/* Returns the sum of the pressures. */
double contact_interpolate_pressure(struct contact *c);

#endif
