/* delaynet - train, score and apply networks that tell the delays of overlapping pulses
 */
#include "shell/msg.h"
#include "shell/opt.h"
#include "shell/progress.h"
#include "shell/signals.h"
#include "shell/stats.h"
#include "shell/tables.h"
#include "signal/delaydata.h"
#include "signal/delayloss.h"
#include "signal/netfile.h"
#include "signal/network.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum task { TRAIN, SCORE, APPLY, DATA };
enum loss { ORDERED, SUMS, UNORDERED };
enum {
	FORWARD = 50,
	RATE = 10000
}; /* samples at a time; frames per second of --task data */

static const char *const tasks[] = {"train", "score", "apply", "data", NULL};
static const char *const activations[] = {"linear", "tanh", "sigmoid", "relu", NULL};
static const char *const optimisers[] = {"adam", "descent", NULL};
static const char *const losses[] = {"ordered", "sums", "unordered", NULL};
static const char *const penalties[] = {"squared", "absolute", NULL};
static const char *const sections[] = {"length", "period", "range", NULL};
static const char *const orders[] = {"drawn", "arrival", "sorted", NULL};

static int task = TRAIN;
static const char *network_file, *truth_file;
static const char *layers = "10";
static int activation = NETWORK_TANH, optimiser = NETWORK_ADAM, loss = ORDERED;
static int penalty = DELAYLOSS_SQUARED, fresh;
static double rate = 1e-3, rate_end, lambda = 1, decay, sparsity, sparsity_level = 0.05;
static long epochs = 100, batch = 50, pretrain, repetition, seed = 1, first, count = 1000;

static long points = 500, sources = 3;
static double span = 4 * 3.14159265358979323846, unit = 1, noise = NAN;
static int section = DELAYDATA_LENGTH, order = DELAYDATA_DRAWN, endless, scaled;
static struct opt_list length = {2, {1.57079632679489662, 4.71238898038468986}};
static struct opt_list amplitude = {2, {0, 1}};
static struct opt_list gain = {2, {0.909, 0.909}};

