/* network_state.h - members of struct network, for network*.c only */
#ifndef NET_NETWORK_STATE_H
#define NET_NETWORK_STATE_H

#include "net/network.h"
#include "num/grid.h"
#include <gsl/gsl_cblas.h>

#ifdef NETWORK_DOUBLE
#define gemm cblas_dgemm
#else
#define gemm cblas_sgemm
#endif

typedef network_real real;

struct layer {
	struct network_layer par;
	struct network_shape in, out;
	int inputs, outputs; /* values per sample */
	int fan;             /* values that one unit sees */
	size_t weight, bias; /* where they begin in the vector of weights */
	real *value;         /* batch rows of outputs */
	real *slope;         /* loss by output, same shape */
	int *choice;         /* pool: index of the largest input */
};

struct network {
	int layers, batch;
	struct layer layer[NETWORK_LAYERS_MAX];
	size_t count;
	real *weights;
	real *columns; /* unfolded input of a convolution, one sample */
	real *unit;    /* slope by the sums before the activation, batch rows */
};

/* Row s of a batch of rows of n values. */
static inline size_t network_row(int n, int s)
{
	return grid_at(n, 0, s);
}

/* Where the units of a dense or cascade layer begin in a row of its output. */
static inline int network_first_unit(const struct layer *l)
{
	return l->par.kind == NETWORK_CASCADE ? l->inputs : 0;
}

/* Unfolds one sample x: row (channel, kernel row, kernel column), column = output place.
 * Unless back is NULL the rows are instead added to back where they came from. */
void network_unfold(const struct layer *l, const real *x, real *columns, real *back);

#endif
