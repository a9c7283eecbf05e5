/* joint_slopes.c - how chi-square changes with the instrument; see joint.h */
#include "signal/fit/joint_state.h"
#include <string.h>

/* Derivatives of the model of channel c by the logarithms of duration and gain, the
 * pulses held. */
static void draw_slopes(struct joint *j, int c, double *const by[JOINT_SLOPES])
{
	const struct joint_scene *s = &j->scene;

	for (int k = 0; k < JOINT_SLOPES; k++)
		memset(by[k], 0, j->n * sizeof *by[k]);
	for (int i = 0; i < j->m; i++) {
		const struct joint_pulse *p = &j->pulse[i];
		const struct column *col = &j->col[i][c];
		const double T = joint_pulse_duration(s, p, c),
			     a = joint_pulse_height(s, p, c);
		double *value = j->scratch, *by_t = value + j->support,
		       *by_T = by_t + j->support;

		shape_sample(s->shape, p->t + (c ? p->delta : 0), T, col->first, col->n,
			value, by_t, by_T);
		add_scaled(by[JOINT_DURATION] + col->first, a * T, by_T, col->n);
		if (c)
			add_scaled(by[JOINT_GAIN] + col->first, a, value, col->n);
	}
	for (int k = 0; k < JOINT_SLOPES; k++)
		joint_hide(j, c, 0, j->n, by[k]);
}

int joint_add_slopes(struct joint *j, struct joint_slopes *sum)
{
	const int np = PAR * j->m, nb = 2 * j->basis;
	double with[JOINT_SLOPES][NPAR] = { { 0 } }, moved[NPAR];

	if (joint_factorise(j, j->all, j->m) != NUM_OK)
		return 0;
	for (int c = 0; c < 2; c++) {
		double *by[JOINT_SLOPES] = { j->filter[0], j->filter[1] };
		double along[JOINT_SLOPES][BASIS_MAX];

		draw_slopes(j, c, by);
		for (int k = 0; k < JOINT_SLOPES; k++) {
			joint_along_all(j, c, 0, by[k], j->n, along[k]);
			sum->gradient[k] += dot(by[k], j->e[c], j->n) -
					    dot(along[k], j->qe[c], (size_t)j->basis);
			for (int l = 0; l <= k; l++)
				sum->curvature[k][l] +=
					dot(by[k], by[l], j->n) -
					dot(along[k], along[l], (size_t)j->basis);
			for (int x = 0; x < np; x++) {
				const struct column *col = &j->col[x / PAR][c];

				with[k][x] +=
					dot(col->d[x % PAR], by[k] + col->first, col->n) -
					dot(j->bq + x * nb + c * j->basis, along[k],
						(size_t)j->basis);
			}
		}
	}
	for (int k = 0; k < JOINT_SLOPES; k++) {
		memcpy(moved, with[k], (size_t)np * sizeof *moved);
		joint_solve(j, np, moved);
		sum->gradient[k] -= dot(moved, j->gradient, (size_t)np);
		for (int l = 0; l <= k; l++)
			sum->curvature[k][l] -= dot(moved, with[l], (size_t)np);
	}
	return 1;
}
