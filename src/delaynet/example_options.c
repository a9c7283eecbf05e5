#include "example_options.h"
#include "cli/files.h"
#include "cli/msg.h"
#include <math.h>
#include <string.h>

struct lessons lessons = { .lambda = 1,
	.seed = 1,
	.count = 1000,
	.points = 500,
	.sources = 3,
	.span = 4 * M_PI,
	.unit = 1,
	.noise = NAN,
	.length = { 2, { M_PI / 2, 3 * M_PI / 2 } },
	.amplitude = { 2, { 0, 1 } },
	.gain = { 2, { 0.909, 0.909 } },
	.separation = 0.1,
	.snr = { 2, { 12, 45 } },
	.reach = { 2, { CNN_REACH_MIN, CNN_REACH_MAX } } };

static const char *const sections[] = { "length", "period", "range", NULL };
static const char *const orders[] = { "drawn", "arrival", "sorted", NULL };

struct opt lessons_rows[] = {
	OPT_HEADING("Examples"),
	{ 0, "columns", OPT_INT, UNIT_COUNT, &lessons.points, 2, 1e5, "N",
		"points per channel", NULL, 0 },
	{ 0, "sources", OPT_INT, UNIT_COUNT, &lessons.sources, 1, DELAYS_MAX, "N",
		"overlapping sources", NULL, 0 },
	{ 0, "span", OPT_NUM, UNIT_ANGLE, &lessons.span, 1e-3, 1e6, "X",
		"range of the x axis", NULL, 0 },
	{ 0, "section", OPT_WORD, UNIT_NONE, &lessons.section, 0, 0,
		"length|period|range", "interpretation of the range pi/2 to 3pi/2",
		sections, 0 },
	{ 0, "section-range", OPT_LIST, UNIT_ANGLE, &lessons.length, 0, 1e6, "A:B",
		"this range", NULL, 0 },
	{ 0, "endless", OPT_FLAG, UNIT_NONE, &lessons.endless, 0, 0, NULL,
		"continue the sine outside its section", NULL, 0 },
	{ 0, "amplitude", OPT_LIST, UNIT_NONE, &lessons.amplitude, 0, 1e6, "A:B",
		"range of uniform amplitudes", NULL, 0 },
	{ 0, "gain", OPT_LIST, UNIT_NONE, &lessons.gain, 0, 1e6, "A:B",
		"range of the gain of the second channel, uniform", NULL, 0 },
	{ 0, "delay", OPT_NUM, UNIT_ANGLE, &lessons.unit, 0, 1e6, "X",
		"shift of a delay of 1", NULL, 0 },
	{ 0, "labels", OPT_WORD, UNIT_NONE, &lessons.order, 0, 0, "drawn|arrival|sorted",
		"order of the labels", orders, 0 },
	{ 0, "scaled", OPT_FLAG, UNIT_NONE, &lessons.scaled, 0, 0, NULL,
		"divide both channels by the peak of the first", NULL, 0 },
	{ 0, "deviation", OPT_NUM, UNIT_NONE, &lessons.noise, 0, 1e6, "SD",
		"standard deviation of white noise (score: of the second row, 0.316)",
		NULL, 0 },
	{ 0, "snr", OPT_LIST, UNIT_DECIBEL, &lessons.snr, -20, 200, "A:B",
		"pulses: signal-to-noise ratio for amplitude 1", NULL, 0 },
	{ 0, "separation", OPT_NUM, UNIT_NONE, &lessons.separation, 0, 0.5, "D",
		"pulses: smallest distance of arrivals, in pulse durations", NULL, 0 },
	{ 0, "reach", OPT_LIST, UNIT_NONE, &lessons.reach, CNN_REACH_MIN, CNN_REACH_MAX,
		"A:B", "pulses: range of the largest delay, in pulse durations", NULL,
		0 },
	{ 0, "pulse", OPT_WORD, UNIT_NONE, &lessons.shape, 0, 0, PULSE_WORDS,
		"pulses: pulse shape", pulse_names + 1, 0 },
	OPT_END,
};

