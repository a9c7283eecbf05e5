/* layout - what a row of inductive sensors can measure, and where to put it */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "io/quantities.h"
#include "io/tables.h"
#include "layout/search.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Phases of the sampling over which the bound is averaged, and samples of a pulse from
 * which on it is an integral and not a sum: at 10, 100 and 4096 samples the two differ by
 * 3e-3, 9e-5 and 2e-6. */
enum { PHASES = 16, SUMMED = 4096 };
static const double found =
	5.7; /* deviations: detection threshold of duet for an isolated pulse */

enum method { AUTO, CLOSED, SUM };
static const char *const methods[] = { "auto", "closed", "sum", NULL };
static const char *const profiles[] = { "plug", "laminar", "turbulent", NULL };

static struct opt_texts coils;
static double rate = 10e3, flow = 1e-3, bore = 0.01, exponent = 7, snr = NAN;
static double zone = 0.4 / M_PI, diameter = 100e-6, arrivals = NAN, per_ml = NAN;
static double spread, extent = NAN, least = 0.9;
static long best, steps;
static int doubtful;
static int shape, profile, method;

static const struct opt opts[] = {
	OPT_HEADING("Layouts"),
	{ 0, "coils", OPT_TEXTS, UNIT_NONE, &coils, 0, 0, "X,X,...",
		"positions of the coils along the pipe; may be repeated", NULL, 0 },
	{ 0, "best", OPT_INT, UNIT_COUNT, &best, 2, LAYOUT_COILS, "N",
		"find the best positions of N coils", NULL, 0 },
	{ 0, "extent", OPT_NUM, UNIT_LENGTH, &extent, 1e-6, 1e3, "X",
		"of --best: largest distance from the first coil to the last", NULL, 0 },
	{ 0, "least-unique", OPT_NUM, UNIT_FRACTION, &least, 0, 1, "P",
		"of --best: smallest probability of an unambiguous match", NULL, 0 },
	{ 0, "steps", OPT_INT, UNIT_COUNT, &steps, 2, 4096, "N",
		"of --best: steps of the initial grid (default by the number of coils)",
		NULL, 0 },
	OPT_HEADING("Particles"),
	{ 0, "snr", OPT_NUM, UNIT_DECIBEL, &snr, -100, 400, "S",
		"peak of a 100 um particle over the rms of the noise, in dB", NULL, 0 },
	{ 0, "diameter", OPT_NUM, UNIT_LENGTH, &diameter, 1e-9, DIAMETER_MOST, "D",
		"diameter of the measured particle", NULL, 0 },
	{ 0, "arrivals", OPT_NUM, UNIT_FREQUENCY, &arrivals, 0, 1e12, "F",
		"particles per second", NULL, 0 },
	{ 0, "per-ml", OPT_NUM, UNIT_NONE, &per_ml, 0, 1e12, "N",
		"particles per millilitre of oil, in place of --arrivals", NULL, 0 },
	{ 0, "spread", OPT_NUM, UNIT_FRACTION, &spread, 0, 0.9999, "S",
		"largest relative difference of transit times from that of the oil", NULL,
		0 },
	OPT_HEADING("Method"),
	{ 0, "method", OPT_WORD, UNIT_NONE, &method, 0, 0, "auto|closed|sum",
		"standard errors from integrals over time, or sums over samples", methods,
		0 },
	OPT_HEADING("Instrument"),
	{ 'r', "rate", OPT_NUM, UNIT_FREQUENCY, &rate, 1, 2e9, "F", "sampling rate", NULL,
		0 },
	{ 0, "flow", OPT_NUM, UNIT_FLOW, &flow, 1e-12, 1e3, "Q", "volume flow of the oil",
		NULL, 0 },
	{ 0, "bore", OPT_NUM, UNIT_LENGTH, &bore, 1e-6, 10, "D", "diameter of the pipe",
		NULL, 0 },
	{ 0, "profile", OPT_WORD, UNIT_NONE, &profile, 0, 0, "plug|laminar|turbulent",
		"velocity profile", profiles, 0 },
	{ 0, "exponent", OPT_NUM, UNIT_NONE, &exponent, 1, 100, "N",
		"exponent N of the turbulent profile (1 - r/R)^(1/N)", NULL, 0 },
	{ 0, "zone", OPT_NUM, UNIT_LENGTH, &zone, 1e-9, 1e3, "L",
		"length of the sensing zone; duration of a pulse is L over the velocity",
		NULL, 0 },
	{ 0, "pulse", OPT_WORD, UNIT_NONE, &shape, 0, 0, PULSE_WORDS, "pulse shape",
		pulse_names + 1, 0 },
	OPT_END,
};

