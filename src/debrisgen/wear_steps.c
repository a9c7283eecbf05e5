#include "wear_steps.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "common/contact_options.h"
#include "contact/solver.h"
#include "counterface.h"
#include "grid_error.h"
#include "quick.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const axes[] = { "x", "y", NULL };
static const char *const layers[] = { "top", "mid", NULL };
static const char *const rules[] = { "column", "potential", NULL };
static const char *const criteria[] = { "von-mises", "tresca", NULL };

static const char *const bodies[] = { "first", "second", "both", NULL };
static const char *const laws[] = { "stress", "archard", NULL };
enum { FIRST, SECOND, BOTH };
enum { STRESS, ARCHARD };

static struct opt_list yield, wear_rate;
static double friction, depth_step = NAN;
static int shear, layer, removal, criterion, full_sum, wears, law, richardson;

struct opt wearing_rows[] = {
	OPT_HEADING("Wear"),
	{ 'Y', "yield", OPT_LIST, UNIT_PRESSURE, &yield, 1e-30, 1e30, "Y1[,Y2]",
		"yield stress of the worn body and of the counterface", NULL, 0 },
	{ 0, "criterion", OPT_WORD, UNIT_NONE, &criterion, 0, 0, "von-mises|tresca",
		"equivalent stress", criteria, 0 },
	{ 'u', "friction", OPT_NUM, UNIT_FRACTION, &friction, 0, 1e6, "MU",
		"friction coefficient: shear over pressure", NULL, 0 },
	{ 0, "depth-step", OPT_NUM, UNIT_LENGTH, &depth_step, 1e-30, 1e30, "H",
		"remove whole cells of this height; by default the depth is continuous",
		NULL, 0 },
	{ 0, "shear", OPT_WORD, UNIT_NONE, &shear, 0, 0, "x|y",
		"direction of the friction force on the worn body", axes, 0 },
	{ 0, "layer", OPT_WORD, UNIT_NONE, &layer, 0, 0, "top|mid",
		"where the stress of a cell of --depth-step is evaluated", layers, 0 },
	{ 0, "removal", OPT_WORD, UNIT_NONE, &removal, 0, 0, "column|potential",
		"removal rule: failed material down from the surface, or all that fails",
		rules, 0 },
	{ 0, "full-sum", OPT_FLAG, UNIT_NONE, &full_sum, 0, 0, NULL,
		"sum the stress over all cells at every depth: slow, for verification",
		NULL, 0 },
	{ 0, "richardson", OPT_FLAG, UNIT_NONE, &richardson, 0, 0, NULL,
		"repeat each step on two coarser grids and extrapolate the volume", NULL,
		0 },
	OPT_TABLE(quick_rows),
	OPT_HEADING("Sliding pair"),
	OPT_TABLE(counterface_rows),
	{ 0, "wears", OPT_WORD, UNIT_NONE, &wears, 0, 0, "first|second|both",
		"body that wears: that of the input, the counterface, or both", bodies,
		0 },
	{ 0, "law", OPT_WORD, UNIT_NONE, &law, 0, 0, "stress|archard",
		"wear by stress over yield, or by pressure and distance", laws, 0 },
	{ 0, "wear-rate", OPT_LIST, UNIT_NONE, &wear_rate, 0, 1e30, "K1[,K2]",
		"volume per load and distance of --law archard, m2/N", NULL, 0 },
	OPT_END,
};

/* The value of body 0 or 1; a single value holds for both. */
static double of_body(const struct opt_list *list, int body)
{
	return list->v[body < list->n ? body : 0];
}

static int is_worn(int body)
{
	return wears == BOTH || wears == body;
}

static void check_pair(void)
{
	int pair = counterface_check();

	if (wears != FIRST && !pair)
		die(EXIT_USAGE, "--wears %s requires --counterface", bodies[wears]);
	if (law == ARCHARD && !wear_rate.n)
		die(EXIT_USAGE, "--law archard requires --wear-rate");
	if (law == STRESS && wear_rate.n)
		die(EXIT_USAGE, "--wear-rate requires --law archard");
	if (wears != FIRST && !(press.poisson.v[press.poisson.n - 1] >= 0))
		die(EXIT_USAGE, "--poisson: want 0 to 0.5 for a body that wears");
}

