/* student.h - quantiles and density of Student's distribution */
#ifndef NUM_STUDENT_H
#define NUM_STUDENT_H

/* The t with P(|T| <= t) = share, 0 < share < 1, for freedom >= 1 degrees of freedom. */
double student_two_sided(double share, long freedom);

/* Log of the density at t = 0 for scale 1; the density at t is this density times
 * (1 + t^2 / freedom)^(-(freedom + 1) / 2). */
double student_log_constant(double freedom);

/* The square of the t that is as rare as a normal deviate of this size (Wallace, Ann.
 * Math. Stat. 30 (1959) 1124); larger the fewer the degrees of freedom. */
double student_square(double deviate, double freedom);

#endif
