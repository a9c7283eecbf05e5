/* Tables of any bytes are read or refused */
#include "io/tables.h"
#include "survive.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct table_in *in;

	if (setjmp(refused))
		return 0;
	in = table_open(stream_of(data, size));
	while (table_next(in))
		for (int i = 0; i < table_columns(in); i++)
			(void)table_number(in, i);
	table_close(in);
	return 0;
}