/* A surrogate gives the volumes below the footprints of one surface, but no depths. */
static void check_surrogate(void)
{
	static const char *const without[] = { "depth-step", "removal", "criterion",
		"full-sum", "richardson", "counterface", "law", "surface", "stress",
		"counter-surface", NULL };

	opt_require("surrogate", "interval width audit");
	opt_require("stress", "fields stress-layers");
	if (!quick_asked())
		return;
	for (int k = 0; without[k]; k++)
		if (opt_given(without[k]))
			die(EXIT_USAGE, "--surrogate excludes --%s", without[k]);
}

void wearing_check(void)
{
	check_pair();
	check_surrogate();
	if (richardson && (counterface_check() || law == ARCHARD))
		die(EXIT_USAGE, "--richardson requires wear of one body by stress");
	if (!yield.n && law == STRESS)
		die(EXIT_USAGE, "--yield is missing");
	if (!yield.n)
		yield = (struct opt_list){ 1, { INFINITY } };
	opt_require("depth-step", "layer");
	if (yield.v[0] < 1e5)
		warn("--yield %g Pa is weaker than any solid surface: is %gMPa meant?",
			yield.v[0], yield.v[0]);
	if (yield.v[0] > 1e11 && law == STRESS)
		warn("--yield %g Pa is stronger than any solid", yield.v[0]);
	if (friction > 5)
		warn("--friction %g: is %g%% meant?", friction, friction);
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
	struct contact *contact;     /* NULL if a single step needs none */
	struct contact_par pressing; /* parameters of the contact */
	struct debris_step lost;     /* in the last step */
	struct stress_work seen;     /* counted already */
	/* Of a sliding pair: NULL without. */
	struct counterface *counterface;
	struct quick *quick; /* NULL without a surrogate */
	struct debris *second;
	struct debris_step second_lost;
	struct stress_work second_seen;
	double *other, *pair; /* heights: the part above the grid, and the sum of both */
	struct grid_error grid;
	long orderless;  /* steps whose three volumes differ, but indicate no order */
	double steepest; /* rms slope of a pair */
	long steep_step;
};

/* Whether the contact of a step (from 1 in this run) is solved here. */
int wearing_solves(const struct wearing *w, long step)
{
	return step > 1 || w->counterface || law == ARCHARD;
}

int wearing_takes_heights(const struct wearing *w)
{
	return wearing_solves(w, w->steps) || richardson;
}

/* Options of a contact that is not solved here. */
static void check_solver(const struct wearing *w)
{
	static const char *const of_solver[] = { "tolerance", "max-iterations", "solver",
		"multiply", NULL };

	for (int k = 0; of_solver[k] && !wearing_takes_heights(w); k++)
		if (opt_given(of_solver[k]))
			die(EXIT_USAGE,
				"--%s has no effect: a single step takes the pressure that it reads",
				of_solver[k]);
}

struct wearing *wearing_open(const struct fields_in *in, long steps)
{
	struct wearing *w = xcalloc(1, sizeof *w);

	w->in = in;
	w->steps = steps;
	w->pool = pool_new((int)press.threads);
	if (!w->pool)
		die(EXIT_RUN, "cannot start %ld threads:", press.threads);
	if (counterface_check())
		w->counterface = counterface_open(shear);
	check_solver(w);
	if (quick_asked()) {
		if (steps > 1)
			die(EXIT_USAGE, "--surrogate describes one step: want --steps 1");
		w->quick = quick_open();
	}
	return w;
}

int wearing_richardson(void)
{
	return richardson;
}

void wearing_close(struct wearing *w)
{
	debris_free(w->debris);
	debris_free(w->second);
	contact_free(w->contact);
	counterface_close(w->counterface);
	quick_close(w->quick);
	pool_free(w->pool);
	free(w->other);
	free(w->pair);
	free(w);
}

static void prepare_second(struct wearing *w, const struct record *r)
{
	struct debris_par par = w->par;
	size_t n = (size_t)r->nx * (size_t)r->ny;

	debris_free(w->second);
	w->second_seen = (struct stress_work){ 0 };
	par.yield = of_body(&yield, SECOND);
	par.stress.nu = of_body(&press.poisson, SECOND);
	/* Friction drags the two bodies in opposite directions. */
	par.stress.mu = -friction;
	w->second = debris_new(&par);
	w->other = xrealloc(w->other, n, sizeof *w->other);
	w->pair = xrealloc(w->pair, n, sizeof *w->pair);
	if (!w->second)
		die(EXIT_RUN, "%s: record %ld: %dx%d cells:", fields_name(w->in),
			fields_count(w->in), r->nx, r->ny);
}

