/* network.c - small feed-forward networks: their layers, weights and output */
#include "net/network_state.h"
#include "num/philox.h"
#include "num/status.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int volume(struct network_shape s)
{
	return s.channels * s.height * s.width;
}

static int divide_up(int a, int b)
{
	return (a + b - 1) / b;
}

/* Shape, fan and number of weights of one layer; NUM_DOMAIN if it is out
 * of range. */
static enum num_status size_layer(struct layer *l, size_t *weights)
{
	struct network_layer *p = &l->par;
	int kernel = p->kind == NETWORK_CONV || p->kind == NETWORK_POOL;

	*weights = 0;
	if (kernel &&
		(p->width < 1 || p->height < 1 || p->width > 4096 || p->height > 4096))
		return NUM_DOMAIN;
	if (p->kind != NETWORK_POOL && (p->units < 1 || p->units > 1 << 20))
		return NUM_DOMAIN;
	l->inputs = volume(l->in);
	switch (p->kind) {
	case NETWORK_DENSE:
	case NETWORK_CASCADE:
		l->out = (struct network_shape){ 1, 1, p->units };
		if (p->kind == NETWORK_CASCADE)
			l->out.width += l->inputs;
		l->fan = l->inputs;
		break;
	case NETWORK_CONV:
		if ((double)l->in.channels * p->width * p->height > NETWORK_WEIGHTS_MAX)
			return NUM_DOMAIN;
		if (p->stride == 0)
			p->stride = 1;
		if (p->stride < 0 || p->stride > 4096)
			return NUM_DOMAIN;
		l->out = (struct network_shape){ p->units, l->in.height,
			divide_up(l->in.width, p->stride) };
		l->fan = l->in.channels * p->width * p->height;
		break;
	case NETWORK_POOL:
		l->out = (struct network_shape){ l->in.channels,
			divide_up(l->in.height, p->height),
			divide_up(l->in.width, p->width) };
		break;
	default:
		return NUM_DOMAIN;
	}
	if ((double)l->out.channels * l->out.height * l->out.width > 1 << 24)
		return NUM_DOMAIN;
	l->outputs = volume(l->out);
	if (p->kind == NETWORK_CONV &&
		(double)l->fan * l->out.height * l->out.width > NETWORK_UNFOLDED_MAX)
		return NUM_DOMAIN;
	if (p->kind != NETWORK_POOL)
		*weights = ((size_t)l->fan + 1) * (size_t)p->units;
	return *weights <= NETWORK_WEIGHTS_MAX ? NUM_OK : NUM_DOMAIN;
}

static enum num_status allocate(struct network *net)
{
	size_t columns = 1, unit = 1;

	for (int i = 0; i < net->layers; i++) {
		struct layer *l = &net->layer[i];
		size_t n = grid_size(net->batch, l->outputs);

		l->value = malloc(n * sizeof *l->value);
		l->slope = malloc(n * sizeof *l->slope);
		if (l->par.kind == NETWORK_POOL)
			l->choice = malloc(n * sizeof *l->choice);
		if (!l->value || !l->slope || (l->par.kind == NETWORK_POOL && !l->choice))
			return NUM_MEMORY;
		if (l->par.kind == NETWORK_CONV) {
			size_t c =
				(size_t)l->fan * grid_size(l->out.width, l->out.height);

			if (c > columns)
				columns = c;
		}
		if (n > unit)
			unit = n;
	}
	net->columns = malloc(columns * sizeof *net->columns);
	net->unit = malloc(unit * sizeof *net->unit);
	net->weights = calloc(net->count + 1, sizeof *net->weights); /* pools have none */
	return net->columns && net->unit && net->weights ? NUM_OK : NUM_MEMORY;
}

