/* state.h - what the solvers of lib/contact share; for lib/contact only */
#ifndef CONTACT_STATE_H
#define CONTACT_STATE_H

#include "contact/extension.h"
#include "contact/mlms.h"
#include "contact/problem.h"
#include "contact/transfer.h"
#include "num/convolve.h"
#include "num/sweep.h"
#include <math.h>

struct contact {
	struct contact_par par;
	size_t n;               /* cells */
	double cap;             /* hardness or INFINITY */
	double near_cap;        /* the same less rounding */
	struct convolve *plane; /* transforms of displacement = kernel * pressure */
	double *kernel;
	struct contact_kernel body; /* whose displacement that is */
	struct mlms *mlms;          /* in place of those two */
	double *memory;             /* holds the arrays below, unless borrowed */
	double *gap;                /* g */
	double *step, *image;       /* step of the pressure, and its displacement */
	struct contact_result result;

	/* preconditioned solver only */
	struct convolve *periodic;   /* transforms of the preconditioner */
	double *inverse;             /* its kernel */
	double *residual;            /* g on the contact, then preconditioned */
	unsigned char *active;       /* 1 for the cells the residual was taken of */
	struct extension *extension; /* of the residual beyond the contact */
	struct contact *coarse;      /* grid of half as many cells each way, or NULL */
	struct transfer transfer;    /* to it */
	double *coarse_height, *coarse_pressure; /* parts of residual */

	/* the problem being solved */
	const double *h;
	double *p;
	enum contact_control control;
	double target; /* mean pressure or approach */
	double tolerance;
	double work;  /* sum p u, followed from the last contact_gap() on */
	double least; /* least u then, or 0 */

	/* of the iteration in progress, for the passes over the cells */
	double shift;   /* of the direction, that the load is kept */
	double beta;    /* share of the last step; also a factor of pressures */
	double tau;     /* step length that is guessed */
	double stretch; /* ... and what the line search makes of it */
	double best;    /* certificate so far, and the iterations since */
	long since;
	double energy; /* least when contact_gradient_due() looked */
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
/* y = K x, counted; y is not x.  Returns the sum of x y. */
double contact_multiply(struct contact *c, const double *x, double *y);
/* Gap of the pressure from scratch, and the approach. */
void contact_gap(struct contact *c);
/* The approach that is given; or the mean gap of the free cells, or where there are none
 * the one of least duality gap. */
void contact_find_approach(struct contact *c);
/* What the certificate is made of: sum p g, sum p, sum of g^2 over free cells (not needed
 * for it), and where g < 0 sum p g and sum g; the deepest overlap as the maximum. */
struct sweep contact_certify(struct contact *c);
/* The certificate from these sums. */
double contact_certificate(struct contact *c, const struct sweep *s);
/* What the solution makes least, sum p u / 2 - sum p h, from the same sums just after
 * contact_gap(). */
double contact_energy(const struct contact *c, const struct sweep *s);
/* Displacement by a pressure all over the grid, roughly: that of a wave of its length,
 * times pi. */
double contact_sinking(const struct contact *c, double pressure);
/* Pressure on a cell that makes unit displacement there, roughly. */
double contact_cell_stiffness(const struct contact *c);
/* Gives this pressure to the cells that have none. */
void contact_fill_empty(struct contact *c, double pressure);
/* 1 if this sum of the pressures is the wanted load. */
int contact_carries(const struct contact *c, double sum);
/* Scales the free pressures so that the load is the wanted one, or leaves them where
 * gently and that is more than a matter of scale.  Returns the sum of the pressures. */
double contact_scale_load(struct contact *c, int gently);
/* Where all cells are empty or at the hardness and the load falls short or beyond by less
 * than a cell, the cell whose gap is next in rank takes the rest.  sum: of the pressures;
 * returns the new one. */
double contact_place_rest(struct contact *c, double sum);
/* Finds the shift with which the step of a pass carries what is missing of the load, to
 * slack times the size of the step: Newton's method, kept within what is known to be too
 * little and too much.  The pass sums step * gap, the step, its size, and the cells that
 * it leaves free, each of which moves by rate times the shift; s: those of the present
 * shift, and on return those of the last.  Returns what is left missing. */
double contact_share_load(struct contact *c, contact_pass *pass, double missing,
	double rate, double slack, struct sweep *s);
/* 1 where the certificate has long stopped falling: rounding is all that is left, or
 * the method fails.  Keeps count of calls. */
int contact_stalls(struct contact *c, double certificate);

#endif
