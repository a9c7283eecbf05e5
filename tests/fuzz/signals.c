/* Signals of any bytes are read or refused */
#include "io/signals.h"
#include "survive.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	enum { FRAMES = 64, CHANNELS = 64 };
	double x[FRAMES * CHANNELS];
	struct signal_in *in;
	struct signal_out *out;
	size_t n;

	if (setjmp(refused))
		return 0;
	in = signal_open(stream_of(data, size), NULL);
	out = signal_create("/dev/null", signal_format(in));
	while ((n = signal_read(in, x, FRAMES)) > 0)
		signal_write(out, x, n);
	signal_done(out);
	signal_close(in);
	return 0;
}