static const struct prog prog = { "layout",
	"Compare layouts of inductive sensors by the Cramer-Rao bound.", "", "nothing",
	"table: one row per layout", opts };

static struct layout_par parameters(void)
{
	struct layout_par par = {
		.traffic = { { bore, flow, (enum pipe_profile)profile, exponent }, 0,
			spread }
	};
	double size = diameter / 100e-6;

	if (!isnan(arrivals))
		par.traffic.arrivals = arrivals;
	else
		par.traffic.arrivals = per_ml * 1e6 * flow;
	par.bound = (struct bound_par){ .shape = (enum pulse_shape)shape,
		.zone = zone,
		.velocity = pipe_mean_velocity(&par.traffic.pipe),
		.rate = rate,
		.snr = pow(10, snr / 20) * size * size * size };
	return par;
}

static void check_options(void)
{
	if (!coils.n == !best)
		die(EXIT_USAGE, "specify either --coils X,X,... or --best N");
	opt_require("best", "extent least-unique steps");
	if (best && isnan(extent))
		die(EXIT_USAGE, "--best %ld requires --extent, the available length",
			best);
	if (diameter >= bore)
		die(EXIT_USAGE,
			"--diameter: a particle of %g m does not fit a bore of %g m",
			diameter, bore);
	if (isnan(snr))
		die(EXIT_USAGE,
			"--snr is missing: peak of a 100 um particle over the noise, dB");
	if (isnan(arrivals) == isnan(per_ml))
		die(EXIT_USAGE, "specify either --arrivals F or --per-ml N");
	if (opt_given("exponent") && profile != PIPE_TURBULENT)
		die(EXIT_USAGE, "--exponent requires --profile turbulent");
	if (bore >= 1 && opt_given_bare("bore"))
		warn("--bore %g m: numbers without a unit are metres: is %gmm meant?",
			bore, bore);
	if (flow >= 1 && opt_given_bare("flow"))
		warn("--flow %g m3/s: is %gL/min meant?", flow, flow);
}

/* Reads "0,5cm,25cm"; returns the number of coils. */
static int read_coils(const char *text, double *coil)
{
	const char *s = text, *end, *wrong;
	int n = 0;

	for (;; s = end + 1) {
		if (n == LAYOUT_COILS)
			die(EXIT_USAGE, "--coils %s: more than %d coils", text,
				LAYOUT_COILS);
		wrong = unit_parse(s, UNIT_LENGTH, ",", &coil[n], &end);
		if (wrong)
			die(EXIT_USAGE, "--coils %s: '%s' %s, want positions in m", text,
				s, wrong);
		if (n && !(coil[n] >= coil[n - 1]))
			die(EXIT_USAGE, "--coils %s: positions must be ascending", text);
		if (!(fabs(coil[n]) <= 1e3))
			die(EXIT_USAGE, "--coils %s: '%s' is beyond 1000 m", text, s);
		n++;
		if (!*end)
			return n;
	}
}

/* The length of the zone for which the standard error of the velocity is largest, for n
 * coils at this distance; 0 if all coils coincide, when a longer zone is always better.
 */
static double worst_zone(const double *coil, int n)
{
	double e[3], mean = 0, square = 0;

	for (int k = 0; k < n; k++)
		mean += coil[k] / n;
	for (int k = 0; k < n; k++)
		square += (coil[k] - mean) * (coil[k] - mean);
	bound_energies((enum pulse_shape)shape, e);
	return sqrt(square * e[1] / (n * (e[2] - e[0] / 4)));
}

