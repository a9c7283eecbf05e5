/* network.h - small feed-forward networks and their derivatives by back-propagation
 *
 * A network is a chain of layers: dense, cascade (a dense layer that passes on its
 * input beside its output, so that a chain of them followed by a dense layer is the
 * cascade-forward network), two-dimensional convolution with zero padding to the same
 * size, and max pooling.  Matrix products go through CBLAS; everything else is here.
 * Rumelhart, Hinton, Williams, Nature 323 (1986) 533.
 *
 * A sample is laid out x[channel][row][column]; samples follow one another.  Arithmetic
 * is in single precision, losses are summed in double.  Results depend on the arguments
 * and on the CBLAS library alone.
 *
 *	struct network_layer layer[] = {
 *		{ NETWORK_DENSE, NETWORK_TANH, .units = 10 },
 *		{ NETWORK_DENSE, NETWORK_LINEAR, .units = 3 } };
 *	struct network *net = network_new(
 *		(struct network_shape){ 1, 2, 500 }, layer, 2, 64);
 *	network_start(net, seed, 0);
 *	... training.h ...
 *	const network_real *y = network_forward(net, x, 1);
 *	network_free(net);
 */
#ifndef NET_NETWORK_H
#define NET_NETWORK_H

#include <stddef.h>
#include <stdint.h>

/* Single precision, except for the test of the derivatives. */
#ifdef NETWORK_DOUBLE
typedef double network_real;
#else
typedef float network_real;
#endif

struct network; /* layers, weights and scratch */

enum network_kind { NETWORK_DENSE, NETWORK_CASCADE, NETWORK_CONV, NETWORK_POOL };
enum network_activation { NETWORK_LINEAR, NETWORK_TANH, NETWORK_SIGMOID, NETWORK_RELU };

struct network_layer {
	enum network_kind kind;
	enum network_activation activation; /* not of pools */
	int units; /* outputs of dense and cascade layers, filters of convolutions */
	int width, height; /* columns and rows of the kernel or of the pooling window */
	int stride;        /* columns a convolution moves on; 0 means 1 */
};

struct network_shape {
	int channels, height, width;
};

enum {
	NETWORK_LAYERS_MAX = 16,
	NETWORK_WEIGHTS_MAX = 1 << 24,
	NETWORK_UNFOLDED_MAX = 1 << 28 /* inputs of all windows of a convolution */
};

/* batch: most samples to be handled at a time.  NULL when a size is out of range, the
 * network is larger than NETWORK_*_MAX (errno EDOM) or memory is short. */
struct network *network_new(struct network_shape input, const struct network_layer *layer,
	int layers, int batch);
void network_free(struct network *net);

struct network_shape network_input(const struct network *net);
int network_inputs(const struct network *net); /* values per sample */
int network_outputs(const struct network *net);
int network_layers(const struct network *net);
int network_batch(const struct network *net); /* as given to network_new() */
const struct network_layer *network_layer(const struct network *net, int i);
struct network_shape network_layer_output(const struct network *net, int i);

/* All weights as one vector, layer after layer: of a dense or cascade layer
 * weight[input][output] then bias[output]; of a convolution
 * weight[filter][channel][row][column] then bias[filter]. */
network_real *network_weights(struct network *net);
size_t network_weight_count(const struct network *net);
/* Those of layer i, and how many. */
network_real *network_layer_weights(struct network *net, int i, size_t *count);

/* Draws weights uniformly, +-sqrt(6 / (inputs + outputs)) (Glorot, Bengio 2010), for
 * ReLU +-sqrt(6 / inputs) (He et al. 2015); biases 0.  Stream (seed, repetition,
 * RNG_NETWORK). */
void network_start(struct network *net, uint64_t seed, uint32_t repetition);

/* Outputs of n <= batch samples, n rows of network_outputs(); valid until the next call.
 */
const network_real *network_forward(struct network *net, const network_real *x, int n);
/* Output of layer i in the last forward call. */
const network_real *network_activations(const struct network *net, int i);

/* A loss: returns the mean over n samples of width outputs and fills its gradient.  The
 * targets of a sample are as many as the outputs, or what the loss states. */
typedef double network_loss(const void *context, int n, int width,
	const network_real *output, const network_real *target, network_real *gradient);

/* Mean over samples and outputs of the squared difference. */
network_loss network_mse;

/* Terms added to the loss: decay / 2 |weights|^2 (not biases), and for the layer
 * sparse_layer (sigmoid) sparse_weight * sum over its units of the Kullback-Leibler
 * distance of its mean activation in the batch from sparse_level (Ng, Sparse
 * autoencoder, 2011). */
struct network_penalty {
	double decay;
	int sparse_layer;
	double sparse_weight, sparse_level;
};

/* Loss of n <= batch samples, and its gradient by weight (network_weight_count). */
double network_gradient(struct network *net, const network_real *x,
	const network_real *target, int n, network_loss *loss, const void *context,
	const struct network_penalty *penalty, network_real *gradient);

#endif
