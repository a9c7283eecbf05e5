/* running.h - mean and variance of values that come one by one */
#ifndef NUM_RUNNING_H
#define NUM_RUNNING_H

struct running {
	double n, mean;
	double square; /* sum of the squares about the mean */
};

void running_add(struct running *r, double x);
/* The same value so often; nothing for times <= 0. */
void running_repeat(struct running *r, double x, double times);
double running_variance(const struct running *r); /* over n - 1; NAN below two values */

#endif
