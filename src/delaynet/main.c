/* delaynet - train, score and apply networks that estimate delays of overlapping pulses
 */
#include "arrivals.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "example_options.h"
#include "io/signals.h"
#include "io/tables.h"
#include "scores.h"
#include "training_options.h"
#include <math.h>
#include <stdlib.h>

#ifdef WITH_OPENBLAS
void openblas_set_num_threads(int threads);
#endif

enum task { TRAIN, SCORE, APPLY, DATA };
enum { RATE = 10000 }; /* frames per second of data */

static const char *const tasks[] = { "train", "score", "apply", "data", NULL };
static const char *const models[] = { "sines", "pulses", NULL };

static int task = TRAIN;
static const char *network_file, *truth_file;
static int doubtful;

static const struct opt opts[] = {
	OPT_HEADING("Task"),
	{ 0, "task", OPT_WORD, UNIT_NONE, &task, 0, 0, "train|score|apply|data", "task",
		tasks, 0 },
	{ 0, "model", OPT_WORD, UNIT_NONE, &lessons.model, 0, 0, "sines|pulses",
		"samples: the sines of the thesis or the pulses of two sensors", models,
		0 },
	{ 0, "network", OPT_TEXT, UNIT_NONE, &network_file, 0, 0, "FILE",
		"network to apply", NULL, 0 },
	{ 0, "truth", OPT_TEXT, UNIT_NONE, &truth_file, 0, 0, "FILE",
		"with --task data: write the true delays to FILE", NULL, 1 },
	OPT_TABLE(learning_rows),
	{ 's', "seed", OPT_INT, UNIT_COUNT, &lessons.seed, 0, 9e15, "N",
		"seed of samples and weights", NULL, 0 },
	{ 0, "repetition", OPT_INT, UNIT_COUNT, &learning.repetition, 0, 1e9, "K",
		"selects the initial weights and the order of the samples", NULL, 0 },
	{ 'f', "first", OPT_INT, UNIT_COUNT, &lessons.first, 0, 4e9, "K",
		"number of the first sample; score: 1000, or 4e9 for pulses", NULL, 0 },
	{ 'c', "count", OPT_INT, UNIT_COUNT, &lessons.count, 1, 1e7, "N",
		"number of samples; score: 300", NULL, 0 },
	{ 0, "fresh", OPT_FLAG, UNIT_NONE, &learning.fresh, 0, 0, NULL,
		"new samples in every epoch", NULL, 0 },
	OPT_TABLE(lessons_rows),
	OPT_TABLE(arrivals_rows),
	OPT_END,
};

static const struct prog prog = { "delaynet",
	"Train, score and apply networks that estimate delays of overlapping pulses.",
	"[file]", "nothing; network; signal: two channels", "network; table; signal",
	opts };

static void check_options(void)
{
	lessons_check();
	if (lessons.model == PULSES && task == DATA)
		die(EXIT_USAGE, "--task data is for --model sines; see sensorsim");
	if (lessons.model == PULSES && lessons.sources > CNN_SOURCES)
		die(EXIT_USAGE, "--sources: want at most %d pulses", CNN_SOURCES);
	if (task == APPLY && !network_file)
		die(EXIT_USAGE, "--task apply requires --network FILE");
	if (task != APPLY && network_file)
		die(EXIT_USAGE, "--network requires --task apply");
	if (task == APPLY && lessons.model == PULSES)
		arrivals_check();
	else if (opt_any_given(arrivals_rows))
		die(EXIT_USAGE, "--%s is for --task apply --model pulses",
			opt_any_given(arrivals_rows));
	if (task == SCORE && !opt_given("first"))
		lessons.first = lessons.model == PULSES ? 4000000000 : 1000;
	if (task == SCORE && !opt_given("count"))
		lessons.count = 300;
	if (learning.batch == 0 || learning.batch > lessons.count)
		learning.batch = lessons.count;
	if ((double)lessons.first +
			(double)lessons.count *
				(double)(learning.fresh ? learning.epochs : 1) >
		UINT32_MAX)
		die(EXIT_USAGE, "--count: the samples run beyond number 2^32");
}

static struct table_out *create_delays(const char *path, const char *cmd, int n)
{
	struct table_out *t;
	char *columns = xstrdup("section"), *units = xstrdup("1");

