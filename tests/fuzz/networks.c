/* Networks of any bytes are read or refused, and what was read is written so that it
 * reads back the same */
#include "net/netfile.h"
#include "survive.h"
#include <stdlib.h>
#include <string.h>

static void check_same(struct network *a, struct network *b)
{
	size_t n = network_weight_count(a);

	if (!b || network_weight_count(b) != n ||
		memcmp(network_weights(a), network_weights(b),
			n * sizeof *network_weights(a)) != 0)
		abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	FILE *f = fopen(stream_of(data, size), "r");
	struct netfile file, again;
	struct network *net = netfile_read(f, 1, &file), *copy;
	char *text;
	size_t length;

	fclose(f);
	if (!net)
		return 0;
	f = open_memstream(&text, &length);
	netfile_write(f, net, file.purpose, file.cmd);
	fclose(f);
	f = fmemopen(text, length, "r");
	copy = netfile_read(f, 1, &again);
	fclose(f);
	check_same(net, copy);
	network_free(net);
	network_free(copy);
	free(file.cmd);
	free(again.cmd);
	free(text);
	return 0;
}