struct delaydata_par lessons_sines(void)
{
	return (struct delaydata_par){ .points = (int)lessons.points,
		.sources = (int)lessons.sources,
		.span = lessons.span,
		.section = (enum delaydata_section)lessons.section,
		.length = { lessons.length.v[0], lessons.length.v[1] },
		.endless = lessons.endless,
		.amplitude = { lessons.amplitude.v[0], lessons.amplitude.v[1] },
		.gain = { lessons.gain.v[0], lessons.gain.v[1] },
		.unit = lessons.unit,
		.order = (enum delaydata_order)lessons.order,
		.scaled = lessons.scaled,
		.noise = isnan(lessons.noise) ? 0 : lessons.noise,
		.seed = (uint64_t)lessons.seed };
}

struct cnndata_par lessons_pulses(void)
{
	struct cnndata_par par = cnndata_default();

	if (opt_given("sources"))
		par.sources[0] = par.sources[1] = (int)lessons.sources;
	if (opt_given("gain"))
		memcpy(par.gain, lessons.gain.v, sizeof par.gain);
	if (opt_given("amplitude")) {
		par.size[0] = cbrt(lessons.amplitude.v[0]);
		par.size[1] = cbrt(lessons.amplitude.v[1]);
	}
	memcpy(par.snr, lessons.snr.v, sizeof par.snr);
	memcpy(par.reach, lessons.reach.v, sizeof par.reach);
	par.spacing = lessons.separation;
	par.shape = (enum pulse_shape)lessons.shape;
	par.seed = (uint64_t)lessons.seed;
	return par;
}

void lessons_check(void)
{
	const struct opt_list *range[] = { &lessons.length, &lessons.amplitude,
		&lessons.gain, &lessons.snr, &lessons.reach };
	static const char *const name[] = { "section-range", "amplitude", "gain", "snr",
		"reach" };

	for (int i = 0; i < 5; i++)
		if (range[i]->v[0] > range[i]->v[1])
			die(EXIT_USAGE, "--%s: want A:B with A <= B", name[i]);
	if (lessons.section != DELAYDATA_RANGE && lessons.length.v[0] <= 0)
		die(EXIT_USAGE, "--section-range: want a length above 0");
	if (lessons.model == PULSES &&
		(lessons.amplitude.v[1] <= 0 || lessons.gain.v[0] <= 0))
		die(EXIT_USAGE, "--model pulses: want amplitudes and gains above 0");
}

struct delayloss_par lessons_loss(void)
{
	return (struct delayloss_par){ lessons.lambda,
		(enum delayloss_penalty)lessons.penalty };
}

struct lesson lessons_make(void)
{
	static network_loss *const loss_of[] = { network_mse, delayloss_sums,
		delayloss_unordered };
	struct delaydata_par sines = lessons_sines();
	struct cnndata_par pulses = lessons_pulses();
	uint32_t first = (uint32_t)lessons.first;

	return lessons.model == PULSES
		       ? lesson_of_pulses(&pulses, first)
		       : lesson_of_sines(&sines, loss_of[lessons.loss], first);
}

void lessons_keep(struct lesson *l)
{
	if ((double)lessons.count * l->inputs > 1 << 28)
		die(EXIT_USAGE, "--count %ld of %d numbers each: more than 2^28",
			lessons.count, l->inputs);
	if (lesson_keep(l, lessons.count))
		die(EXIT_RUN, "out of memory");
}

struct network *lessons_network(const char *path, struct netfile *file)
{
	const char *name;
	FILE *f = file_open(path, &name);
	struct lesson l = lessons_make();
	struct network *net = netfile_read(f, FORWARD, file);

	if (!net)
		die(EXIT_RUN, "%s: line %ld: %s", name, file->line, file->why);
	if (f != stdin)
		fclose(f);
	if (strcmp(l.purpose, file->purpose) != 0)
		die(EXIT_RUN, "%s: want a network for %s, got one for %s", name,
			l.purpose, file->purpose);
	if (!lesson_suits(&l, net)) {
		struct network_shape in = network_input(net);

		die(EXIT_RUN, "%s: inputs of %d x %d x %d and %d outputs do not suit %s",
			name, in.channels, in.height, in.width, network_outputs(net),
			l.purpose);
	}
	return net;
}