	for (int i = 1; i <= n; i++) {
		columns = xappend(columns, " delay%d", i);
		units = xappend(units, " 1");
	}
	t = table_create(path, cmd, units, columns);
	free(columns);
	free(units);
	return t;
}

/* The table says it too, since the exit status is lost in a pipe. */
static void repeat_doubt(const struct signal_in *in, struct table_out *t)
{
	const char *why = signal_doubted(in);

	if (!why)
		return;
	doubtful = 1;
	table_comment(t, "doubtful", "%s", why);
}

static void put_delays(struct table_out *t, long i, const network_real *delay, int n)
{
	table_put(t, (double)i);
	for (int k = 0; k < n; k++)
		table_put(t, (double)delay[k]);
	table_end_row(t);
}

/* Sections of the width of the network, one after another. */
static void apply_network(const char *path)
{
	struct netfile file;
	struct network *net = lessons_network(network_file, &file);
	struct signal_in *in = signal_open(path, NULL);
	int n = network_input(net).width, channels = signal_format(in)->channels;
	char *cmd = opt_cmd(signal_format(in)->cmd, NULL);
	struct table_out *t = create_delays(NULL, cmd, network_outputs(net));
	double *frame = xcalloc((size_t)n * 2, sizeof *frame);
	network_real *x = xcalloc((size_t)n * 2, sizeof *x);
	size_t got;
	long k = 0;

	if (channels != 2)
		die(EXIT_RUN, "%s: want 2 channels, got %d", signal_name(in), channels);
	for (; (got = signal_read(in, frame, (size_t)n)) == (size_t)n; k++) {
		for (int i = 0; i < 2 * n; i++) {
			x[i % 2 * n + i / 2] = (network_real)frame[i];
			if (!isfinite(x[i % 2 * n + i / 2]))
				die(EXIT_RUN, "%s: frame %ld: want finite samples",
					signal_name(in), k * n + i / 2);
		}
		put_delays(t, k, network_forward(net, x, 1), network_outputs(net));
	}
	if (got > 0)
		die(EXIT_RUN, "%s: section %ld: want %d frames, got %zu", signal_name(in),
			k, n, got);
	stats_add("sections", (double)k);
	repeat_doubt(in, t);
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
	char *cmd = opt_cmd(NULL, NULL), *number = xprintf("%ld", lessons.seed);
	char *side = opt_cmd_side(NULL, "truth");
	struct signal_format format = {
		.rate = RATE, .channels = 2, .cmd = cmd, .seed = number
	};
	struct signal_out *out = signal_create(NULL, &format);
	struct table_out *t =
		truth_file ? create_delays(truth_file, side, (int)lessons.sources) : NULL;
	struct delaydata_par par = lessons_sines();
	size_t points = (size_t)lessons.points;
	network_real *x = xcalloc(2 * points, sizeof *x), delay[DELAYS_MAX];
	double *frame = xcalloc(2 * points, sizeof *frame);

	for (long i = 0; i < lessons.count; i++) {
		delaydata_sample(&par, (uint32_t)(lessons.first + i), x, delay);
		for (size_t k = 0; k < 2 * points; k++)
			frame[k] = (double)x[k % 2 * points + k / 2];
		signal_write(out, frame, points);
		if (t)
			put_delays(t, lessons.first + i, delay, par.sources);
	}
	stats_add("samples", (double)lessons.count);
	signal_done(out);
	if (t)
		table_done(t);
	free(x);
	free(frame);
	free(number);
	free(side);
	free(cmd);
}

int main(int argc, char **argv)
{
	int i = opt_parse(&prog, argc, argv);

#ifdef WITH_OPENBLAS
	/* With several threads OpenBLAS adds in another order. */
	openblas_set_num_threads(1);
#endif
	check_options();
	if (i < argc && (task == TRAIN || task == DATA))
		die(EXIT_USAGE, "--task %s has no input: omit %s", tasks[task], argv[i]);
	switch (task) {
	case TRAIN:
		learning_train();
		break;
	case SCORE:
		score_network(argv[i]);
		break;
	case APPLY:
		if (lessons.model == PULSES)
			doubtful = arrivals_apply(network_file, argv[i]);
		else
			apply_network(argv[i]);
		break;
	default:
		write_data();
	}
	return shell_done(doubtful ? EXIT_NOCONV : EXIT_SUCCESS);
}