static const struct opt opts[] = {
	{'k', "task", OPT_WORD, UNIT_NONE, &task, 0, 0, "train|score|apply|data",
		"what to do", tasks, 0},
	{'N', "network", OPT_TEXT, UNIT_NONE, &network_file, 0, 0, "FILE",
		"network to apply", NULL, 0},
	{'T', "truth", OPT_TEXT, UNIT_NONE, &truth_file, 0, 0, "FILE",
		"with --task data: write the delays there", NULL, 1},
	{'l', "layers", OPT_TEXT, UNIT_NONE, &layers, 0, 0, "WORDS",
		"hidden layers: 50, 50+ (cascade), 10conv30x2, pool2x2, each with "
		":ACTIVATION",
		NULL, 0},
	{'a', "activation", OPT_WORD, UNIT_NONE, &activation, 0, 0,
		"linear|tanh|sigmoid|relu", "of layers that name none", activations, 0},
	{'o', "optimiser", OPT_WORD, UNIT_NONE, &optimiser, 0, 0, "adam|descent",
		"Adam or gradient descent", optimisers, 0},
	{'r', "rate", OPT_NUM, UNIT_NONE, &rate, 0, 1e3, "R", "step length", NULL, 0},
	{'R', "rate-end", OPT_NUM, UNIT_NONE, &rate_end, 0, 1e3, "R",
		"step length at the end, reached along a half cosine (0: the same)", NULL,
		0},
	{'e', "epochs", OPT_INT, UNIT_COUNT, &epochs, 0, 1e7, "N",
		"passes over the samples", NULL, 0},
	{'b', "batch", OPT_INT, UNIT_COUNT, &batch, 0, 1 << 20, "N",
		"samples per step (0: all)", NULL, 0},
	{'L', "loss", OPT_WORD, UNIT_NONE, &loss, 0, 0, "ordered|sums|unordered",
		"squared error in order, (3-20), or squared error in the best order",
		losses, 0},
	{'w', "lambda", OPT_NUM, UNIT_NONE, &lambda, 0, 1e6, "L",
		"coefficient of the penalty of (3-20)", NULL, 0},
	{'y', "penalty", OPT_WORD, UNIT_NONE, &penalty, 0, 0, "squared|absolute",
		"of the difference of the variances in (3-20)", penalties, 0},
	{'D', "decay", OPT_NUM, UNIT_NONE, &decay, 0, 1e6, "D",
		"half of this times the squared weights joins the loss", NULL, 0},
	{'p', "pretrain", OPT_INT, UNIT_COUNT, &pretrain, 0, 1e7, "N",
		"epochs of each hidden layer as an auto-encoder first", NULL, 0},
	{'q', "sparsity", OPT_NUM, UNIT_NONE, &sparsity, 0, 1e6, "B",
		"sparsity regularisation of the auto-encoders (0: none)", NULL, 0},
	{'Q', "sparsity-level", OPT_NUM, UNIT_NONE, &sparsity_level, 1e-6, 0.999999, "P",
		"sparsity proportion: the mean activation wanted", NULL, 0},
	{'s', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e15, "N", "of the data and weights",
		NULL, 0},
	{'i', "repetition", OPT_INT, UNIT_COUNT, &repetition, 0, 1e9, "K",
		"which initial weights and order of the samples", NULL, 0},
	{'f', "first", OPT_INT, UNIT_COUNT, &first, 0, 4e9, "K",
		"first sample of the set; score: 1000 if not given", NULL, 0},
	{'c', "count", OPT_INT, UNIT_COUNT, &count, 1, 1e7, "N",
		"samples; score: 300 if not given", NULL, 0},
	{'F', "fresh", OPT_FLAG, UNIT_NONE, &fresh, 0, 0, NULL,
		"new samples in every epoch", NULL, 0},
	{'x', "points", OPT_INT, UNIT_COUNT, &points, 2, 1e5, "N", "points per channel",
		NULL, 0},
	{'n', "sources", OPT_INT, UNIT_COUNT, &sources, 1, DELAYS_MAX, "N",
		"overlapping sources", NULL, 0},
	{'X', "span", OPT_NUM, UNIT_ANGLE, &span, 1e-3, 1e6, "X", "range of the x axis",
		NULL, 0},
	{'g', "section", OPT_WORD, UNIT_NONE, &section, 0, 0, "length|period|range",
		"what of the sine the range pi/2 to 3pi/2 is", sections, 0},
	{'z', "section-range", OPT_LIST, UNIT_ANGLE, &length, 0, 1e6, "A:B",
		"that range, pi/2 to 3pi/2 if not given", NULL, 0},
	{'E', "endless", OPT_FLAG, UNIT_NONE, &endless, 0, 0, NULL,
		"the sine goes on outside its section", NULL, 0},
	{'A', "amplitude", OPT_LIST, UNIT_NONE, &amplitude, 0, 1e6, "A:B",
		"amplitudes, uniform", NULL, 0},
	{'G', "gain", OPT_LIST, UNIT_NONE, &gain, 0, 1e6, "A:B",
		"of the second channel, uniform", NULL, 0},
	{'d', "delay", OPT_NUM, UNIT_ANGLE, &unit, 0, 1e6, "X", "shift of a delay of 1",
		NULL, 0},
	{'O', "labels", OPT_WORD, UNIT_NONE, &order, 0, 0, "drawn|arrival|sorted",
		"order of the delays", orders, 0},
	{'C', "scaled", OPT_FLAG, UNIT_NONE, &scaled, 0, 0, NULL,
		"divide both channels by the peak of the first", NULL, 0},
	{'u', "noise", OPT_NUM, UNIT_NONE, &noise, 0, 1e6, "SD",
		"white noise on the samples (score: of its second row, 0.316 if not "
		"given)",
		NULL, 0},
	OPT_END};

static const struct prog prog = {"delaynet",
	"Train, score and apply networks that tell the delays of overlapping pulses.",
	"[file]", "nothing; network; signal: two channels", "network; table; signal",
	opts};

static struct delaydata_par data_par(void)
{
	return (struct delaydata_par){.points = points,
		.sources = sources,
		.span = span,
		.section = section,
		.length = {length.v[0], length.v[1]},
		.endless = endless,
		.amplitude = {amplitude.v[0], amplitude.v[1]},
		.gain = {gain.v[0], gain.v[1]},
		.unit = unit,
		.order = order,
		.scaled = scaled,
		.noise = isnan(noise) ? 0 : noise,
		.seed = seed};
}

