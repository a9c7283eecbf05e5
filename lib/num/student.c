#include "num/student.h"
#include <math.h>

/* P(|T| <= t), by the finite series (Abramowitz and Stegun, 26.7.3 and 26.7.4). */
static double two_sided(double t, long freedom)
{
	double angle = atan(t / sqrt((double)freedom)), c = cos(angle), c2 = c * c;
	double term = freedom % 2 ? c : 1, sum = 0;

	for (long k = freedom % 2 ? 1 : 0; k <= freedom - 2; k += 2) {
		sum += term;
		term *= c2 * (double)(k + 1) / (double)(k + 2);
	}
	return freedom % 2 ? 2 / M_PI * (angle + sin(angle) * sum) : sin(angle) * sum;
}

double student_two_sided(double share, long freedom)
{
	double low = 0, high = 1;

	while (two_sided(high, freedom) < share && high < 1e300)
		high *= 2;
	for (int k = 0; k < 80; k++) {
		double middle = 0.5 * (low + high);

		if (two_sided(middle, freedom) < share)
			low = middle;
		else
			high = middle;
	}
	return 0.5 * (low + high);
}

double student_log_constant(double freedom)
{
	return lgamma(0.5 * (freedom + 1)) - lgamma(0.5 * freedom) -
	       0.5 * log(freedom * M_PI);
}

double student_square(double deviate, double freedom)
{
	double wide = (8 * freedom + 3) / (8 * freedom + 1) * deviate;

	return freedom * expm1(fmin(600, wide * wide / freedom));
}
