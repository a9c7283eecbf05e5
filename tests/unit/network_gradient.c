/* The derivatives of every kind of layer and loss against central differences.
 *
 * Networks and losses are compiled here in double precision, so that with steps of
 * 1e-5 a difference is right to about 1e-9 relative: a wrong sign, factor or index shows.
 */
#define NETWORK_DOUBLE
#include "net/network_gradient.c"
#include "net/cnn.c"
#include "net/cnndata.c"
#include "net/delayloss.c"
#include "net/network.c"
#include "tap.h"

enum { BATCH = 5 };

static double uniform(uint64_t i)
{
	return philox_uniform(7, 1, RNG_NETWORK, i);
}

static void fill(real *x, size_t n, uint64_t from)
{
	for (size_t i = 0; i < n; i++)
		x[i] = uniform(from + i);
}

struct scene {
	const char *name;
	struct network_shape input;
	int layers;
	struct network_layer layer[6];
	network_loss *loss;
	struct network_penalty penalty;
};

static double value(struct network *net, const struct scene *s, const real *x,
	const real *target, const void *context, real *scratch)
{
	return network_gradient(
		net, x, target, BATCH, s->loss, context, &s->penalty, scratch);
}

/* Changes every weight of a layer alone; the largest error over the largest slope. */
static void check(const struct scene *s)
{
	struct network *net = network_new(s->input, s->layer, s->layers, BATCH);
	struct delayloss_par par = { .lambda = 0.7 };
	size_t count = network_weight_count(net);
	real *x = malloc(BATCH * (size_t)network_inputs(net) * sizeof(real));
	real *target = malloc(BATCH * (size_t)network_outputs(net) * sizeof(real));
	real *slope = malloc(count * sizeof(real)),
	     *scratch = malloc(count * sizeof(real));
	real *weight = network_weights(net);
	double worst = 0, largest = 0, h = 1e-5;

	network_start(net, 3, 1);
	/* Biases off zero, so that their use before the activation counts. */
	for (size_t w = 0; w < count; w++)
		weight[w] += 0.02 * (uniform(5000 + w) - 0.5);
	fill(x, BATCH * (size_t)network_inputs(net), 100000);
	fill(target, BATCH * (size_t)network_outputs(net), 200000);
	value(net, s, x, target, &par, slope);
	for (size_t w = 0; w < count; w++) {
		double keep = weight[w], up, down;

		weight[w] = keep + h;
		up = value(net, s, x, target, &par, scratch);
		weight[w] = keep - h;
		down = value(net, s, x, target, &par, scratch);
		weight[w] = keep;
		worst = tap_max(worst, fabs((up - down) / (2 * h) - slope[w]));
		largest = tap_max(largest, fabs(slope[w]));
	}
	ok(largest > 1e-4 && worst < 2e-8 * fmax(largest, 1),
		"%s: %zu derivatives agree with differences, largest %.2g, worst error %.1g",
		s->name, count, largest, worst);
	free(x);
	free(target);
	free(slope);
	free(scratch);
	network_free(net);
}

/* The loss of arrivals by its outputs, for every count. */
static void check_arrivals(void)
{
	enum { ALL = CNN_SOURCES * CNN_OUTPUTS };
	real output[ALL], slope[ALL], scratch[ALL], target[CNN_SOURCES * CNNDATA_TARGETS];
	double worst = 0, h = 1e-6;

	fill(output, ALL, 300000);
	fill(target, CNN_SOURCES * CNNDATA_TARGETS, 400000);
	for (int s = 0; s < CNN_SOURCES; s++)
		target[s * CNNDATA_TARGETS] = s + 1;
	cnndata_loss(NULL, CNN_SOURCES, CNN_OUTPUTS, output, target, slope);
	for (int i = 0; i < ALL; i++) {
		double keep = output[i], up, down;

		output[i] = keep + h;
		up = cnndata_loss(
			NULL, CNN_SOURCES, CNN_OUTPUTS, output, target, scratch);
		output[i] = keep - h;
		down = cnndata_loss(
			NULL, CNN_SOURCES, CNN_OUTPUTS, output, target, scratch);
		output[i] = keep;
		worst = tap_max(worst,
			fabs((up - down) / (2 * h) - slope[i]) / fmax(fabs(slope[i]), 1));
	}
	ok(worst < 1e-7,
		"%d derivatives of the loss of arrivals agree with differences, worst error %.1g",
		ALL, worst);
}