struct network *network_new(struct network_shape input, const struct network_layer *layer,
	int layers, int batch)
{
	struct network *net;
	size_t n;

	if (layers < 1 || layers > NETWORK_LAYERS_MAX || batch < 1 || batch > 1 << 20 ||
		input.channels < 1 || input.height < 1 || input.width < 1 ||
		(double)input.channels * input.height * input.width > 1 << 24) {
		errno = EDOM;
		return NULL;
	}
	net = calloc(1, sizeof *net);
	if (!net)
		return NULL;
	net->layers = layers;
	net->batch = batch;
	for (int i = 0; i < layers; i++) {
		struct layer *l = &net->layer[i];

		l->par = layer[i];
		l->in = i ? net->layer[i - 1].out : input;
		if (size_layer(l, &n) != NUM_OK ||
			(net->count += n) > NETWORK_WEIGHTS_MAX ||
			(double)batch * (l->inputs + l->outputs) > 1 << 28) {
			errno = EDOM;
			network_free(net);
			return NULL;
		}
		l->weight = net->count - n;
		l->bias = l->par.kind == NETWORK_POOL ? l->weight
						      : net->count - (size_t)l->par.units;
	}
	if (allocate(net)) {
		network_free(net);
		errno = ENOMEM;
		return NULL;
	}
	return net;
}

void network_free(struct network *net)
{
	if (!net)
		return;
	for (int i = 0; i < net->layers; i++) {
		free(net->layer[i].value);
		free(net->layer[i].slope);
		free(net->layer[i].choice);
	}
	free(net->columns);
	free(net->unit);
	free(net->weights);
	free(net);
}

struct network_shape network_input(const struct network *net)
{
	return net->layer[0].in;
}

int network_inputs(const struct network *net)
{
	return net->layer[0].inputs;
}

int network_outputs(const struct network *net)
{
	return net->layer[net->layers - 1].outputs;
}

int network_layers(const struct network *net)
{
	return net->layers;
}

const struct network_layer *network_layer(const struct network *net, int i)
{
	return &net->layer[i].par;
}

struct network_shape network_layer_output(const struct network *net, int i)
{
	return net->layer[i].out;
}

real *network_weights(struct network *net)
{
	return net->weights;
}

size_t network_weight_count(const struct network *net)
{
	return net->count;
}

real *network_layer_weights(struct network *net, int i, size_t *count)
{
	const struct layer *l = &net->layer[i];

	*count = l->par.kind == NETWORK_POOL ? 0
					     : l->bias - l->weight + (size_t)l->par.units;
	return net->weights + l->weight;
}

int network_batch(const struct network *net)
{
	return net->batch;
}

const real *network_activations(const struct network *net, int i)
{
	return net->layer[i].value;
}

void network_start(struct network *net, uint64_t seed, uint32_t repetition)
{
	for (int i = 0; i < net->layers; i++) {
		struct layer *l = &net->layer[i];
		double fan = l->fan, reach;
		size_t w;

		if (l->par.kind == NETWORK_POOL)
			continue;
		/* A unit of a convolution feeds width * height sums of the next layer. */
		if (l->par.activation != NETWORK_RELU)
			fan += (double)l->par.units *
			       (l->par.kind == NETWORK_CONV ? l->par.width * l->par.height
							    : 1);
		reach = sqrt(6 / fan);
		for (w = l->weight; w < l->bias; w++)
			net->weights[w] =
				(real)(reach * (2 * philox_uniform(seed, repetition,
							    RNG_NETWORK, w) -
						       1));
		for (int u = 0; u < l->par.units; u++)
			net->weights[w++] = 0;
	}
}

static real activate(enum network_activation kind, real x)
{
	switch (kind) {
	case NETWORK_TANH:
		return (real)tanh((double)x);
	case NETWORK_SIGMOID:
		return (real)(1 / (1 + exp(-(double)x)));
	case NETWORK_RELU:
		return x > 0 ? x : 0;
	default:
		return x;
	}
}

