/* state.h - what the solvers of lib/contact share; for lib/contact only */
#ifndef CONTACT_STATE_H
#define CONTACT_STATE_H

#include "contact/solver.h"
#include "num/convolve.h"
#include "num/sweep.h"

struct contact {
	struct contact_par par;
	size_t n;               /* cells */
	double cap;             /* hardness or INFINITY */
	struct convolve *plane; /* transforms of displacement = kernel * pressure */
	double *kernel;
	double *gap, *step, *image; /* gap g, direction t and its displacement K t */
	struct contact_result result;

	/* the problem being solved */
	const double *h;
	double *p;
	enum contact_control control;
	double target; /* mean pressure or approach */
	double scale;  /* length that makes the certificate a number */

	/* of the iteration in progress, for the passes over the cells */
	double shift, beta, tau;
};

/* A cell is free where its pressure is strictly between the bounds. */
static inline int is_free(const struct contact *c, double p)
{
	return p > 0 && p < c->cap;
}

struct sweep contact_sweep(struct contact *c,
	void (*pass)(void *context, size_t begin, size_t end, struct sweep *s));
/* y = K x, counted. */
void contact_multiply(struct contact *c, const double *x, double *y);
/* Gap of the pressure from scratch, up to the approach. */
void contact_gap(struct contact *c);
/* With the gap up to the approach: sets the approach, takes it off the gap and
 * returns the certificate.  moments, unless NULL: sum of g^2 over the free cells. */
double contact_certify(struct contact *c, double *moment);
/* Scales the free pressures so that the load is the wanted one. */
void contact_scale_load(struct contact *c);

enum contact_status contact_solve_pk(struct contact *c);

#endif
