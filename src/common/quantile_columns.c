#include "quantile_columns.h"
#include "cli/msg.h"
#include <stdlib.h>

char *levels_columns(
	const char *before, const char *prefix, const struct opt_list *levels)
{
	char *names = xstrdup(before), *more;

	for (int i = 0; i < levels->n; i++, names = more) {
		more = xprintf("%s %s%s%g", names, prefix,
			levels->v[i] < 0.0999999 ? "0" : "", 100 * levels->v[i]);
		free(names);
	}
	return names;
}
