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
	const int np = PAR * j->m;
	double with[JOINT_SLOPES][NPAR] = { { 0 } }, moved[NPAR];

	if (joint_factorise(j, j->all, j->m) != NUM_OK)
		return 0;
	for (int c = 0; c < 2; c++) {
		double *by[JOINT_SLOPES] = { j->filter[0], j->filter[1] };
		double along[JOINT_SLOPES][BASIS_MAX];
		struct piece slope[JOINT_SLOPES], e = { 0, j->n, j->e[c], j->qe[c] };

		draw_slopes(j, c, by);
		for (int k = 0; k < JOINT_SLOPES; k++) {
			joint_along(j, c, j->basis->vectors, 0, by[k], j->n, along[k]);
			slope[k] = (struct piece){ 0, j->n, by[k], along[k] };
			sum->gradient[k] += joint_inner(j, slope[k], e);
			for (int l = 0; l <= k; l++)
				sum->curvature[k][l] +=
					joint_inner(j, slope[k], slope[l]);
			for (int x = 0; x < np; x++)
				with[k][x] += joint_inner(j,
					joint_column(j, x / PAR, x / PAR, x % PAR, c),
					slope[k]);
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
