/* network_gradient.c - derivatives of a network's loss by back-propagation */
#include "net/network_state.h"
#include <math.h>
#include <string.h>

/* Derivative of the activation from its value. */
static real incline(enum network_activation kind, real y)
{
	switch (kind) {
	case NETWORK_TANH:
		return 1 - y * y;
	case NETWORK_SIGMOID:
		return y * (1 - y);
	case NETWORK_RELU:
		return y > 0;
	default:
		return 1;
	}
}

/* Gradient by the weights of layer l, and by its input into back unless NULL. */
static void dense_backward(const struct network *net, const struct layer *l,
	const real *x, int n, real *gradient, real *back)
{
	int units = l->par.units, skip = network_first_unit(l);
	real *unit = net->unit, *bias = gradient + l->bias;

	memset(bias, 0, (size_t)units * sizeof *bias);
	for (int s = 0; s < n; s++) {
		const real *y = l->value + network_row(l->outputs, s) + skip;
		const real *dy = l->slope + network_row(l->outputs, s) + skip;

		for (int u = 0; u < units; u++) {
			unit[s * units + u] = dy[u] * incline(l->par.activation, y[u]);
			bias[u] += unit[s * units + u];
		}
	}
	gemm(CblasRowMajor, CblasTrans, CblasNoTrans, l->inputs, units, n, 1, x,
		l->inputs, unit, units, 0, gradient + l->weight, units);
	if (!back)
		return;
	for (int s = 0; s < n && skip; s++)
		memcpy(back + network_row(l->inputs, s),
			l->slope + network_row(l->outputs, s),
			(size_t)skip * sizeof *back);
	gemm(CblasRowMajor, CblasNoTrans, CblasTrans, n, l->inputs, units, 1, unit, units,
		net->weights + l->weight, units, skip ? 1 : 0, back, l->inputs);
}

static void conv_backward(const struct network *net, const struct layer *l, const real *x,
	int n, real *gradient, real *back)
{
	int places = l->out.height * l->out.width, units = l->par.units;
	real *unit = net->unit, *bias = gradient + l->bias;

	memset(gradient + l->weight, 0,
		(l->bias - l->weight + (size_t)units) * sizeof *gradient);
	if (back)
		memset(back, 0, grid_size(n, l->inputs) * sizeof *back);
	for (int s = 0; s < n; s++) {
		const real *y = l->value + network_row(l->outputs, s);
		const real *dy = l->slope + network_row(l->outputs, s);

		for (int u = 0; u < units; u++)
			for (int p = u * places; p < (u + 1) * places; p++) {
				unit[p] = dy[p] * incline(l->par.activation, y[p]);
				bias[u] += unit[p];
			}
		network_unfold(l, x + network_row(l->inputs, s), net->columns, NULL);
		gemm(CblasRowMajor, CblasNoTrans, CblasTrans, units, l->fan, places, 1,
			unit, places, net->columns, places, 1, gradient + l->weight,
			l->fan);
		if (!back)
			continue;
		gemm(CblasRowMajor, CblasTrans, CblasNoTrans, l->fan, places, units, 1,
			net->weights + l->weight, l->fan, unit, places, 0, net->columns,
			places);
		network_unfold(l, NULL, net->columns, back + network_row(l->inputs, s));
	}
}

static void pool_backward(const struct layer *l, int n, real *back)
{
	if (!back)
		return;
	memset(back, 0, grid_size(n, l->inputs) * sizeof *back);
	for (size_t o = 0; o < grid_size(n, l->outputs); o++)
		back[l->choice[o]] += l->slope[o];
}

double network_mse(const void *context, int n, int width, const real *output,
	const real *target, real *gradient)
{
	double sum = 0, scale = 1.0 / ((double)n * width);

	(void)context;
	for (size_t i = 0; i < grid_size(n, width); i++) {
		double d = (double)output[i] - target[i];

		sum += d * d;
		gradient[i] = (real)(2 * scale * d);
	}
	return sum * scale;
}

/* Adds the Kullback-Leibler penalty of a layer and its slope. */
static double add_sparsity(struct layer *l, int n, double weight, double level)
{
	int skip = network_first_unit(l);
	double sum = 0;

	for (int u = skip; u < skip + l->par.units; u++) {
		double mean = 0, slope;

		for (int s = 0; s < n; s++)
			mean += (double)l->value[grid_at(l->outputs, u, s)];
		mean /= n;
		mean = fmin(fmax(mean, 1e-6), 1 - 1e-6);
		sum += level * log(level / mean) +
		       (1 - level) * log((1 - level) / (1 - mean));
		slope = weight / n * ((1 - level) / (1 - mean) - level / mean);
		for (int s = 0; s < n; s++) {
			real *at = &l->slope[grid_at(l->outputs, u, s)];

			*at = (real)(*at + slope);
		}
	}
	return weight * sum;
}

static double add_decay(const struct network *net, double decay, real *gradient)
{
	double sum = 0;

	for (int i = 0; i < net->layers; i++)
		for (size_t w = net->layer[i].weight; w < net->layer[i].bias; w++) {
			sum += (double)net->weights[w] * net->weights[w];
			gradient[w] = (real)(gradient[w] + decay * net->weights[w]);
		}
	return decay / 2 * sum;
}

double network_gradient(struct network *net, const real *x, const real *target, int n,
	network_loss *loss, const void *context, const struct network_penalty *penalty,
	real *gradient)
{
	int last = net->layers - 1;
	double value;

	network_forward(net, x, n);
	value = loss(context, n, net->layer[last].outputs, net->layer[last].value, target,
		net->layer[last].slope);
	for (int i = last; i >= 0; i--) {
		struct layer *l = &net->layer[i];
		const real *in = i ? l[-1].value : x;
		real *back = i ? l[-1].slope : NULL;

		if (penalty && penalty->sparse_weight > 0 && penalty->sparse_layer == i)
			value += add_sparsity(
				l, n, penalty->sparse_weight, penalty->sparse_level);
		if (l->par.kind == NETWORK_CONV)
			conv_backward(net, l, in, n, gradient, back);
		else if (l->par.kind == NETWORK_POOL)
			pool_backward(l, n, back);
		else
			dense_backward(net, l, in, n, gradient, back);
	}
	if (penalty && penalty->decay > 0)
		value += add_decay(net, penalty->decay, gradient);
	return value;
}
