/* delaynet - train, score and apply networks that tell the delays of overlapping pulses
 */
#include "shell/msg.h"
#include "shell/opt.h"
#include "shell/progress.h"
#include "shell/signals.h"
#include "shell/stats.h"
#include "shell/tables.h"
#include "signal/lesson.h"
#include "signal/netfile.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef WITH_OPENBLAS
void openblas_set_num_threads(int threads);
#endif

#define PI 3.14159265358979323846

enum task { TRAIN, SCORE, APPLY, DATA };
enum model { SINES, PULSES };
enum loss { ORDERED, SUMS, UNORDERED };
enum { FORWARD = 50, RATE = 10000 }; /* samples at a time; frames per second of data */

static const char *const tasks[] = { "train", "score", "apply", "data", NULL };
static const char *const models[] = { "sines", "pulses", NULL };
static const char *const activations[] = { "linear", "tanh", "sigmoid", "relu", NULL };
static const char *const optimisers[] = { "adam", "descent", NULL };
static const char *const losses[] = { "ordered", "sums", "unordered", NULL };
static const char *const penalties[] = { "squared", "absolute", NULL };
static const char *const sections[] = { "length", "period", "range", NULL };
static const char *const orders[] = { "drawn", "arrival", "sorted", NULL };
static const char *const shapes[] = { "sine", "gauss", "lorentz", NULL };

static int task = TRAIN, model = SINES;
static const char *network_file, *truth_file;
static const char *layers = "10";
static int activation = NETWORK_TANH, optimiser = NETWORK_ADAM, loss = ORDERED;
static int penalty = DELAYLOSS_SQUARED, fresh;
static double rate = 1e-3, rate_end, lambda = 1, decay, sparsity, sparsity_level = 0.05;
static long epochs = 100, batch = 50, pretrain, repetition, seed = 1, first, count = 1000;

static long points = 500, sources = 3;
static double span = 4 * PI, unit = 1, noise = NAN;
static int section = DELAYDATA_LENGTH, order = DELAYDATA_DRAWN, endless, scaled;
static struct opt_list length = { 2, { PI / 2, 3 * PI / 2 } };
static struct opt_list amplitude = { 2, { 0, 1 } };
static struct opt_list gain = { 2, { 0.909, 0.909 } };

static int shape = PULSE_SINE;
static double separation = 0.1;
static struct opt_list snr = { 2, { 12, 45 } };
static struct opt_list reach = { 2, { CNN_REACH_MIN, CNN_REACH_MAX } };

