#include "contact/slip.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "common/contact_options.h"
#include "task.h"
#include <math.h>

static double friction = NAN, tangential = NAN;

struct opt slip_rows[] = {
	OPT_HEADING("Tangential load"),
	{ 0, "tangential", OPT_NUM, UNIT_FORCE, &tangential, 0, 1e30, "T",
		"tangential load, along x, on top of the normal one: partial slip", 0,
		0 },
	{ 'u', "friction", OPT_NUM, UNIT_FRACTION, &friction, 1e-12, 1e6, "MU",
		"friction coefficient: the largest shear over pressure", 0, 0 },
	OPT_END,
};

int slip_wanted(void)
{
	return !isnan(tangential);
}

static struct slip_bodies bodies(void)
{
	const struct opt_list *e = &press.young, *nu = &press.poisson;

	return (struct slip_bodies){ { e->v[0], e->v[e->n - 1] },
		{ nu->v[0], nu->v[nu->n - 1] } };
}

void slip_check(void)
{
	struct slip_bodies b = bodies();

	if (isnan(tangential) != isnan(friction))
		die(EXIT_USAGE, "--tangential and --friction need one another");
	if (!slip_wanted())
		return;
	if (!press.young.n)
		die(EXIT_USAGE,
			"--tangential: want the materials: --young and --poisson");
	if (press.hardness > 0)
		die(EXIT_USAGE, "--tangential is for elastic bodies: want no --hardness");
	if (!slip_uncoupled(&b))
		die(EXIT_USAGE,
			"--tangential: want bodies with the same (1 - 2 nu) (1 + nu) / E, "
			"such as two of one material: shear parts others");
}

int slip_solve(const struct task *t, const struct contact_result *normal, double *shear)
{
	double area = t->par.nx * t->par.dx * t->par.ny * t->par.dy;
	struct slip_bodies b = bodies();
	struct slip_result found;
	enum contact_status status;
	double along;

	if (t->par.hardness > 0)
		die(EXIT_RUN,
			"%s: record %ld: a hardness of %g Pa: --tangential is for elastic bodies",
			t->name, t->number, t->par.hardness);
	status = contact_slip(
		t->c, t->h, t->p, normal, friction, tangential / area, shear, &found);
	if (status == CONTACT_OVERLOAD)
		die(EXIT_RUN,
			"%s: record %ld: --tangential %g N slips: friction bears %g N",
			t->name, t->number, tangential, friction * normal->load);
	if (status == CONTACT_NOCONV)
		warn("%s: record %ld: part that sticks not converged: optimality gap %.2g",
			t->name, t->number, contact_result(t->c)->optimality_gap);
	if (slip_along(t->c, shear, &along) != NUM_OK)
		die(EXIT_RUN, "no memory");
	count_work(contact_result(t->c), 1);
	record_set(t->r, "friction", "%.17g", friction);
	record_set(t->r, "tangential_load", "%.17g", found.load);
	record_set(t->r, "tangential_displacement", "%.17g",
		slip_compliance(&b, along) * found.displacement);
	record_set(t->r, "stick_area", "%.17g", found.stick);
	return status == CONTACT_OK;
}