static void check_options(void)
{
	const struct opt_list *range[] = {&length, &amplitude, &gain};
	static const char *const name[] = {"section-range", "amplitude", "gain"};

	for (int i = 0; i < 3; i++)
		if (range[i]->n != 2 || range[i]->v[0] > range[i]->v[1])
			die(EXIT_USAGE, "--%s: want A:B with A <= B", name[i]);
	if (section != DELAYDATA_RANGE && length.v[0] <= 0)
		die(EXIT_USAGE, "--section-range: want a length above 0");
	if (task == APPLY && !network_file)
		die(EXIT_USAGE, "--task apply wants --network FILE");
	if (task != APPLY && network_file)
		die(EXIT_USAGE, "--network is for --task apply");
	if (task == SCORE && !opt_given('f'))
		first = 1000;
	if (task == SCORE && !opt_given('c'))
		count = 300;
	if (batch == 0 || batch > count)
		batch = count;
	if ((double)count * 2 * points > 1 << 28)
		die(EXIT_USAGE, "--count %ld of %ld points: more than 2^28 numbers",
			count, points);
}

/* The samples of a set: kept, or made on the way when every epoch takes new ones. */
struct set {
	struct delaydata_par par;
	network_real *x, *delay;
	long epochs_done, epochs;
	const char *what;
};

static struct set make_set(void)
{
	struct set set = {.par = data_par()};

	if (fresh && task == TRAIN)
		return set;
	set.x = xcalloc(count * 2 * points, sizeof *set.x);
	set.delay = xcalloc(count * sources, sizeof *set.delay);
	for (long i = 0; i < count; i++)
		delaydata_sample(&set.par, first + i, set.x + i * 2 * points,
			set.delay + i * sources);
	return set;
}

static void take_sample(void *context, long i, network_real *x, network_real *delay)
{
	const struct set *set = context;

	if (!set->x) {
		delaydata_sample(&set->par, first + i, x, delay);
		return;
	}
	memcpy(x, set->x + i * 2 * points, 2 * points * sizeof *x);
	memcpy(delay, set->delay + i * sources, sources * sizeof *delay);
}

