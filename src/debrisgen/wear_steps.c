#include "wear_steps.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "common/contact_options.h"
#include "contact/solver.h"
#include <math.h>
#include <stdlib.h>

static const char *const axes[] = { "x", "y", NULL };
static const char *const layers[] = { "top", "mid", NULL };
static const char *const rules[] = { "column", "potential", NULL };
static const char *const criteria[] = { "von-mises", "tresca", NULL };

static double yield = NAN, friction, depth_step = NAN;
static int shear, layer, removal, criterion, full_sum;

struct opt wearing_rows[] = {
	OPT_HEADING("Wear"),
	{ 'Y', "yield", OPT_NUM, UNIT_PRESSURE, &yield, 1e-30, 1e30, "Y",
		"yield stress: material under more equivalent stress is lost", NULL, 0 },
	{ 0, "criterion", OPT_WORD, UNIT_NONE, &criterion, 0, 0, "von-mises|tresca",
		"equivalent stress", criteria, 0 },
	{ 'u', "friction", OPT_NUM, UNIT_NONE, &friction, 0, 1e6, "MU",
		"friction coefficient: shear over pressure", NULL, 0 },
	{ 0, "depth-step", OPT_NUM, UNIT_LENGTH, &depth_step, 1e-30, 1e30, "H",
		"material falls in cells of this height; by default the depth is interpolated",
		NULL, 0 },
	{ 0, "shear", OPT_WORD, UNIT_NONE, &shear, 0, 0, "x|y",
		"direction in which friction drags the worn body", axes, 0 },
	{ 0, "layer", OPT_WORD, UNIT_NONE, &layer, 0, 0, "top|mid",
		"where in a cell of --depth-step the stress is taken", layers, 0 },
	{ 0, "removal", OPT_WORD, UNIT_NONE, &removal, 0, 0, "column|potential",
		"what is lost: what fails from the surface down, or all that fails",
		rules, 0 },
	{ 0, "full-sum", OPT_FLAG, UNIT_NONE, &full_sum, 0, 0, NULL,
		"sum the stress over all cells at every depth, slowly: to compare with",
		NULL, 0 },
	OPT_END,
};

void wearing_check(void)
{
	if (isnan(yield))
		die(EXIT_USAGE, "want --yield");
	if (layer && isnan(depth_step))
		die(EXIT_USAGE, "--layer is for cells: want --depth-step");
	if (yield < 1e5)
		warn("--yield %g Pa is weaker than any solid surface: is %gMPa meant?", yield,
			yield);
	if (press.poisson.v[0] < 0)
		die(EXIT_USAGE, "--poisson %g: want 0 to 0.5 for the worn body",
			press.poisson.v[0]);
}

struct wearing {
	const struct fields_in *in; /* for messages */
	long steps;
	struct pool *pool;
	struct debris *debris;
	struct debris_par par;
	struct contact *contact;     /* NULL where a single step needs none */
	struct contact_par pressing; /* the contact's problem */
	struct debris_step lost;     /* in the last step */
	struct stress_work seen;     /* counted already */
};

struct wearing *wearing_open(const struct fields_in *in, long steps)
{
	struct wearing *w = xcalloc(1, sizeof(*w));

	w->in = in;
	w->steps = steps;
	w->pool = pool_new((int)press.threads);
	if (!w->pool)
		die(EXIT_RUN, "cannot start %ld threads:", press.threads);
	return w;
}

void wearing_close(struct wearing *w)
{
	debris_free(w->debris);
	contact_free(w->contact);
	pool_free(w->pool);
	free(w);
}

