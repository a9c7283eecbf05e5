#include "num/sym3.h"

#include <math.h>
#include <stddef.h>

/* One rotation that makes a[p][q] zero; columns of v follow. */
static void rotate(double a[3][3], double v[3][3], int p, int q)
{
	double theta, t, c, s;

	if (a[p][q] == 0)
		return;
	theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
	t = copysign(1, theta) / (fabs(theta) + hypot(theta, 1));
	c = 1 / sqrt(t * t + 1);
	s = t * c;
	a[p][p] -= t * a[p][q];
	a[q][q] += t * a[p][q];
	a[p][q] = a[q][p] = 0;
	for (int k = 0; k < 3; k++) {
		if (k != p && k != q) {
			double kp = a[k][p], kq = a[k][q];

			a[k][p] = a[p][k] = c * kp - s * kq;
			a[k][q] = a[q][k] = s * kp + c * kq;
		}
		double vp = v[k][p], vq = v[k][q];

		v[k][p] = c * vp - s * vq;
		v[k][q] = s * vp + c * vq;
	}
}

static void orient(double vector[3])
{
	int big = 0;

	for (int k = 1; k < 3; k++)
		if (fabs(vector[k]) > fabs(vector[big]))
			big = k;
	if (vector[big] < 0)
		for (int k = 0; k < 3; k++)
			vector[k] = -vector[k];
}

void sym3_eigen(const double m[6], double value[3], double vector[3][3])
{
	double a[3][3] = { { m[0], m[3], m[4] }, { m[3], m[1], m[5] },
		{ m[4], m[5], m[2] } };
	double v[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	int order[3] = { 0, 1, 2 };

	/* Convergence is quadratic: six sweeps are more than a double can use. */
	for (int sweep = 0; sweep < 8; sweep++) {
		if (a[0][1] == 0 && a[0][2] == 0 && a[1][2] == 0)
			break;
		rotate(a, v, 0, 1);
		rotate(a, v, 0, 2);
		rotate(a, v, 1, 2);
	}
	for (int i = 0; i < 2; i++)
		for (int j = i + 1; j < 3; j++)
			if (a[order[j]][order[j]] > a[order[i]][order[i]]) {
				int t = order[i];

				order[i] = order[j];
				order[j] = t;
			}
	for (int i = 0; i < 3; i++) {
		value[i] = a[order[i]][order[i]];
		if (!vector)
			continue;
		for (int k = 0; k < 3; k++)
			vector[i][k] = v[k][order[i]];
		orient(vector[i]);
	}
}
