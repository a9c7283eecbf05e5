#include "training_options.h"
#include "cli/msg.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include "example_options.h"
#include <stdlib.h>

struct learning learning = { .layers = "10",
	.activation = NETWORK_TANH,
	.optimiser = NETWORK_ADAM,
	.rate = 1e-3,
	.sparsity_level = 0.05,
	.epochs = 100,
	.batch = 50 };

static const char *const activations[] = { "linear", "tanh", "sigmoid", "relu", NULL };
static const char *const optimisers[] = { "adam", "descent", NULL };
static const char *const losses[] = { "ordered", "sums", "unordered", NULL };
static const char *const penalties[] = { "squared", "absolute", NULL };

struct opt learning_rows[] = { OPT_HEADING("Network and training"),
	{ 0, "layers", OPT_TEXT, UNIT_NONE, &learning.layers, 0, 0, "WORDS",
		"hidden layers: 50, 50+ (cascade), 10conv30x2, pool2x2, each with "
		":ACTIVATION",
		NULL, 0 },
	{ 0, "activation", OPT_WORD, UNIT_NONE, &learning.activation, 0, 0,
		"linear|tanh|sigmoid|relu", "activation of layers that specify none",
		activations, 0 },
	{ 0, "optimiser", OPT_WORD, UNIT_NONE, &learning.optimiser, 0, 0, "adam|descent",
		"Adam or gradient descent", optimisers, 0 },
	{ 0, "learning-rate", OPT_NUM, UNIT_NONE, &learning.rate, 0, 1e3, "R",
		"learning rate", NULL, 0 },
	{ 0, "learning-rate-end", OPT_NUM, UNIT_NONE, &learning.rate_end, 0, 1e3, "R",
		"final learning rate, reached along a half cosine (0: constant)", NULL,
		0 },
	{ 0, "epochs", OPT_INT, UNIT_COUNT, &learning.epochs, 0, 1e7, "N",
		"passes over the samples", NULL, 0 },
	{ 0, "batch", OPT_INT, UNIT_COUNT, &learning.batch, 0, 1 << 20, "N",
		"samples per step (0: all)", NULL, 0 },
	{ 0, "loss", OPT_WORD, UNIT_NONE, &lessons.loss, 0, 0, "ordered|sums|unordered",
		"loss: squared error by position, (3-20), or of the best permutation",
		losses, 0 },
	{ 0, "lambda", OPT_NUM, UNIT_NONE, &lessons.lambda, 0, 1e6, "L",
		"coefficient of the penalty of (3-20)", NULL, 0 },
	{ 0, "penalty", OPT_WORD, UNIT_NONE, &lessons.penalty, 0, 0, "squared|absolute",
		"penalty on the difference of the variances in (3-20)", penalties, 0 },
	{ 0, "decay", OPT_NUM, UNIT_NONE, &learning.decay, 0, 1e6, "D",
		"weight decay: D/2 times the sum of squared weights", NULL, 0 },
	{ 0, "pretrain", OPT_INT, UNIT_COUNT, &learning.pretrain, 0, 1e7, "N",
		"epochs of each hidden layer as an auto-encoder first", NULL, 0 },
	{ 0, "sparsity", OPT_NUM, UNIT_NONE, &learning.sparsity, 0, 1e6, "B",
		"sparsity regularisation of the auto-encoders (0: none)", NULL, 0 },
	{ 0, "sparsity-level", OPT_NUM, UNIT_NONE, &learning.sparsity_level, 1e-6,
		0.999999, "P", "sparsity proportion: target mean activation", NULL, 0 },
	OPT_END };

/* For the report: the present phase of the training and its number of epochs. */
static const char *phase;
static long phase_epochs;

static void report_epoch(void *context, long epoch, double value)
{
	(void)context;
	progress(phase, (double)(epoch + 1), (double)phase_epochs);
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
		die(EXIT_RUN, "the training diverged: use a --learning-rate below %g",
			learning.rate);
}

static struct network *new_network(const struct lesson *l)
{
	struct network_layer layer[NETWORK_LAYERS_MAX];
	struct network *net;
	char why[NETFILE_TEXT];
	int n;

	if (netfile_parse_layers(learning.layers,
		    (enum network_activation)learning.activation, layer, &n,
		    why) != NUM_OK)
		die(EXIT_USAGE, "--layers: %s", why);
	if (n >= NETWORK_LAYERS_MAX)
		die(EXIT_USAGE, "--layers: want at most %d", NETWORK_LAYERS_MAX - 1);
	layer[n++] = (struct network_layer){ NETWORK_DENSE, NETWORK_LINEAR,
		.units = l->outputs };
	net = network_new(l->input, layer, n, (int)learning.batch);
	if (!net)
		die(EXIT_RUN, "--layers: the network is too large");
	network_start(net, (uint64_t)lessons.seed, (uint32_t)learning.repetition);
	return net;
}

void learning_train(void)
{
	struct delayloss_par loss_par = lessons_loss();
	struct lesson l = lessons_make();
	struct network *net = new_network(&l);
	struct network_training par = {
		.optimiser = (enum network_optimiser)learning.optimiser,
		.rate = learning.rate,
		.rate_end = learning.rate_end,
		.epochs = learning.pretrain,
		.samples = lessons.count,
		.batch = (int)learning.batch,
		.fresh = learning.fresh,
		.seed = (uint64_t)lessons.seed,
		.repetition = (uint32_t)learning.repetition,
		.penalty = { learning.decay, 0, learning.sparsity,
			learning.sparsity_level },
		.targets = l.targets,
		.loss = l.loss,
		.loss_context = &loss_par,
		.report = report_epoch
	};
	char *cmd = opt_cmd(NULL, NULL);

	if (!learning.fresh)
		lessons_keep(&l);
	phase = "pre-training";
	phase_epochs = learning.pretrain;
	for (int i = 0; i < network_layers(net) - 1 && learning.pretrain > 0; i++) {
		const struct network_layer *layer = network_layer(net, i);

		if (layer->kind != NETWORK_DENSE)
			die(EXIT_USAGE,
				"--pretrain: only dense layers can be pretrained");
		if (learning.sparsity > 0 && layer->activation != NETWORK_SIGMOID)
			die(EXIT_USAGE, "--sparsity requires --activation sigmoid");
		check_trained(network_pretrain(net, i, &par, lesson_sample, &l));
	}
	phase = "training";
	phase_epochs = par.epochs = learning.epochs;
	par.penalty.sparse_weight = 0;
	check_trained(network_train(net, &par, lesson_sample, &l));
	stats_set("weights", (double)network_weight_count(net));
	stats_set("samples", (double)(learning.fresh ? lessons.count * learning.epochs
						     : lessons.count));
	if (netfile_write(stdout, net, l.purpose, cmd))
		die(EXIT_RUN, "out of memory");
	if (ferror(stdout))
		die(EXIT_RUN, "standard output:");
	free(cmd);
	lesson_drop(&l);
	network_free(net);
}
