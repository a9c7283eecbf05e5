#include "contact_options.h"
#include "cli/msg.h"
#include "contact/kernel.h"
#include <math.h>
#include <string.h>

struct press press = { .load = NAN,
	.pressure = NAN,
	.approach = NAN,
	.estar = NAN,
	.tolerance = 1e-8,
	.poisson = { 1, { 0.3 } },
	.max_iterations = 10000,
	.threads = 1 };

static const char *const boundaries[] = { "free", "periodic", NULL };
static const char *const multipliers[] = { "fft", "mlms", NULL };
static const char *const solvers[] = { "bccg", "pk", NULL };

struct opt press_rows[] = {
	OPT_HEADING("Contact"),
	{ 'F', "load", OPT_NUM, UNIT_FORCE, &press.load, 0, 1e30, "F", "normal load", 0,
		0 },
	{ 0, "pressure", OPT_NUM, UNIT_PRESSURE, &press.pressure, 0, 1e30, "P",
		"mean pressure, in place of a load", 0, 0 },
	{ 0, "approach", OPT_NUM, UNIT_LENGTH, &press.approach, -1e12, 1e12, "D",
		"displacement of the flat past height 0, in place of a load", 0, 0 },
	{ 'E', "young", OPT_LIST, UNIT_PRESSURE, &press.young, 1e-6, 1e30, "E1[,E2]",
		"Young's moduli of the bodies; one for both", 0, 0 },
	{ 0, "poisson", OPT_LIST, UNIT_NONE, &press.poisson, -0.999, 0.5, "N1[,N2]",
		"Poisson's ratios of the bodies; one for both", 0, 0 },
	{ 0, "estar", OPT_NUM, UNIT_PRESSURE, &press.estar, 1e-6, 1e30, "E",
		"contact modulus, in place of --young", 0, 0 },
	{ 0, "boundary", OPT_WORD, UNIT_NONE, &press.boundary, 0, 0, "free|periodic",
		"surface around the grid without load, or the grid repeated", boundaries,
		0 },
	{ 0, "hardness", OPT_NUM, UNIT_PRESSURE, &press.hardness, 0, 1e30, "H",
		"largest pressure; 0: none", 0, 0 },
	OPT_HEADING("Contact: accuracy and method"),
	{ 0, "tolerance", OPT_NUM, UNIT_NONE, &press.tolerance, 1e-16, CONTACT_LOOSEST,
		"T", "relative duality gap at which the iteration stops", 0, 0 },
	{ 0, "max-iterations", OPT_INT, UNIT_COUNT, &press.max_iterations, 1, 1e9, "N",
		"maximum number of iterations", 0, 0 },
	{ 0, "solver", OPT_WORD, UNIT_NONE, &press.solver, 0, 0, "bccg|pk",
		"preconditioned conjugate gradients, or Polonsky and Keer's", solvers,
		0 },
	{ 0, "multiply", OPT_WORD, UNIT_NONE, &press.multiply, 0, 0, "fft|mlms",
		"displacement by Fourier transform or multi-level summation", multipliers,
		0 },
	{ 'j', "threads", OPT_INT, UNIT_COUNT, &press.threads, 1, 1024, "N",
		"number of threads; the result does not depend on it", 0, 1 },
	OPT_END,
};

void press_check(void)
{
	const struct opt_list *e = &press.young, *nu = &press.poisson;

	if (!isnan(press.load) + !isnan(press.pressure) + !isnan(press.approach) > 1)
		die(EXIT_USAGE, "specify only one of --load, --pressure and --approach");
	for (int i = 0; i < e->n; i++)
		if (e->v[i] < 1e5)
			warn("--young %g Pa is softer than any solid surface: is %gGPa meant?",
				e->v[i], e->v[i]);
	if (!isnan(press.estar) && e->n)
		die(EXIT_USAGE, "specify either --estar or --young and --poisson");
	if (press.multiply && press.boundary)
		die(EXIT_USAGE, "--multiply mlms requires --boundary free");
	if (e->n)
		press.estar = kernel_modulus(
			e->v[0], nu->v[0], e->v[e->n - 1], nu->v[nu->n - 1]);
}