void wearing_prepare(struct wearing *w, struct record *r)
{
	struct contact_par pressing = press_par(r, w->pool);

	if (w->counterface) {
		const char *why;

		counterface_next(w->counterface, r);
		why = record_get(counterface_record(w->counterface), "doubtful");
		if (why)
			record_doubt(r, why);
	}
	if (w->debris && press_same(&pressing, &w->pressing))
		return;
	if (richardson && (r->nx % 4 || r->ny % 4 || r->nx < 32 || r->ny < 32))
		die(EXIT_USAGE,
			"--richardson: %dx%d cells: want multiples of 4, at least 32",
			r->nx, r->ny);
	if ((wearing_solves(w, w->steps) || richardson) && isnan(pressing.estar))
		die(EXIT_USAGE,
			"--steps %ld solves contacts: specify --young or --estar, which %s does not state",
			w->steps, fields_name(w->in));
	w->pressing = pressing;
	debris_free(w->debris);
	contact_free(w->contact);
	w->contact = NULL;
	w->par = (struct debris_par){ .yield = yield.v[0],
		.rule = (enum wear_rule)removal,
		.cell = isnan(depth_step) ? 0 : depth_step,
		.offset = layer ? 0.5 : 0 };
	w->par.stress = (struct stress_par){ .nx = r->nx,
		.ny = r->ny,
		.dx = r->dx,
		.dy = r->dy,
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
	if (w->quick && w->par.stress.periodic)
		die(EXIT_USAGE,
			"%s: record %ld is periodic: --surrogate is for free surfaces",
			fields_name(w->in), fields_count(w->in));
	if (w->quick)
		quick_prepare(w->quick, &w->par.stress);
	if (w->debris && wearing_solves(w, w->steps))
		w->contact = contact_new(&pressing);
	if (w->counterface)
		prepare_second(w, r);
	if (!w->debris || (wearing_solves(w, w->steps) && !w->contact))
		die(EXIT_RUN, "%s: record %ld: %dx%d cells:", fields_name(w->in),
			fields_count(w->in), r->nx, r->ny);
}

void wearing_contact(
	struct wearing *w, const struct worn_surface *c, struct debris_step *s)
{
	debris_contact(w->debris, c->p, &w->lost);
	*s = w->lost;
}

/* Root mean square slope, by differences of neighbours. */
static double rms_slope(const struct record *r, const double *h)
{
	double sum = 0, n = (double)(r->nx - 1) * (r->ny - 1);

	for (int y = 0; y + 1 < r->ny; y++)
		for (int x = 0; x + 1 < r->nx; x++) {
			const double *at = h + (size_t)y * (size_t)r->nx + x;
			double u = (at[1] - at[0]) / r->dx,
			       v = (at[r->nx] - at[0]) / r->dy;

			sum += u * u + v * v;
		}
	return n > 0 ? sqrt(sum / n) : 0;
}

int wearing_warn(const struct wearing *w)
{
	if (w->steepest > 0.2)
		warn("%s: the pair reaches an rms slope of %.2g (step %ld), above 0.2, the limit of half-space theory%s",
			fields_name(w->in), w->steepest, w->steep_step,
			w->pressing.hardness > 0 ? "" : ": specify --hardness");
	if (w->orderless > 0)
		warn("%s: on %ld steps the volumes of the three grids indicate no order of convergence: volume_extrapolated and volume_grid_error are nan, use a finer grid",
			fields_name(w->in), w->orderless);
	return !w->quick || quick_report(w->quick, fields_name(w->in));
}

/* The equivalent surface in a step: the surface plus the part of the counterface above
 * it.
 */
static const double *pressed(struct wearing *w, const struct worn_surface *c, long step)
{
	size_t n = (size_t)c->r->nx * (size_t)c->r->ny;

	if (!w->counterface)
		return c->h;
	counterface_window(w->counterface, step, w->other);
	for (size_t i = 0; i < n; i++)
		w->pair[i] = c->h[i] + w->other[i];
	if (rms_slope(c->r, w->pair) > w->steepest) {
		w->steepest = rms_slope(c->r, w->pair);
		w->steep_step = step;
	}
	return w->pair;
}

int wearing_press(
	struct wearing *w, const struct worn_surface *c, double target, long step)
{
	enum contact_status status = contact_solve(
		w->contact, pressed(w, c, step), press_control(), target, c->p, NULL);
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
			found->optimality_gap);
	stats_add("contact_iterations", (double)found->iterations);
	stats_add("contact_transforms", (double)found->transforms);
	return status == CONTACT_OK;
}