static const struct opt opts[] = {
	{ 'k', "task", OPT_WORD, UNIT_NONE, &task, 0, 0, "train|score|apply|data",
		"what to do", tasks, 0 },
	{ 'm', "model", OPT_WORD, UNIT_NONE, &model, 0, 0, "sines|pulses",
		"samples: the sines of the thesis or the pulses of two sensors", models,
		0 },
	{ 'N', "network", OPT_TEXT, UNIT_NONE, &network_file, 0, 0, "FILE",
		"network to apply", NULL, 0 },
	{ 'T', "truth", OPT_TEXT, UNIT_NONE, &truth_file, 0, 0, "FILE",
		"with --task data: write the delays there", NULL, 1 },
	{ 'l', "layers", OPT_TEXT, UNIT_NONE, &layers, 0, 0, "WORDS",
		"hidden layers: 50, 50+ (cascade), 10conv30x2, pool2x2, each with "
		":ACTIVATION",
		NULL, 0 },
	{ 'a', "activation", OPT_WORD, UNIT_NONE, &activation, 0, 0,
		"linear|tanh|sigmoid|relu", "of layers that name none", activations, 0 },
	{ 'o', "optimiser", OPT_WORD, UNIT_NONE, &optimiser, 0, 0, "adam|descent",
		"Adam or gradient descent", optimisers, 0 },
	{ 'r', "rate", OPT_NUM, UNIT_NONE, &rate, 0, 1e3, "R", "step length", NULL, 0 },
	{ 'Y', "rate-end", OPT_NUM, UNIT_NONE, &rate_end, 0, 1e3, "R",
		"step length at the end, reached along a half cosine (0: the same)", NULL,
		0 },
	{ 'e', "epochs", OPT_INT, UNIT_COUNT, &epochs, 0, 1e7, "N",
		"passes over the samples", NULL, 0 },
	{ 'b', "batch", OPT_INT, UNIT_COUNT, &batch, 0, 1 << 20, "N",
		"samples per step (0: all)", NULL, 0 },
	{ 'L', "loss", OPT_WORD, UNIT_NONE, &loss, 0, 0, "ordered|sums|unordered",
		"squared error in order, (3-20), or squared error in the best order",
		losses, 0 },
	{ 'W', "lambda", OPT_NUM, UNIT_NONE, &lambda, 0, 1e6, "L",
		"coefficient of the penalty of (3-20)", NULL, 0 },
	{ 'y', "penalty", OPT_WORD, UNIT_NONE, &penalty, 0, 0, "squared|absolute",
		"of the difference of the variances in (3-20)", penalties, 0 },
	{ 'D', "decay", OPT_NUM, UNIT_NONE, &decay, 0, 1e6, "D",
		"half of this times the squared weights joins the loss", NULL, 0 },
	{ 'p', "pretrain", OPT_INT, UNIT_COUNT, &pretrain, 0, 1e7, "N",
		"epochs of each hidden layer as an auto-encoder first", NULL, 0 },
	{ 'q', "sparsity", OPT_NUM, UNIT_NONE, &sparsity, 0, 1e6, "B",
		"sparsity regularisation of the auto-encoders (0: none)", NULL, 0 },
	{ 'Q', "sparsity-level", OPT_NUM, UNIT_NONE, &sparsity_level, 1e-6, 0.999999, "P",
		"sparsity proportion: the mean activation wanted", NULL, 0 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e15, "N",
		"of the data and weights", NULL, 0 },
	{ 'i', "repetition", OPT_INT, UNIT_COUNT, &repetition, 0, 1e9, "K",
		"which initial weights and order of the samples", NULL, 0 },
	{ 'f', "first", OPT_INT, UNIT_COUNT, &first, 0, 4e9, "K",
		"first sample of the set; score: 1000, or 4e9 of pulses, if not given",
		NULL, 0 },
	{ 'c', "count", OPT_INT, UNIT_COUNT, &count, 1, 1e7, "N",
		"samples; score: 300 if not given", NULL, 0 },
	{ 'F', "fresh", OPT_FLAG, UNIT_NONE, &fresh, 0, 0, NULL,
		"new samples in every epoch", NULL, 0 },
	{ 'x', "columns", OPT_INT, UNIT_COUNT, &points, 2, 1e5, "N", "points per channel",
		NULL, 0 },
	{ 'n', "sources", OPT_INT, UNIT_COUNT, &sources, 1, DELAYS_MAX, "N",
		"overlapping sources", NULL, 0 },
	{ 'X', "span", OPT_NUM, UNIT_ANGLE, &span, 1e-3, 1e6, "X", "range of the x axis",
		NULL, 0 },
	{ 'B', "section", OPT_WORD, UNIT_NONE, &section, 0, 0, "length|period|range",
		"what of the sine the range pi/2 to 3pi/2 is", sections, 0 },
	{ 'z', "section-range", OPT_LIST, UNIT_ANGLE, &length, 0, 1e6, "A:B",
		"that range, pi/2 to 3pi/2 if not given", NULL, 0 },
	{ 'E', "endless", OPT_FLAG, UNIT_NONE, &endless, 0, 0, NULL,
		"the sine goes on outside its section", NULL, 0 },
	{ 'A', "amplitude", OPT_LIST, UNIT_NONE, &amplitude, 0, 1e6, "A:B",
		"amplitudes, uniform", NULL, 0 },
	{ 'g', "gain", OPT_LIST, UNIT_NONE, &gain, 0, 1e6, "A:B",
		"of the second channel, uniform", NULL, 0 },
	{ 'd', "delay", OPT_NUM, UNIT_ANGLE, &unit, 0, 1e6, "X", "shift of a delay of 1",
		NULL, 0 },
	{ 'O', "labels", OPT_WORD, UNIT_NONE, &order, 0, 0, "drawn|arrival|sorted",
		"order of the delays", orders, 0 },
	{ 'C', "scaled", OPT_FLAG, UNIT_NONE, &scaled, 0, 0, NULL,
		"divide both channels by the peak of the first", NULL, 0 },
	{ 'u', "deviation", OPT_NUM, UNIT_NONE, &noise, 0, 1e6, "SD",
		"of white noise on the samples (score: of its second row, 0.316 if not "
		"given)",
		NULL, 0 },
	{ 'R', "snr", OPT_LIST, UNIT_DECIBEL, &snr, -20, 200, "A:B",
		"pulses: peak of amplitude 1 over the noise", NULL, 0 },
	{ 't', "separation", OPT_NUM, UNIT_NONE, &separation, 0, 0.5, "D",
		"pulses: least distance of arrivals, pulse durations", NULL, 0 },
	{ 'H', "reach", OPT_LIST, UNIT_NONE, &reach, CNN_REACH_MIN, CNN_REACH_MAX, "A:B",
		"pulses: largest delay, pulse durations", NULL, 0 },
	{ 'w', "pulse", OPT_WORD, UNIT_NONE, &shape, 0, 0, "sine|gauss|lorentz",
		"pulses: their shape", shapes, 0 },
	OPT_END,
};