static void dense_forward(
	const struct network *net, struct layer *l, const real *x, int n)
{
	int units = l->par.units, skip = network_first_unit(l);
	const real *bias = net->weights + l->bias;

	for (int s = 0; s < n; s++) {
		real *row = l->value + network_row(l->outputs, s);

		memcpy(row, x + network_row(l->inputs, s), (size_t)skip * sizeof *row);
		memcpy(row + skip, bias, (size_t)units * sizeof *row);
	}
	gemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, n, units, l->inputs, 1, x,
		l->inputs, net->weights + l->weight, units, 1, l->value + skip,
		l->outputs);
	for (int s = 0; s < n; s++) {
		real *row = l->value + network_row(l->outputs, s) + skip;

		for (int u = 0; u < units; u++)
			row[u] = activate(l->par.activation, row[u]);
	}
}

/* Range [*begin, *end) of output columns whose input column o * stride + shift exists. */
static void overlap(int outputs, int inputs, int stride, int shift, int *begin, int *end)
{
	*begin = shift < 0 ? divide_up(-shift, stride) : 0;
	*end = inputs > shift ? divide_up(inputs - shift, stride) : 0;
	if (*end > outputs)
		*end = outputs;
	if (*begin > *end)
		*begin = *end;
}

void network_unfold(const struct layer *l, const real *x, real *columns, real *back)
{
	int kx = l->par.width, ky = l->par.height, step = l->par.stride;
	int left = (kx - 1) / 2, top = (ky - 1) / 2;
	int iw = l->in.width, ih = l->in.height, ow = l->out.width;

	for (int k = 0; k < l->fan * ih; k++, columns += ow) {
		/* From the innermost: row of places, column and row of the kernel,
		 * channel. */
		int y = k % ih, i = k / ih % kx - left, j = k / ih / kx % ky - top;
		int row = y + j, begin = 0, end = 0;
		int at = (k / ih / kx / ky * ih + row) * iw + i;

		if (row >= 0 && row < ih)
			overlap(ow, iw, step, i, &begin, &end);
		if (back) {
			for (int o = begin; o < end; o++)
				back[at + o * step] += columns[o];
			continue;
		}
		memset(columns, 0, (size_t)begin * sizeof *columns);
		for (int o = begin; o < end; o++)
			columns[o] = x[at + o * step];
		memset(columns + end, 0, (size_t)(ow - end) * sizeof *columns);
	}
}

static void conv_forward(const struct network *net, struct layer *l, const real *x, int n)
{
	int places = l->out.height * l->out.width, units = l->par.units;
	const real *bias = net->weights + l->bias;

	for (int s = 0; s < n; s++) {
		real *y = l->value + network_row(l->outputs, s);

		network_unfold(l, x + network_row(l->inputs, s), net->columns, NULL);
		for (int u = 0; u < units; u++)
			for (int p = 0; p < places; p++)
				y[u * places + p] = bias[u];
		gemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, units, places, l->fan, 1,
			net->weights + l->weight, l->fan, net->columns, places, 1, y,
			places);
		if (l->par.activation == NETWORK_LINEAR)
			continue;
		for (int i = 0; i < l->outputs; i++)
			y[i] = activate(l->par.activation, y[i]);
	}
}

static void pool_forward(struct layer *l, const real *x, int n)
{
	int kx = l->par.width, ky = l->par.height;
	size_t o = 0;

	for (int plane = 0; plane < n * l->in.channels; plane++) {
		int base = plane * l->in.height * l->in.width;

		for (int y = 0; y < l->in.height; y += ky)
			for (int i = 0; i < l->in.width; i += kx, o++) {
				int best = base + y * l->in.width + i;

				for (int r = y; r < y + ky && r < l->in.height; r++)
					for (int c = i; c < i + kx && c < l->in.width;
						c++) {
						int at = base + r * l->in.width + c;
						if (x[at] > x[best])
							best = at;
					}
				l->value[o] = x[best];
				l->choice[o] = best;
			}
	}
}

const real *network_forward(struct network *net, const real *x, int n)
{
	for (int i = 0; i < net->layers; i++) {
		struct layer *l = &net->layer[i];

		if (l->par.kind == NETWORK_CONV)
			conv_forward(net, l, x, n);
		else if (l->par.kind == NETWORK_POOL)
			pool_forward(l, x, n);
		else
			dense_forward(net, l, x, n);
		x = l->value;
	}
	return x;
}
