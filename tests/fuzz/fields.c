/* Field streams of any bytes are read or refused, and what was read can be written */
#include "io/fields.h"
#include "survive.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct record r = { 0 };
	struct fields_in *in;
	struct fields_out *out;

	if (setjmp(refused))
		return 0;
	in = fields_open(stream_of(data, size), NULL);
	out = fields_create("/dev/null");
	while (fields_read(in, &r))
		fields_write(out, &r, fields_more(in));
	record_free(&r);
	fields_done(out);
	fields_close(in);
	return 0;
}