static const struct prog prog = { "delaynet",
	"Train, score and apply networks that tell the delays of overlapping pulses.",
	"[file]", "nothing; network; signal: two channels", "network; table; signal",
	opts };

static struct delaydata_par sine_par(void)
{
	return (struct delaydata_par){ .points = points,
		.sources = sources,
		.span = span,
		.section = section,
		.length = { length.v[0], length.v[1] },
		.endless = endless,
		.amplitude = { amplitude.v[0], amplitude.v[1] },
		.gain = { gain.v[0], gain.v[1] },
		.unit = unit,
		.order = order,
		.scaled = scaled,
		.noise = isnan(noise) ? 0 : noise,
		.seed = seed };
}

static struct cnndata_par pulse_par(void)
{
	struct cnndata_par par = cnndata_default();

	if (opt_given('n'))
		par.sources[0] = par.sources[1] = sources;
	if (opt_given('g'))
		memcpy(par.gain, gain.v, sizeof par.gain);
	if (opt_given('A')) {
		par.size[0] = cbrt(amplitude.v[0]);
		par.size[1] = cbrt(amplitude.v[1]);
	}
	memcpy(par.snr, snr.v, sizeof par.snr);
	memcpy(par.reach, reach.v, sizeof par.reach);
	par.spacing = separation;
	par.shape = shape;
	par.seed = seed;
	return par;
}

static void check_options(void)
{
	const struct opt_list *range[] = { &length, &amplitude, &gain, &snr, &reach };
	static const char *const name[] = { "section-range", "amplitude", "gain", "snr",
		"reach" };

	for (int i = 0; i < 5; i++)
		if (range[i]->n != 2 || range[i]->v[0] > range[i]->v[1])
			die(EXIT_USAGE, "--%s: want A:B with A <= B", name[i]);
	if (section != DELAYDATA_RANGE && length.v[0] <= 0)
		die(EXIT_USAGE, "--section-range: want a length above 0");
	if (model == PULSES && (amplitude.v[1] <= 0 || gain.v[0] <= 0))
		die(EXIT_USAGE, "--model pulses: want amplitudes and gains above 0");
	if (model == PULSES && (task == APPLY || task == DATA))
		die(EXIT_USAGE, "--task %s is for --model sines; see duet and sensorsim",
			tasks[task]);
	if (model == PULSES && sources > CNN_SOURCES)
		die(EXIT_USAGE, "--sources: want at most %d pulses", CNN_SOURCES);
	if (task == APPLY && !network_file)
		die(EXIT_USAGE, "--task apply wants --network FILE");
	if (task != APPLY && network_file)
		die(EXIT_USAGE, "--network is for --task apply");
	if (task == SCORE && !opt_given('f'))
		first = model == PULSES ? 4000000000 : 1000;
	if (task == SCORE && !opt_given('c'))
		count = 300;
	if (batch == 0 || batch > count)
		batch = count;
	if (first + (double)count * (fresh ? epochs : 1) > UINT32_MAX)
		die(EXIT_USAGE, "--count: the samples run beyond number 2^32");
}