void wearing_prepare(struct wearing *w, const struct record *r)
{
	struct contact_par pressing = press_par(r, w->pool);

	if (w->debris && press_same(&pressing, &w->pressing))
		return;
	if (w->steps > 1 && isnan(pressing.estar))
		die(EXIT_USAGE,
			"--steps %ld solves contacts: want --young or --estar, which %s does not tell",
			w->steps, fields_name(w->in));
	w->pressing = pressing;
	debris_free(w->debris);
	contact_free(w->contact);
	w->contact = NULL;
	w->par = (struct debris_par){ .yield = yield,
		.rule = (enum wear_rule)removal,
		.cell = isnan(depth_step) ? 0 : depth_step,
		.offset = layer ? 0.5 : 0 };
	w->par.stress = (struct stress_par){ .nx = r->nx,
		.ny = r->ny,
		.ax = r->dx,
		.ay = r->dy,
		.nu = press.poisson.v[0],
		.mu = friction,
		.axis = shear,
		.periodic = pressing.boundary == CONTACT_PERIODIC,
		.method = full_sum ? STRESS_FULL : STRESS_COARSE,
		.criterion = criterion ? &stress_tresca_criterion
				       : &stress_von_mises_criterion,
		.pool = w->pool };
	w->seen = (struct stress_work){ 0 };
	w->debris = debris_new(&w->par);
	if (w->debris && w->steps > 1)
		w->contact = contact_new(&pressing);
	if (!w->debris || (w->steps > 1 && !w->contact))
		die(EXIT_RUN, "%s: record %ld: %dx%d cells:", fields_name(w->in),
			fields_count(w->in), r->nx, r->ny);
}

void wearing_contact(
	struct wearing *w, const struct worn_surface *c, struct debris_step *s)
{
	debris_contact(w->debris, c->p, s);
}

int wearing_press(
	struct wearing *w, const struct worn_surface *c, double target, long step)
{
	enum contact_status status =
		contact_solve(w->contact, c->h, press_control(), target, c->p, NULL);
	const struct contact_result *found = contact_result(w->contact);

	if (status != CONTACT_OK && status != CONTACT_NOCONV)
		die(EXIT_RUN, "%s: record %ld, step %ld: no contact at %g %s: %s",
			fields_name(w->in), fields_count(w->in), step, target,
			isnan(press.approach) ? "Pa" : "m",
			status == CONTACT_OVERLOAD   ? "the hardness cannot carry it"
			: status == CONTACT_TOO_DEEP ? "beyond full contact"
						     : "numbers beyond double precision");
	if (status == CONTACT_NOCONV)
		warn("%s: realisation %ld, step %ld: contact not solved to %g, only to %.2g",
			fields_name(w->in), c->r->realisation, step, press.tolerance,
			found->certificate);
	stats_add("contact_iterations", (double)found->iterations);
	stats_add("contact_transforms", (double)found->transforms);
	return status == CONTACT_OK;
}

static void count_work(struct wearing *w)
{
	const struct debris_step *s = &w->lost;
	struct stress_work work = stress_work(debris_stress(w->debris));

	stats_add("steps", 1);
	stats_add("particles", (double)s->count);
	stats_add("layers", (double)s->wear.layers);
	stats_add("nodes", s->wear.nodes);
	stats_add("nodes_skipped", s->wear.nodes_skipped);
	stats_add("stress_transforms", work.transforms - w->seen.transforms);
	stats_add("kernel_cells", work.kernel_cells - w->seen.kernel_cells);
	stats_add("layers_full", work.full_layers - w->seen.full_layers);
	stats_add("layers_split", work.split_layers - w->seen.split_layers);
	stats_add("layers_coarse", work.coarse_layers - w->seen.coarse_layers);
	w->seen = work;
}

static void refuse(const struct wearing *w, enum debris_status status, long step)
{
	if (status == DEBRIS_OK)
		return;
	die(EXIT_RUN, "%s: record %ld, step %ld: %s", fields_name(w->in),
		fields_count(w->in), step,
		status == DEBRIS_PULL      ? "pressure below zero"
		: status == DEBRIS_NUMBERS ? "pressure beyond the range of numbers"
		: status == DEBRIS_DEEP
			? "material fails deeper than ten times the grid is long"
			: "out of memory");
}

struct worn_step wearing_step(struct wearing *w, const struct worn_surface *c, long step)
{
	refuse(w, debris_step(w->debris, c->h, c->p, &w->lost), step);
	count_work(w);
	return (struct worn_step){ .number = step,
		.lost = &w->lost,
		.stress = debris_stress(w->debris),
		.dz = w->par.cell > 0 ? w->par.cell : w->par.stress.ax,
		.offset = w->par.offset };
}

double wearing_friction(void)
{
	return friction;
}

double wearing_length(const struct record *r)
{
	return shear ? r->ny * r->dy : r->nx * r->dx;
}
