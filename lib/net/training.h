/* training.h - networks trained by gradient descent or Adam
 *
 * Samples are drawn in an order that depends on seed and repetition alone.
 * Kingma, Ba, Adam: a method for stochastic optimization, ICLR 2015.
 *
 *	network_start(net, seed, 0);
 *	network_train(net, &(struct network_training){ .epochs = 100, .samples = 1000,
 *		.batch = 64, .rate = 1e-3, .loss = network_mse }, sample, context);
 */
#ifndef NET_TRAINING_H
#define NET_TRAINING_H

#include "net/network.h"

enum network_optimiser { NETWORK_ADAM, NETWORK_DESCENT };

struct network_training {
	enum network_optimiser optimiser;
	double rate;     /* step length */
	double rate_end; /* at the end, reached along a half cosine; 0: rate throughout */
	long epochs;
	long samples;  /* per epoch */
	int batch;     /* samples per step */
	int fresh;     /* each epoch takes new samples instead of the same, shuffled */
	uint64_t seed; /* of the shuffling, with repetition */
	uint32_t repetition;
	int targets; /* values per target; 0: as many as outputs */
	network_loss *loss;
	const void *loss_context;
	struct network_penalty penalty;
	/* Called after each epoch with its mean loss, unless NULL. */
	void (*report)(void *context, long epoch, double loss);
};

enum network_status {
	NETWORK_OK,
	NETWORK_MEMORY,
	NETWORK_DIVERGED /* loss or weights no longer finite */
};

/* Fills sample i (i < samples, or counted on through all epochs if fresh). */
typedef void network_sample(void *context, long i, network_real *x, network_real *target);

enum network_status network_train(struct network *net, const struct network_training *par,
	network_sample *sample, void *context);

/* Trains layer i (dense, sigmoid) as the encoder of an auto-encoder on what the layers
 * before it give for the samples, with a linear decoder that is then thrown away.
 * The loss is the mean squared error of the reconstruction; par->loss is not used,
 * and par->penalty.sparse_layer is taken as the encoder.  Hinton, Salakhutdinov,
 * Science 313 (2006) 504. */
enum network_status network_pretrain(struct network *net, int i,
	const struct network_training *par, network_sample *sample, void *context);

#endif