static struct lesson new_lesson(void)
{
	static network_loss *const loss_of[] = { network_mse, delayloss_sums,
		delayloss_unordered };
	struct delaydata_par sines = sine_par();
	struct cnndata_par pulses = pulse_par();

	return model == PULSES ? lesson_of_pulses(&pulses, first)
			       : lesson_of_sines(&sines, loss_of[loss], first);
}

static void keep_samples(struct lesson *l)
{
	if ((double)count * l->inputs > 1 << 28)
		die(EXIT_USAGE, "--count %ld of %d numbers each: more than 2^28", count,
			l->inputs);
	if (!lesson_keep(l, count))
		die(EXIT_RUN, "out of memory");
}

/* For the report: what is going on, and for how long. */
static const char *phase;
static long phase_epochs;

static void report_epoch(void *context, long epoch, double value)
{
	(void)context;
	progress(phase, epoch + 1, phase_epochs);
	if ((epoch + 1) % ((phase_epochs + 9) / 10) == 0)
		note("%s: epoch %ld: loss %g", phase, epoch + 1, value);
	stats_add("epochs", 1);
	stats_set("loss", value);
}

static void check_trained(enum network_status status)
{
	if (status == NETWORK_MEMORY)
		die(EXIT_RUN, "out of memory");
	if (status == NETWORK_DIVERGED)
		die(EXIT_RUN, "the training diverged: want a smaller --rate than %g",
			rate);
}

static struct network *new_network(const struct lesson *l)
{
	struct network_layer layer[NETWORK_LAYERS_MAX];
	struct network *net;
	char why[NETFILE_TEXT];
	int n = netfile_parse_layers(layers, activation, layer, why);

	if (n == 0)
		die(EXIT_USAGE, "--layers: %s", why);
	if (n >= NETWORK_LAYERS_MAX)
		die(EXIT_USAGE, "--layers: want at most %d", NETWORK_LAYERS_MAX - 1);
	layer[n++] = (struct network_layer){ NETWORK_DENSE, NETWORK_LINEAR,
		.units = l->outputs };
	net = network_new(l->input, layer, n, batch);
	if (!net)
		die(EXIT_RUN, "--layers: the network is too large");
	network_start(net, seed, repetition);
	return net;
}

static void train(void)
{
	struct delayloss_par loss_par = { lambda, penalty };
	struct lesson l = new_lesson();
	struct network *net = new_network(&l);
	struct network_training par = { .optimiser = optimiser,
		.rate = rate,
		.rate_end = rate_end,
		.epochs = pretrain,
		.samples = count,
		.batch = batch,
		.fresh = fresh,
		.seed = seed,
		.repetition = repetition,
		.penalty = { decay, 0, sparsity, sparsity_level },
		.targets = l.targets,
		.loss = l.loss,
		.loss_context = &loss_par,
		.report = report_epoch };
	char *cmd = opt_cmd(NULL, NULL);

	if (!fresh)
		keep_samples(&l);
	phase = "pre-training";
	phase_epochs = pretrain;
	for (int i = 0; i < network_layers(net) - 1 && pretrain > 0; i++) {
		const struct network_layer *layer = network_layer(net, i);

		if (layer->kind != NETWORK_DENSE)
			die(EXIT_USAGE,
				"--pretrain: only dense layers can be auto-encoders");
		if (sparsity > 0 && layer->activation != NETWORK_SIGMOID)
			die(EXIT_USAGE, "--sparsity wants --activation sigmoid");
		check_trained(network_pretrain(net, i, &par, lesson_sample, &l));
	}
	phase = "training";
	phase_epochs = par.epochs = epochs;
	par.penalty.sparse_weight = 0;
	check_trained(network_train(net, &par, lesson_sample, &l));
	stats_set("weights", network_weight_count(net));
	stats_set("samples", fresh ? count * epochs : count);
	if (netfile_write(stdout, net, l.purpose, cmd))
		die(EXIT_RUN, "standard output:");
	free(cmd);
	lesson_drop(&l);
	network_free(net);
}

