/* netfile.h - networks as text: the layers in one line, the weights in one file
 *
 * Layers are words separated by blanks:
 *
 *	50:tanh              dense layer of 50 units
 *	50+:tanh             cascade layer: hands on its input beside its 50 units
 *	10conv30x2/3:relu    convolution: 10 filters, 30 columns by 2 rows, 3 columns on
 *	pool2x2              max pooling, 2 columns by 2 rows
 *
 * '*' serves for 'x', a stride of 1 is left out, and where the activation (linear, tanh,
 * sigmoid, relu) is left out the caller's is taken.
 *
 * A file of weights is text, in this order:
 *
 *	wearpipe-network 1
 *	# cmd: how it was made           any number of comments
 *	purpose delays                   one word: what the outputs mean
 *	input 1 2 500                    channels, rows, columns
 *	layers 10:tanh 3:linear
 *	weights 10043                    their number, then the numbers, separated by
 * blanks,
 *	...                              in the order of network_weights()
 *	end
 *
 * Numbers are written with the nine digits that give back the same single precision.
 */
#ifndef NET_NETFILE_H
#define NET_NETFILE_H

#include "net/network.h"
#include <stdio.h>

enum { NETFILE_TEXT = 160 }; /* room for a message, a purpose or the layers in words */

/* Fills layer[NETWORK_LAYERS_MAX] and returns how many, or 0 with the reason in why. */
int netfile_parse_layers(const char *text, enum network_activation activation,
	struct network_layer *layer, char why[NETFILE_TEXT]);

/* Returns 0, or -1 with errno where writing failed. */
int netfile_write(FILE *f, struct network *net, const char *purpose, const char *cmd);

/* What is in a file beside the network, or why it could not be read. */
struct netfile {
	char purpose[NETFILE_TEXT];
	char *cmd; /* of the last "# cmd: ..." line, malloc()ed; NULL if none */
	char why[NETFILE_TEXT]; /* a phrase */
	long line;              /* line at fault */
};

/* Reads to the end of f.  NULL with file->why and file->line set where that fails; then
 * file->cmd is NULL. */
struct network *netfile_read(FILE *f, int batch, struct netfile *file);

#endif