/* Number of a key that bemcontact wrote, for an option that was not given. */
static double inherited(
	const struct record *r, const char *key, const char *word, double value)
{
	double v = record_get_number(r, key);

	return opt_given(word) || isnan(v) ? value : v;
}

struct contact_par press_par(const struct record *r, struct pool *pool)
{
	const char *around = record_get(r, "boundary");
	int periodic = opt_given("boundary") || !around ? press.boundary
							: strcmp(around, "periodic") == 0;

	if (periodic && press.multiply)
		die(EXIT_USAGE,
			"--multiply mlms requires --boundary free, and the record is periodic");
	return (struct contact_par){ .nx = r->nx,
		.ny = r->ny,
		.dx = r->dx,
		.dy = r->dy,
		.estar = isnan(press.estar) ? record_get_number(r, "estar") : press.estar,
		.hardness = inherited(r, "hardness", "hardness", press.hardness),
		.boundary = periodic ? CONTACT_PERIODIC : CONTACT_FREE,
		.solver = (enum contact_solver)press.solver,
		.multiply = (enum contact_multiply)press.multiply,
		.tolerance = press.tolerance,
		.max_iterations = press.max_iterations,
		.pool = pool };
}

void press_differs(const char *name, long number, const char *what, const char *unit,
	double asked, double solved)
{
	/* Loads are sums, and moduli are computed anew from those of the bodies. */
	if (fabs(asked - solved) > 1e-6 * fabs(solved))
		warn("%s: record %ld: its contact was solved with %s of %g %s, not %g %s as the options say",
			name, number, what, solved, unit, asked, unit);
}

const char press_not_converged[] = "a contact did not converge";

const char *press_given(const struct record *r, const char *name, long number)
{
	const char *converged = record_get(r, "converged"),
		   *around = record_get(r, "boundary");
	double hardness = record_get_number(r, "hardness");
	const char *why = NULL;

	press_differs(name, number, "a contact modulus", "Pa", press.estar,
		record_get_number(r, "estar"));
	/* A record with a boundary and no hardness was solved without one. */
	if (around && opt_given("hardness"))
		press_differs(name, number, "a hardness", "Pa", press.hardness,
			isnan(hardness) ? 0 : hardness);
	if (around && opt_given("boundary") &&
		strcmp(around, boundaries[press.boundary]) != 0) {
		warn("%s: record %ld: its contact was solved with a %s boundary, not a %s one as the options say",
			name, number, around, boundaries[press.boundary]);
		why = "stress and contact have different boundaries";
	}
	if (record_get(r, "coating"))
		die(EXIT_RUN,
			"%s: record %ld is the contact of a coated body: want bodies of one material",
			name, number);
	if (!converged || strcmp(converged, "no") != 0)
		return why;
	warn("%s: record %ld: its contact did not converge", name, number);
	return press_not_converged;
}

void press_record(struct record *r, const struct contact_par *par)
{
	if (!isnan(par->estar))
		record_set(r, "estar", "%.17g", par->estar);
	record_set(r, "boundary", "%s", boundaries[par->boundary]);
	if (par->hardness > 0)
		record_set(r, "hardness", "%.17g", par->hardness);
}

void press_forget(struct record *r)
{
	static const char *const found[] = { "load", "mean_pressure", "approach",
		"indentation", "area", "plastic_area", "energy", "optimality_gap",
		"iterations", "converged", "edge_load", "friction", "tangential_load",
		"tangential_displacement", "stick_area", "flow_depth", "flow_volume",
		NULL };

	for (int k = 0; found[k]; k++)
		record_drop_key(r, found[k]);
}

int press_same(const struct contact_par *a, const struct contact_par *b)
{
	return a->nx == b->nx && a->ny == b->ny && a->dx == b->dx && a->dy == b->dy &&
	       a->hardness == b->hardness && a->boundary == b->boundary &&
	       (a->estar == b->estar || (isnan(a->estar) && isnan(b->estar)));
}

enum contact_control press_control(void)
{
	return isnan(press.approach) ? CONTACT_PRESSURE : CONTACT_APPROACH;
}

double press_target(const struct record *r)
{
	if (!isnan(press.approach))
		return press.approach;
	if (!isnan(press.pressure))
		return press.pressure;
	return press.load / (r->nx * r->dx * r->ny * r->dy);
}