static struct network *read_network(const char *path, struct netfile *file)
{
	int standard = !path || strcmp(path, "-") == 0;
	const char *name = standard ? "standard input" : path;
	FILE *f = standard ? stdin : fopen(path, "r");
	struct lesson l = new_lesson();
	struct network *net;

	if (!f)
		die(EXIT_RUN, "%s:", name);
	net = netfile_read(f, FORWARD, file);
	if (!net)
		die(EXIT_RUN, "%s: line %ld: %s", name, file->line, file->why);
	if (!standard)
		fclose(f);
	if (!lesson_suits(&l, net, file->purpose))
		die(EXIT_RUN, "%s: want a network for %s, got one for %s", name,
			l.purpose, file->purpose);
	return net;
}

/* One row: what the network makes of the samples with this noise. */
static void score_sines(struct table_out *t, struct network *net, double sd)
{
	struct delaylevels level = delaylevels(sources);
	struct delayloss_par loss_par = { lambda, penalty };
	struct delayscore score = { 0 };
	struct lesson l;

	noise = sd;
	l = new_lesson();
	keep_samples(&l);
	for (long i = 0; i < count; i += FORWARD) {
		long n = count - i < FORWARD ? count - i : FORWARD;

		delayscore_add(&score, &loss_par, n, sources,
			network_forward(net, l.x + i * l.inputs, n),
			l.target + i * l.targets);
	}
	delayscore_finish(&score);
	table_put(t, sd);
	table_put(t, score.samples);
	table_put(t, score.ordered);
	table_put(t, score.ordered_se);
	table_put(t, score.unordered);
	table_put(t, score.unordered_se);
	table_put(t, score.sorted);
	table_put(t, score.sums);
	table_put(t, level.constant);
	table_put(t, level.constant_sorted);
	table_put(t, level.sorted_ordered);
	table_put(t, level.draw);
	table_end_row(t);
	stats_add("samples", count);
	lesson_drop(&l);
}

/* One row: sections of n pulses. */
static void score_pulses(struct table_out *t, struct network *net, int n)
{
	struct cnndata_par par = pulse_par();
	struct cnndata_score score;

	par.sources[0] = par.sources[1] = n;
	score = cnndata_score(net, &par, first, count);
	table_put(t, n);
	table_put(t, count);
	table_put(t, score.count_right);
	table_put(t, score.arrival);
	table_put(t, score.delay);
	table_put(t, score.alone);
	table_put(t, score.size);
	table_end_row(t);
	stats_add("samples", count);
}

static void score_network(const char *path)
{
	struct netfile file;
	struct network *net = read_network(path, &file);
	char *cmd = opt_cmd(file.cmd, NULL);
	struct table_out *t = table_create(NULL, cmd, NULL,
		model == SINES
			? "noise samples ordered ordered_se unordered unordered_se sorted "
			  "sums constant constant_sorted sorted_ordered draw"
			: "sources sections count_right arrival_rmse delay_rmse "
			  "delay_alone size_rmse");
	double sd = isnan(noise) ? sqrt(0.1) : noise;

	if (model == SINES &&
		(network_input(net).width != points || network_outputs(net) != sources))
		die(EXIT_RUN,
			"%s: %d points and %d delays, but the samples have %ld and %ld",
			path ? path : "standard input", network_input(net).width,
			network_outputs(net), points, sources);
	if (model == SINES)
		score_sines(t, net, 0);
	if (model == SINES && sd > 0)
		score_sines(t, net, sd);
	for (int n = 1; n <= CNN_SOURCES && model == PULSES; n++)
		if (!opt_given('n') || n == sources)
			score_pulses(t, net, n);
	table_done(t);
	free(cmd);
	free(file.cmd);
	network_free(net);
}

