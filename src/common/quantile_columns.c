#include "quantile_columns.h"
#include "cli/msg.h"

char *levels_columns(
	const char *before, const char *prefix, const struct opt_list *levels)
{
	char *names = xstrdup(before);

	for (int i = 0; i < levels->n; i++)
		names = xappend(names, " %s%s%g", prefix,
			levels->v[i] < 0.0999999 ? "0" : "", 100 * levels->v[i]);
	return names;
}
