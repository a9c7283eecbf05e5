/* interval.h - confidence intervals of sums over the events of a Poisson process
 *
 * Each event has a weight w. The interval of the expected sum is that of Fay and Feuer,
 * Stat. Med. 16 (1997) 791: a gamma distribution with the mean and variance of the
 * observed sum, for the upper limit with one more event of the largest weight. With
 * equal weights it is the exact interval of a Poisson count (Garwood 1936).
 *
 *	struct weighted s = { 0 };
 *	for (i = 0; i < n; i++)
 *		weighted_add(&s, mass[i]);
 *	weighted_interval(&s, largest, 0.95, &low, &high);
 */
#ifndef COUNT_INTERVAL_H
#define COUNT_INTERVAL_H

struct weighted {
	double n, sum, squares, largest; /* events, sum w, sum w^2, max w */
};

void weighted_add(struct weighted *s, double w);

/* largest: the largest possible weight of an unobserved event; INFINITY makes the upper
 * limit infinite. */
void weighted_interval(const struct weighted *s, double largest, double confidence,
	double *low, double *high);

#endif