static void count_work(
	const struct debris_step *s, struct stress_work work, struct stress_work *seen)
{
	stats_add("particles", (double)s->count);
	stats_add("layers", (double)s->wear.layers);
	stats_add("nodes", s->wear.nodes);
	stats_add("nodes_skipped", s->wear.nodes_skipped);
	stats_add("stress_transforms", work.transforms - seen->transforms);
	stats_add("kernel_cells", work.kernel_cells - seen->kernel_cells);
	stats_add("layers_full", work.full_layers - seen->full_layers);
	stats_add("layers_split", work.split_layers - seen->split_layers);
	stats_add("layers_coarse", work.coarse_layers - seen->coarse_layers);
	*seen = work;
}

static void refuse(const struct wearing *w, enum debris_status status, long step)
{
	if (status == DEBRIS_OK)
		return;
	die(EXIT_RUN, "%s: record %ld, step %ld: %s", fields_name(w->in),
		fields_count(w->in), step,
		status == DEBRIS_PULL      ? "pressure below zero"
		: status == DEBRIS_NUMBERS ? "pressure beyond double precision"
		: status == DEBRIS_DEEP
			? "material fails deeper than ten times the length of the grid"
		: status == DEBRIS_FINE
			? "material fails deeper than 2000 cells of --depth-step"
			: "out of memory");
}

/* Removes the material that fails under the pressure of c. */
static void wear_by_stress(struct wearing *w, const struct worn_surface *c, long step)
{
	if (w->quick)
		refuse(w, debris_load(w->debris, c->p), step);
	if (w->quick && quick_step(w->quick, debris_stress(w->debris), c->p, yield.v[0],
				w->pressing.hardness, c->r->realisation, &w->lost)) {
		count_work(&w->lost, stress_work(debris_stress(w->debris)), &w->seen);
	} else if (is_worn(FIRST)) {
		refuse(w, debris_step(w->debris, c->h, c->p, &w->lost), step);
		count_work(&w->lost, stress_work(debris_stress(w->debris)), &w->seen);
		if (w->quick)
			quick_take(w->quick, &w->lost);
	} else if (stress_load(debris_stress(w->debris), c->p)) {
		refuse(w, DEBRIS_NUMBERS, step);
	}
	if (is_worn(SECOND)) {
		refuse(w, debris_step(w->second, w->other, c->p, &w->second_lost), step);
		count_work(&w->second_lost, stress_work(debris_stress(w->second)),
			&w->second_seen);
		counterface_return(w->counterface, step, w->other);
	}
}

/* Waves of wear grow where a part of the distance wears off more than 4 d / (sqrt(2) pi
 * E*) of a pressure: the shortest wave is then worn deeper than its pressure pushes it
 * in.  Four fifths of that. */
static long archard_parts(const struct wearing *w, double distance)
{
	const struct contact_par *p = &w->pressing;
	double k = is_worn(FIRST) ? of_body(&wear_rate, FIRST) : 0, limit, parts;

	k += is_worn(SECOND) ? of_body(&wear_rate, SECOND) : 0;
	limit = 0.8 * 4 * fmin(p->dx, p->dy) / (sqrt(2) * M_PI * p->estar);
	parts = ceil(k * distance / limit);
	/* days of contacts: rather a rate in another unit than a wish */
	if (parts > 1e7)
		die(EXIT_USAGE,
			"--wear-rate: a step of %g m would take %.0e contacts: want a lower "
			"rate, in m2/N, or a shorter distance",
			distance, parts);
	return (long)fmax(1, parts);
}

/* Removes the depths that a part of the distance wears off a body; returns the volume,
 * m3. */
