#include "quantile_columns.h"
#include "cli/msg.h"

void levels_check(const struct opt_list *levels)
{
	for (int i = 1; i < levels->n; i++)
		if (!(levels->v[i] > levels->v[i - 1]))
			die(EXIT_USAGE, "--levels: levels must be ascending");
}

char *levels_columns(char *names, const char *prefix, const struct opt_list *levels)
{
	for (int i = 0; i < levels->n; i++)
		names = xappend(names, " %s%s%g", prefix,
			levels->v[i] < 0.0999999 ? "0" : "", 100 * levels->v[i]);
	return names;
}