static struct table_out *create_delays(const char *path, const char *cmd, int n)
{
	struct table_out *t;
	char *columns = xstrdup("section");

	for (int i = 1; i <= n; i++) {
		char *longer = xprintf("%s delay%d", columns, i);

		free(columns);
		columns = longer;
	}
	t = table_create(path, cmd, NULL, columns);
	free(columns);
	return t;
}

static void put_delays(struct table_out *t, long i, const network_real *delay, int n)
{
	table_put(t, i);
	for (int k = 0; k < n; k++)
		table_put(t, delay[k]);
	table_end_row(t);
}

/* Sections of the width of the network, one after another. */
static void apply_network(const char *path)
{
	struct netfile file;
	struct network *net = read_network(network_file, &file);
	struct signal_in *in = signal_open(path, NULL);
	int n = network_input(net).width, channels = signal_format(in)->channels;
	char *cmd = opt_cmd(signal_format(in)->cmd, NULL);
	struct table_out *t = create_delays(NULL, cmd, network_outputs(net));
	double *frame = xcalloc(n * 2, sizeof *frame);
	network_real *x = xcalloc(n * 2, sizeof *x);
	size_t got;
	long k = 0;

	if (channels != 2)
		die(EXIT_RUN, "%s: want 2 channels, got %d", signal_name(in), channels);
	for (; (got = signal_read(in, frame, n)) == (size_t)n; k++) {
		for (int i = 0; i < 2 * n; i++) {
			x[i % 2 * n + i / 2] = frame[i];
			if (!isfinite(x[i % 2 * n + i / 2]))
				die(EXIT_RUN, "%s: frame %ld: want finite samples",
					signal_name(in), k * n + i / 2);
		}
		put_delays(t, k, network_forward(net, x, 1), network_outputs(net));
	}
	if (got > 0)
		die(EXIT_RUN, "%s: section %ld: want %d frames, got %zu", signal_name(in),
			k, n, got);
	stats_add("sections", k);
	table_done(t);
	signal_close(in);
	free(frame);
	free(x);
	free(cmd);
	free(file.cmd);
	network_free(net);
}

static void write_data(void)
{
	char *cmd = opt_cmd(NULL, NULL), *number = xprintf("%ld", seed);
	struct signal_format format = {
		.rate = RATE, .channels = 2, .cmd = cmd, .seed = number
	};
	struct signal_out *out = signal_create(NULL, &format);
	struct table_out *t = truth_file ? create_delays(truth_file, cmd, sources) : NULL;
	struct delaydata_par par = sine_par();
	network_real *x = xcalloc(2 * points, sizeof *x), delay[DELAYS_MAX];
	double *frame = xcalloc(2 * points, sizeof *frame);

	for (long i = 0; i < count; i++) {
		delaydata_sample(&par, first + i, x, delay);
		for (long k = 0; k < 2 * points; k++)
			frame[k] = x[k % 2 * points + k / 2];
		signal_write(out, frame, points);
		if (t)
			put_delays(t, first + i, delay, sources);
	}
	stats_add("samples", count);
	signal_done(out);
	if (t)
		table_done(t);
	free(x);
	free(frame);
	free(number);
	free(cmd);
}

int main(int argc, char **argv)
{
	int i = opt_parse(&prog, argc, argv);

#ifdef WITH_OPENBLAS
	/* Its threads share out sums in another order. */
	openblas_set_num_threads(1);
#endif
	check_options();
	if (i < argc && (task == TRAIN || task == DATA))
		die(EXIT_USAGE, "--task %s reads nothing, got %s", tasks[task], argv[i]);
	switch (task) {
	case TRAIN:
		train();
		break;
	case SCORE:
		score_network(argv[i]);
		break;
	case APPLY:
		apply_network(argv[i]);
		break;
	default:
		write_data();
	}
	return shell_done(0);
}
