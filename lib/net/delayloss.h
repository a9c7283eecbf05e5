/* delayloss.h - losses and scores of an unordered set of delays
 *
 * The outputs of a delay network are a set: any permutation of the delays is equally
 * correct. In one dimension the permutation with the smallest sum of squared differences
 * pairs both sets in sorted order, so the minimum over all n! permutations in (3-21)
 * needs one sort.
 */
#ifndef NET_DELAYLOSS_H
#define NET_DELAYLOSS_H

#include "net/network.h"

enum { DELAYS_MAX = 16 }; /* most outputs */

enum delayloss_penalty {
	DELAYLOSS_SQUARED, /* phi = (var output - var label)^2 */
	DELAYLOSS_ABSOLUTE /* phi = |var output - var label| */
};

struct delayloss_par {
	double lambda; /* coefficient of the penalty phi */
	enum delayloss_penalty penalty;
};

/* Loss (3-20) with context struct delayloss_par: the mean over samples of
 * (sum of labels - sum of outputs)^2 + lambda phi.  The variance is that of the
 * delays of one sample about their mean, divided by their number. */
network_loss delayloss_sums;

/* Mean squared difference in the best order of each sample: (3-21) as a loss. */
network_loss delayloss_unordered;

struct delayscore {
	long samples;
	double ordered;   /* mean squared difference, output by output */
	double unordered; /* (3-21): in the best order */
	double sorted;    /* outputs as they come against labels in order of size */
	double sums;      /* mean of (3-20) */
	double ordered_se, unordered_se; /* standard errors over the samples */
};

/* Adds n samples of width (<= DELAYS_MAX) delays; start from a zeroed struct.  While
 * adding, the means are sums; delayscore_finish() divides. */
void delayscore_add(struct delayscore *score, const struct delayloss_par *par, int n,
	int width, const network_real *output, const network_real *label);
void delayscore_finish(struct delayscore *score);

/* Mean squared errors of predictors without data, for width independent labels uniform in
 * (0, 1), for comparison with every result. */
struct delaylevels {
	double constant;        /* output 1/2: 1/12 */
	double constant_sorted; /* means of the sorted labels, against sorted: 1/24 for 3
				 */
	double sorted_ordered;  /* the same outputs against unsorted labels: 1/8 for 3 */
	double draw;            /* independent uniform outputs: 1/6 */
};

struct delaylevels delaylevels(int width);

#endif