static double wear_part(double *height, const double *p, size_t n, double rate,
	double distance, double area)
{
	double volume = 0;

	for (size_t i = 0; i < n; i++) {
		double depth = rate * p[i] * distance;

		height[i] -= depth;
		volume += depth * area;
	}
	return volume;
}

static double deepest(const double *before, const double *after, size_t n)
{
	double depth = 0;

	for (size_t i = 0; i < n; i++)
		depth = fmax(depth, before[i] - after[i]);
	return depth;
}

/* Wears by k p ds, solving the contact for every part of the distance; 1, or 0 if a
 * contact did not converge. */
static int wear_by_archard(struct wearing *w, const struct worn_surface *c, double target,
	double distance, long step)
{
	size_t n = (size_t)c->r->nx * (size_t)c->r->ny;
	double area = c->r->dx * c->r->dy;
	long parts = archard_parts(w, distance);
	double *before = xcalloc(2 * n, sizeof *before);
	int solved = 1;

	w->second_lost = w->lost;
	if (stress_load(debris_stress(w->debris), c->p))
		refuse(w, DEBRIS_NUMBERS, step);
	memcpy(before, c->h, n * sizeof *before);
	if (is_worn(SECOND))
		memcpy(before + n, w->other, n * sizeof *before);
	for (long k = 0; k < parts; k++) {
		double ds = distance / (double)parts;

		if (k > 0)
			solved &= wearing_press(w, c, target, step);
		if (is_worn(FIRST))
			w->lost.volume += wear_part(
				c->h, c->p, n, of_body(&wear_rate, FIRST), ds, area);
		if (is_worn(SECOND)) {
			w->second_lost.volume += wear_part(
				w->other, c->p, n, of_body(&wear_rate, SECOND), ds, area);
			counterface_return(w->counterface, step, w->other);
		}
	}
	w->lost.depth = is_worn(FIRST) ? deepest(before, c->h, n) : 0;
	w->second_lost.depth = is_worn(SECOND) ? deepest(before + n, w->other, n) : 0;
	free(before);
	w->lost.wear.stress = w->second_lost.wear.stress = NAN;
	stats_add("wear_parts", (double)parts);
	return solved;
}

/* The hardness of Archard's coefficient; nan if unknown. */
static double hardness_of(const struct wearing *w)
{
	double softer = fmin(yield.v[0], of_body(&yield, SECOND));

	if (w->pressing.hardness > 0)
		return w->pressing.hardness;
	return isfinite(softer) ? 3 * softer : NAN;
}

struct worn_step wearing_step(struct wearing *w, const struct worn_surface *c,
	double target, double distance, long step, int *solved)
{
	size_t n = (size_t)c->r->nx * (size_t)c->r->ny;
	double *before = NULL;

	*solved = 1;
	if (richardson) {
		before = xcalloc(n, sizeof *before);
		memcpy(before, c->h, n * sizeof *before);
	}
	if (law == ARCHARD)
		*solved = wear_by_archard(w, c, target, distance, step);
	else
		wear_by_stress(w, c, step);
	if (richardson) {
		struct worn_surface was = *c;

		was.h = before;
		*solved = grid_error_find(&was, &w->pressing, &w->par, press_control(),
			target, w->lost.volume, &w->grid);
		w->orderless += isnan(w->grid.order) &&
				!(w->grid.volume[0] == w->lost.volume &&
					w->grid.volume[1] == w->lost.volume);
		free(before);
	}
	stats_add("steps", 1);
	return (struct worn_step){ .number = step,
		.lost = &w->lost,
		.second = is_worn(SECOND) ? &w->second_lost : NULL,
		.counterface = w->counterface ? counterface_record(w->counterface) : NULL,
		.hardness = hardness_of(w),
		.grid = richardson ? &w->grid : NULL,
		.volumes = w->quick ? quick_volumes(w->quick) : NULL,
		.stress = debris_stress(w->debris),
		.dz = w->par.cell > 0 ? w->par.cell : w->par.stress.dx,
		.offset = w->par.offset };
}

double wearing_friction(void)
{
	return friction;
}

double wearing_length(const struct record *r)
{
	double side = shear ? r->ny * r->dy : r->nx * r->dx;

	return isnan(counterface_slide()) ? side : counterface_slide();
}
