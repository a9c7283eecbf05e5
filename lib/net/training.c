/* training.c - networks trained by gradient descent or Adam */
#include "net/training.h"
#include "num/grid.h"
#include "num/philox.h"
#include "num/status.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef network_real real;

/* Where the shuffling begins in the stream of random numbers; network_start() draws at
 * lower places. */
#define SHUFFLE ((uint64_t)1 << 40)

/* Running means of Adam, and what a step needs. */
struct descent {
	real *weight, *gradient, *mean, *square;
	size_t weights;
	real *x, *target;
	long *order;
	int targets;
	long steps, total;
};

static void free_descent(struct descent *d)
{
	free(d->gradient);
	free(d->mean);
	free(d->square);
	free(d->x);
	free(d->target);
	free(d->order);
}

static enum num_status allocate_descent(
	struct descent *d, struct network *net, const struct network_training *par)
{
	long per_epoch = (par->samples + par->batch - 1) / par->batch;

	*d = (struct descent){ .total = per_epoch * par->epochs };
	d->weight = network_weights(net);
	d->weights = network_weight_count(net);
	d->gradient = calloc(d->weights, sizeof *d->gradient);
	d->mean = calloc(d->weights, sizeof *d->mean);
	d->square = calloc(d->weights, sizeof *d->square);
	d->x = calloc(grid_size(par->batch, network_inputs(net)), sizeof *d->x);
	d->targets = par->targets ? par->targets : network_outputs(net);
	d->target = calloc(grid_size(par->batch, d->targets), sizeof *d->target);
	d->order = malloc((size_t)par->samples * sizeof *d->order);
	return d->gradient && d->mean && d->square && d->x && d->target && d->order
		       ? NUM_OK
		       : NUM_MEMORY;
}

static double step_length(const struct network_training *par, const struct descent *d)
{
	double done = (double)d->steps / (double)d->total;

	if (par->rate_end <= 0)
		return par->rate;
	return par->rate_end + (par->rate - par->rate_end) * 0.5 * (1 + cos(M_PI * done));
}

static void update(const struct network_training *par, struct descent *d)
{
	double rate = step_length(par, d);
	/* Adam with the constants of Kingma and Ba (arXiv:1412.6980). */
	const real keep = (real)0.9, keep_square = (real)0.999;
	real step, guard;

	d->steps++;
	if (par->optimiser == NETWORK_DESCENT) {
		for (size_t w = 0; w < d->weights; w++)
			d->weight[w] = (real)(d->weight[w] - rate * d->gradient[w]);
		return;
	}
	/* The two bias corrections are included in the step and the guard. */
	guard = (real)sqrt(1 - pow(keep_square, (double)d->steps));
	step = (real)(rate * guard / (1 - pow(keep, (double)d->steps)));
	guard = (real)(guard * 1e-8);
	for (size_t w = 0; w < d->weights; w++) {
		real g = d->gradient[w];

		d->mean[w] += (1 - keep) * (g - d->mean[w]);
		d->square[w] += (1 - keep_square) * (g * g - d->square[w]);
		d->weight[w] -= step * d->mean[w] / (real)(sqrtf(d->square[w]) + guard);
	}
}

/* Fisher-Yates, a different order in each epoch. */
static void shuffle(const struct network_training *par, long epoch, long *order)
{
	for (long i = 0; i < par->samples; i++)
		order[i] = i;
	for (long i = par->samples - 1; i > 0; i--) {
		uint64_t place = SHUFFLE + (uint64_t)(epoch * par->samples + i);
		double u = philox_uniform(par->seed, par->repetition, RNG_NETWORK, place);
		long k = (long)((double)(i + 1) * u);
		long keep = order[i];

		order[i] = order[k];
		order[k] = keep;
	}
}

static double run_epoch(struct network *net, const struct network_training *par,
	struct descent *d, long epoch, network_sample *sample, void *context)
{
	int inputs = network_inputs(net);
	double sum = 0;

	if (!par->fresh)
		shuffle(par, epoch, d->order);
	for (long begin = 0; begin < par->samples; begin += par->batch) {
		long left = par->samples - begin;
		int n = left > par->batch ? par->batch : (int)left;

		for (int i = 0; i < n; i++)
			sample(context,
				par->fresh ? epoch * par->samples + begin + i
					   : d->order[begin + i],
				d->x + grid_at(inputs, 0, i),
				d->target + grid_at(d->targets, 0, i));
		sum += n * network_gradient(net, d->x, d->target, n, par->loss,
				   par->loss_context, &par->penalty, d->gradient);
		update(par, d);
	}
	return sum / (double)par->samples;
}

enum network_status network_train(struct network *net, const struct network_training *par,
	network_sample *sample, void *context)
{
	enum network_status status = NETWORK_OK;
	struct descent d;

	if (par->batch > network_batch(net))
		return NETWORK_MEMORY;
	if (allocate_descent(&d, net, par)) {
		free_descent(&d);
		return NETWORK_MEMORY;
	}
	for (long epoch = 0; epoch < par->epochs && status == NETWORK_OK; epoch++) {
		double loss = run_epoch(net, par, &d, epoch, sample, context);

		if (par->report)
			par->report(context, epoch, loss);
		if (!isfinite(loss))
			status = NETWORK_DIVERGED;
	}
	for (size_t w = 0; w < d.weights; w++)
		if (!isfinite(d.weight[w]))
			status = NETWORK_DIVERGED;
	free_descent(&d);
	return status;
}

/* Samples of an auto-encoder: the output of the layers before it is input and target. */
struct encoder {
	struct network *net;
	int layer, inputs;
	network_sample *sample;
	void *context;
	const struct network_training *par;
	real *x, *target;
};

static void encoder_sample(void *context, long i, real *x, real *target)
{
	struct encoder *e = context;
	const real *in = e->x;

	e->sample(e->context, i, e->x, e->target);
	if (e->layer) {
		network_forward(e->net, e->x, 1);
		in = network_activations(e->net, e->layer - 1);
	}
	memcpy(x, in, (size_t)e->inputs * sizeof *x);
	memcpy(target, in, (size_t)e->inputs * sizeof *target);
}

static void encoder_report(void *context, long epoch, double loss)
{
	struct encoder *e = context;

	if (e->par->report)
		e->par->report(e->context, epoch, loss);
}

enum network_status network_pretrain(struct network *net, int i,
	const struct network_training *par, network_sample *sample, void *context)
{
	struct network_shape in =
		i ? network_layer_output(net, i - 1) : network_input(net);
	int inputs = in.channels * in.height * in.width;
	int targets = par->targets ? par->targets : network_outputs(net);
	struct network_layer pair[2] = { *network_layer(net, i),
		{ NETWORK_DENSE, NETWORK_LINEAR, .units = inputs } };
	struct encoder e = { net, i, inputs, sample, context, par, NULL, NULL };
	struct network_training inner = *par;
	enum network_status status = NETWORK_MEMORY;
	struct network *both = network_new(in, pair, 2, par->batch);
	size_t count;

	inner.loss = network_mse;
	inner.targets = 0;
	inner.penalty.sparse_layer = 0;
	inner.report = encoder_report;
	e.x = malloc((size_t)network_inputs(net) * sizeof *e.x);
	e.target = malloc((size_t)targets * sizeof *e.target);
	if (both && e.x && e.target) {
		real *weight = network_layer_weights(net, i, &count);

		network_start(both, par->seed, par->repetition);
		status = network_train(both, &inner, encoder_sample, &e);
		memcpy(weight, network_weights(both), count * sizeof *weight);
	}
	network_free(both);
	free(e.x);
	free(e.target);
	return status;
}
