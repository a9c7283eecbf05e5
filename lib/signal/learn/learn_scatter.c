/* learn_scatter.c - see examples.h */
#include "num/sigmas.h"
#include "signal/learn/examples.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* 1 if pulses that overlap little, with something of their own, which leave so much more
 * than dof, describe an event as well as more of them do without, at their price. */
static int explain_events(const struct examples *ex, const struct example *few,
	const struct example *all, double left, double dof)
{
	return (few->m == 1 || few->m == all->m) &&
	       left <= CHI_SQUARE_MORE * dof + SIGMAS_NEVER * sqrt(2 * dof) &&
	       left <= all->excess + 2 * ex->scene.threshold_near * (all->m - few->m);
}

/* Takes the scatter of what pulses of the events in rough have of their own, in this set,
 * for that of the scene; returns by how much more it explains than it leaves, 0 unless
 * everything in the set scatters. */
static double try_scatter(struct examples *ex, struct examples *rough, unsigned set,
	struct joint_scene *scene)
{
	struct joint_deviation own[JOINT_OWN][EXAMPLES_MAX * EXAMPLE_PULSES];
	_Static_assert(sizeof own[0] <= JOINT_SCATTER_MAX * sizeof own[0][0],
		"joint_scatter() takes all pulses of the examples");
	struct joint_result result;
	double explained, left, balance = 0;
	size_t n = 0, m;

	for (int i = 0; i < ex->count && ex->status == SEPARATE_OK; i++) {
		struct example *few = &rough->example[i];
		struct joint_deviation *out[JOINT_OWN];

		if (examples_refine(rough, few, few->pulse, &result) != JOINT_OK)
			continue;
		for (int k = 0; k < JOINT_OWN; k++)
			out[k] = own[k] + n;
		m = joint_deviations(ex->joint, set, out, &explained);
		for (int k = 0; k < JOINT_OWN; k++)
			for (size_t p = 0; p < m && set >> k & 1; p++)
				out[k][p].at += (double)few->begin;
		left = result.chi2 - (double)result.dof - explained;
		if (explain_events(ex, few, &ex->example[i], left, (double)result.dof)) {
			n += m;
			balance += explained - left;
		}
	}
	for (int k = 0; k < JOINT_OWN; k++) {
		double scatter;

		if (!(set >> k & 1) || !(balance > 0))
			continue;
		scatter = joint_scatter(k, own[k], n, LIKELIHOOD_CERTAIN);
		joint_set_scatter(
			scene, k, scatter, own[k], n, fmax(scene->misfit, ex->share));
		balance = scatter > 0 ? balance : 0;
	}
	return fmax(balance, 0);
}

/* Only events that single pulses do not describe can show scatter, and only if it
 * explains most of what these leave: pulses of another shape look wider or narrower where
 * they overlap. */
int learn_scatter(struct examples *ex, struct calibration *c)
{
	struct examples *rough; /* large for a stack */
	double best = 0;

	if (examples_pulses(ex) <= ex->count &&
		ex->excess <= SIGMAS_SELDOM * sqrt(2 * ex->dof))
		return 0;
	rough = malloc(sizeof *rough);
	if (!rough) {
		ex->status = SEPARATE_MEMORY;
		return 0;
	}
	*rough = *ex;
	examples_fit(rough, EXAMPLES_ROUGH);
	ex->status = rough->status;
	for (unsigned set = 1; set < 1U << JOINT_OWN; set++) {
		struct joint_scene scene = rough->scene;
		double balance;

		scene.misfit = 0;
		balance = try_scatter(ex, rough, set, &scene);
		if (balance > best) {
			best = balance;
			memcpy(ex->scene.scatter, scene.scatter, sizeof scene.scatter);
			ex->scene.misfit = scene.misfit;
		}
	}
	free(rough);
	if (!(best > 0))
		return 0;
	memcpy(c->scatter, ex->scene.scatter, sizeof c->scatter);
	ex->misfit = fmax(ex->misfit, ex->scene.misfit);
	return 1;
}