int main(void)
{
	static const struct scene scenes[] = {
		{ "dense tanh, linear", { 1, 1, 7 }, 2,
			{ { NETWORK_DENSE, NETWORK_TANH, .units = 4 },
				{ NETWORK_DENSE, NETWORK_LINEAR, .units = 3 } },
			.loss = network_mse },
		{ "dense relu, sigmoid with decay of the weights", { 1, 2, 5 }, 2,
			{ { NETWORK_DENSE, NETWORK_RELU, .units = 6 },
				{ NETWORK_DENSE, NETWORK_SIGMOID, .units = 3 } },
			.loss = network_mse, .penalty = { .decay = 0.3 } },
		{ "two cascade layers", { 1, 1, 6 }, 3,
			{ { NETWORK_CASCADE, NETWORK_TANH, .units = 4 },
				{ NETWORK_CASCADE, NETWORK_SIGMOID, .units = 3 },
				{ NETWORK_DENSE, NETWORK_LINEAR, .units = 3 } },
			.loss = network_mse },
		{ "sparse encoder, first layer", { 1, 1, 9 }, 2,
			{ { NETWORK_DENSE, NETWORK_SIGMOID, .units = 5 },
				{ NETWORK_DENSE, NETWORK_LINEAR, .units = 9 } },
			.loss = network_mse, .penalty = { 0.01, 0, 4, 0.05 } },
		{ "sparse layer behind another", { 1, 1, 9 }, 3,
			{ { NETWORK_DENSE, NETWORK_TANH, .units = 6 },
				{ NETWORK_CASCADE, NETWORK_SIGMOID, .units = 5 },
				{ NETWORK_DENSE, NETWORK_LINEAR, .units = 3 } },
			.loss = network_mse, .penalty = { 0, 1, 4, 0.05 } },
		{ "convolution 4x2 of two rows, even kernel", { 1, 2, 11 }, 2,
			{ { NETWORK_CONV, NETWORK_TANH, 3, 4, 2, 1 },
				{ NETWORK_DENSE, NETWORK_LINEAR, .units = 3 } },
			.loss = network_mse },
		{ "two convolutions with stride, two channels", { 2, 3, 10 }, 3,
			{ { NETWORK_CONV, NETWORK_TANH, 3, 5, 3, 3 },
				{ NETWORK_CONV, NETWORK_SIGMOID, 4, 3, 2, 2 },
				{ NETWORK_DENSE, NETWORK_LINEAR, .units = 3 } },
			.loss = network_mse },
		{ "kernel wider than the row", { 1, 1, 3 }, 2,
			{ { NETWORK_CONV, NETWORK_TANH, 2, 9, 4, 2 },
				{ NETWORK_DENSE, NETWORK_LINEAR, .units = 3 } },
			.loss = network_mse },
		{ "convolution, pool, convolution, pool, dense", { 1, 2, 13 }, 6,
			{ { NETWORK_CONV, NETWORK_RELU, 3, 4, 2, 1 },
				{ NETWORK_POOL, .width = 2, .height = 2 },
				{ NETWORK_CONV, NETWORK_TANH, 2, 3, 1, 1 },
				{ NETWORK_POOL, .width = 2, .height = 1 },
				{ NETWORK_DENSE, NETWORK_RELU, .units = 8 },
				{ NETWORK_DENSE, NETWORK_LINEAR, .units = 3 } },
			.loss = network_mse },
		{ "loss of sums and variances, (3-20)", { 1, 1, 7 }, 2,
			{ { NETWORK_DENSE, NETWORK_TANH, .units = 5 },
				{ NETWORK_DENSE, NETWORK_LINEAR, .units = 3 } },
			.loss = delayloss_sums },
		{ "loss over the best order", { 1, 1, 7 }, 2,
			{ { NETWORK_DENSE, NETWORK_TANH, .units = 5 },
				{ NETWORK_DENSE, NETWORK_LINEAR, .units = 4 } },
			.loss = delayloss_unordered },
	};

	for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++)
		check(&scenes[i]);
	check_arrivals();
	return tap_done();
}
