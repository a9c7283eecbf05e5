/* student.h - quantiles and density of Student's distribution */
#ifndef NUM_STUDENT_H
#define NUM_STUDENT_H

/* The t with P(|T| <= t) = share, 0 < share < 1, for freedom >= 1 degrees of freedom. */
double student_two_sided(double share, long freedom);

/* log of the density at 0 for scale 1: that at t is (1 + t^2 / freedom)^(-(freedom + 1) /
 * 2) of it. */
double student_log_constant(double freedom);

#endif
