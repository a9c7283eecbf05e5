/* training_options.h - how delaynet trains a network: its options */
#ifndef TRAINING_OPTIONS_H
#define TRAINING_OPTIONS_H

#include "cli/opt.h"

/* Values of the options. */
extern struct learning {
	const char *layers;
	int activation, optimiser, fresh;
	double rate, rate_end, decay, sparsity, sparsity_level;
	long epochs, batch, pretrain, repetition;
} learning;

extern struct opt learning_rows[]; /* for OPT_TABLE: --layers to --sparsity-level */

/* Trains a network with the lessons and writes it to standard output. */
void learning_train(void);

#endif