/* Matched filter of all pulses of a particle over its deviation in the noise. */
static double detection(const struct layout_par *par, double samples, int n)
{
	double e[3], d;

	bound_energies(par->bound.shape, e);
	d = par->bound.snr * sqrt(samples * e[0] * n);
	if (d < found && !doubtful++)
		warn("the detection statistic is %.3g standard deviations, below %g: such particles are often missed and the bound is not attained",
			d, found);
	return d;
}

static void put_layout(
	struct table_out *t, const struct layout_par *par, const double *coil, int n)
{
	double samples = par->bound.zone / par->bound.velocity * par->bound.rate;
	char *where = xstrdup("");
	struct layout evaluated;

	layout_evaluate(par, coil, n, &evaluated);
	if (method == SUM || (method == AUTO && samples < SUMMED)) {
		if (bound_sampled(&par->bound, coil, n, PHASES, &evaluated.bound))
			die(EXIT_RUN, "out of memory: a pulse has %g samples", samples);
		stats_add("samples_summed", floor(samples) * n * PHASES);
	} else {
		stats_add("samples_left_out", floor(samples) * n * PHASES);
	}
	if (isinf(evaluated.bound.velocity) && !doubtful++)
		warn("the %.3g samples of a pulse do not determine its velocity",
			samples);
	for (int k = 0; k < n; k++) {
		char number[NUMBER_TEXT];

		where = xappend(
			where, "%s%s", k ? "," : "", number_text(coil[k], number));
	}
	table_put_text(t, where);
	const double row[] = { coil[n - 1] - coil[0], par->bound.zone,
		worst_zone(coil, n), par->bound.velocity, samples, par->bound.snr,
		detection(par, samples, n), evaluated.bound.time,
		evaluated.bound.velocity, evaluated.bound.diameter * diameter,
		par->traffic.arrivals, traffic_alone(&par->traffic, par->bound.zone),
		evaluated.unique, evaluated.by_width };
	table_put_row(t, row, (int)(sizeof row / sizeof *row));
	stats_add("layouts", 1);
	free(where);
}

/* Steps of the first grid, unless given: the most, up to 64, with at most 300000 layouts,
 * 0.4 s of search; that is 16 or more for up to 8 coils.  For 54 layouts of 3 to 5 coils
 * (50, 200 and 1000 particles per second, spreads of 5 and 30 %, 0, 10 and 30 dB) the
 * velocity error of 4, 8, 16 and 32 steps exceeds that of 64 by 10, 2.9, 2.0 and 1.0 % at
 * most. */
static int grid_steps(void)
{
	int n = 64;

	for (; !steps && n > 2; n /= 2) {
		double layouts = 1;

		for (long k = 1; k < best; k++)
			layouts *= (double)(n + k) / (double)k;
		if (layouts <= 3e5)
			break;
	}
	return steps ? (int)steps : n;
}

int main(int argc, char **argv)
{
	double coil[LAYOUT_COILS];
	struct layout_par par;
	struct table_out *t;
	char *cmd;

	opt_parse(&prog, argc, argv);
	check_options();
	par = parameters();
	for (int i = 0; i < coils.n; i++)
		read_coils(coils.v[i], coil);
	cmd = opt_cmd(NULL, NULL);
	t = table_create(NULL, cmd, "m m m m m/s 1 1 1 s m/s m 1/s 1 1 1",
		"coils extent zone zone_worst velocity samples snr detection se_time se_velocity "
		"se_diameter arrivals p_alone p_unique p_unique_width");
	for (int i = 0; i < coils.n; i++)
		put_layout(t, &par, coil, read_coils(coils.v[i], coil));
	if (best) {
		struct layout of;

		if (layout_search(
			    &par, (int)best, extent, least, grid_steps(), coil, &of))
			die(EXIT_RUN,
				"no layout of %ld coils has p_unique_width of %g or more",
				best, least);
		stats_add("layouts_searched", (double)of.evaluated);
		put_layout(t, &par, coil, (int)best);
	}
	table_done(t);
	free(cmd);
	return shell_done(doubtful ? EXIT_NOCONV : EXIT_SUCCESS);
}
