/* student.h - quantiles of Student's distribution */
#ifndef NUM_STUDENT_H
#define NUM_STUDENT_H

/* The t with P(|T| <= t) = share, 0 < share < 1, for freedom >= 1 degrees of freedom. */
double student_two_sided(double share, long freedom);

#endif