static void report_epoch(void *context, long epoch, double value)
{
	struct set *set = context;

	progress(set->what, epoch + 1, set->epochs);
	if (verbose > 1)
		note("%s: epoch %ld: loss %g", set->what, epoch + 1, value);
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

static struct network *new_network(void)
{
	struct network_layer layer[NETWORK_LAYERS_MAX];
	struct network *net;
	char why[NETFILE_TEXT];
	int n = netfile_parse_layers(layers, activation, layer, why);

	if (n == 0)
		die(EXIT_USAGE, "--layers: %s", why);
	if (n == NETWORK_LAYERS_MAX)
		die(EXIT_USAGE, "--layers: want at most %d", NETWORK_LAYERS_MAX - 1);
	layer[n++] =
		(struct network_layer){NETWORK_DENSE, NETWORK_LINEAR, .units = sources};
	net = network_new((struct network_shape){1, 2, points}, layer, n, batch);
	if (!net)
		die(EXIT_RUN, "--layers: the network is too large");
	network_start(net, seed, repetition);
	return net;
}

static void train(void)
{
	static network_loss *const loss_of[] = {
		network_mse, delayloss_sums, delayloss_unordered};
	struct delayloss_par loss_par = {lambda, penalty};
	struct network *net = new_network();
	struct set set = make_set();
	struct network_training par = {.optimiser = optimiser,
		.rate = rate,
		.rate_end = rate_end,
		.epochs = pretrain,
		.samples = count,
		.batch = batch,
		.fresh = fresh,
		.seed = seed,
		.repetition = repetition,
		.penalty = {decay, 0, sparsity, sparsity_level},
		.loss = loss_of[loss],
		.loss_context = &loss_par,
		.report = report_epoch};
	char *cmd = opt_cmd(NULL, NULL);

	set.what = "pre-training";
	set.epochs = pretrain;
	for (int i = 0; i < network_layers(net) - 1 && pretrain > 0; i++) {
		const struct network_layer *l = network_layer(net, i);

		if (l->kind != NETWORK_DENSE)
			die(EXIT_USAGE,
				"--pretrain: only dense layers can be auto-encoders");
		if (sparsity > 0 && l->activation != NETWORK_SIGMOID)
			die(EXIT_USAGE, "--sparsity wants --activation sigmoid");
		check_trained(network_pretrain(net, i, &par, take_sample, &set));
	}
	set.what = "training";
	set.epochs = par.epochs = epochs;
	par.penalty.sparse_weight = 0;
	check_trained(network_train(net, &par, take_sample, &set));
	stats_set("weights", network_weight_count(net));
	stats_set("samples", fresh ? count * epochs : count);
	if (netfile_write(stdout, net, "delays", cmd))
		die(EXIT_RUN, "standard output:");
	free(cmd);
	free(set.x);
	free(set.delay);
	network_free(net);
}

static struct network *read_network(const char *path, struct netfile *file)
{
	int standard = !path || strcmp(path, "-") == 0;
	const char *name = standard ? "standard input" : path;
	FILE *f = standard ? stdin : fopen(path, "r");
	struct network_shape in;
	struct network *net;

	if (!f)
		die(EXIT_RUN, "%s:", name);
	net = netfile_read(f, FORWARD, file);
	if (!net)
		die(EXIT_RUN, "%s: line %ld: %s", name, file->line, file->why);
	if (!standard)
		fclose(f);
	in = network_input(net);
	if (strcmp(file->purpose, "delays") != 0 || in.channels != 1 || in.height != 2 ||
		network_outputs(net) > DELAYS_MAX)
		die(EXIT_RUN,
			"%s: want a network for delays of two channels, got one for %s",
			name, file->purpose);
	return net;
}

/* One row: what the network makes of the samples with this noise. */
static void score_row(struct table_out *t, struct network *net, double sd)
{
	struct delaylevels level = delaylevels(sources);
	struct delayloss_par loss_par = {lambda, penalty};
	struct delayscore score = {0};
	struct set set;

	noise = sd;
	set = make_set();
	for (long i = 0; i < count; i += FORWARD) {
		long n = count - i < FORWARD ? count - i : FORWARD;

		delayscore_add(&score, &loss_par, n, sources,
			network_forward(net, set.x + i * 2 * points, n),
			set.delay + i * sources);
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
	free(set.x);
	free(set.delay);
}

static void score(const char *path)
{
	struct netfile file;
	struct network *net = read_network(path, &file);
	char *cmd = opt_cmd(file.cmd, NULL);
	struct table_out *t = table_create(NULL, cmd, NULL,
		"noise samples ordered ordered_se unordered unordered_se sorted sums "
		"constant "
		"constant_sorted sorted_ordered draw");
	double sd = isnan(noise) ? sqrt(0.1) : noise;

	if (network_input(net).width != points || network_outputs(net) != sources)
		die(EXIT_RUN,
			"%s: %d points and %d delays, but the samples have %ld and %ld",
			path ? path : "standard input", network_input(net).width,
			network_outputs(net), points, sources);
	score_row(t, net, 0);
	if (sd > 0)
		score_row(t, net, sd);
	stats_add("samples", count * (1 + (sd > 0)));
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
static void apply(const char *path)
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
			if (!isfinite(frame[i]))
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
		.rate = RATE, .channels = 2, .cmd = cmd, .seed = number};
	struct signal_out *out = signal_create(NULL, &format);
	struct table_out *t = truth_file ? create_delays(truth_file, cmd, sources) : NULL;
	struct delaydata_par par = data_par();
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

	check_options();
	if (i < argc && (task == TRAIN || task == DATA))
		die(EXIT_USAGE, "--task %s reads nothing, got %s", tasks[task], argv[i]);
	switch (task) {
	case TRAIN:
		train();
		break;
	case SCORE:
		score(argv[i]);
		break;
	case APPLY:
		apply(argv[i]);
		break;
	default:
		write_data();
	}
	return shell_done(0);
}
