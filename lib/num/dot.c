/* dot.c - see dot.h */
#include "num/dot.h"

/* Sums of four partial sums each, of which the first takes the last n % 4 products too.
 */
static inline void total(const lanes4 *a0, const lanes4 *a1, const lanes4 *a2,
	const double *x, const double *const y[3], size_t n, double out[3])
{
	double first[3] = { (*a0)[0], (*a1)[0], (*a2)[0] };

	for (size_t i = n - n % 4; i < n; i++) {
		first[0] += x[i] * y[0][i];
		first[1] += x[i] * y[1][i];
		first[2] += x[i] * y[2][i];
	}
	out[0] = (first[0] + (*a0)[1]) + ((*a0)[2] + (*a0)[3]);
	out[1] = (first[1] + (*a1)[1]) + ((*a1)[2] + (*a1)[3]);
	out[2] = (first[2] + (*a2)[1]) + ((*a2)[2] + (*a2)[3]);
}

LANES_CLONES void dot3(const double *x, const double *const y[3], size_t n, double out[3])
{
	const double *y0 = y[0], *y1 = y[1], *y2 = y[2];
	lanes4 a0 = { 0 }, a1 = { 0 }, a2 = { 0 }, p, q0, q1, q2;

	for (size_t i = 0; i + 4 <= n; i += 4) {
		memcpy(&p, x + i, sizeof p);
		memcpy(&q0, y0 + i, sizeof p);
		memcpy(&q1, y1 + i, sizeof p);
		memcpy(&q2, y2 + i, sizeof p);
		a0 += p * q0;
		a1 += p * q1;
		a2 += p * q2;
	}
	total(&a0, &a1, &a2, x, y, n, out);
}

LANES_CLONES void dot9(
	const double *const x[3], const double *const y[3], size_t n, double out[3][3])
{
	const double *x0 = x[0], *x1 = x[1], *x2 = x[2];
	const double *y0 = y[0], *y1 = y[1], *y2 = y[2];
	lanes4 a0 = { 0 }, a1 = { 0 }, a2 = { 0 }, b0 = { 0 }, b1 = { 0 }, b2 = { 0 };
	lanes4 c0 = { 0 }, c1 = { 0 }, c2 = { 0 }, p, q0, q1, q2;

	for (size_t i = 0; i + 4 <= n; i += 4) {
		memcpy(&q0, y0 + i, sizeof p);
		memcpy(&q1, y1 + i, sizeof p);
		memcpy(&q2, y2 + i, sizeof p);
		memcpy(&p, x0 + i, sizeof p);
		a0 += p * q0;
		a1 += p * q1;
		a2 += p * q2;
		memcpy(&p, x1 + i, sizeof p);
		b0 += p * q0;
		b1 += p * q1;
		b2 += p * q2;
		memcpy(&p, x2 + i, sizeof p);
		c0 += p * q0;
		c1 += p * q1;
		c2 += p * q2;
	}
	total(&a0, &a1, &a2, x0, y, n, out[0]);
	total(&b0, &b1, &b2, x1, y, n, out[1]);
	total(&c0, &c1, &c2, x2, y, n, out[2]);
}

LANES_CLONES void add_scaled(double *y, double factor, const double *x, size_t n)
{
	lanes4 p, q;
	size_t i = 0;

	for (; i + 4 <= n; i += 4) {
		memcpy(&p, x + i, sizeof p);
		memcpy(&q, y + i, sizeof p);
		q += factor * p;
		memcpy(y + i, &q, sizeof p);
	}
	for (; i < n; i++)
		y[i] += factor * x[i];
}
