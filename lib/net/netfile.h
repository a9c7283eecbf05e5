/* netfile.h - networks as text: the layers in one line, the weights in one file
 *
 * Layers are words separated by blanks:
 *
 *	50:tanh              dense layer of 50 units
 *	50+:tanh             cascade layer: passes its input on beside its 50 units
 *	10conv30x2/3:relu    convolution: 10 filters, 30 columns by 2 rows, 3 columns on
 *	pool2x2              max pooling, 2 columns by 2 rows
 *
 * '*' may replace 'x'; a missing stride is 1; a missing activation (linear, tanh,
 * sigmoid, relu) is that of the caller.
 *
 * A file of weights is text, in this order:
 *
 *	wearpipe-network 2
 *	# cmd: how it was made           any number of comments
 *	purpose delays                   one word: what the outputs mean
 *	input 1 2 500                    channels, rows, columns
 *	layers 10:tanh 3:linear
 *	weights 10043                    number of weights, then these, in the order of
 *	...                              network_weights(), separated by blanks
 *	end crc32 1b2c3d4e               checksum of all bytes before this line
 *
 * Numbers are written with nine digits, so that the same single-precision numbers are
 * read.
 */
#ifndef NET_NETFILE_H
#define NET_NETFILE_H

#include "net/network.h"
#include "num/status.h"
#include <stdio.h>

enum { NETFILE_TEXT = 160 }; /* room for a message, a purpose or the layers in words */

/* Fills layer[NETWORK_LAYERS_MAX] and their number *count; NUM_DOMAIN with the reason in
 * why. */
enum num_status netfile_parse_layers(const char *text, enum network_activation activation,
	struct network_layer *layer, int *count, char why[NETFILE_TEXT]);

/* The caller checks ferror(f); NUM_MEMORY: nothing was written. */
enum num_status netfile_write(
	FILE *f, struct network *net, const char *purpose, const char *cmd);

/* Contents of a file besides the network, or why it could not be read. */
struct netfile {
	char purpose[NETFILE_TEXT];
	char *cmd; /* of the last line "# cmd: ...", malloc()ed; NULL if none */
	char why[NETFILE_TEXT]; /* a phrase */
	long line;              /* line at fault */
};

/* Reads to the end of f.  On failure returns NULL and sets file->why and file->line;
 * file->cmd is NULL then. */
struct network *netfile_read(FILE *f, int batch, struct netfile *file);

#endif
