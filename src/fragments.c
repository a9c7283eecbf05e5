#include "fragments.h"
#include "pump.h"
#include "shell/msg.h"
#include "shell/stats.h"
#include "shell/tables.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double part_of(
	const char *option, const char **rest, enum unit unit, const char *what)
{
	const char *end, *wrong;
	double value;

	wrong = unit_parse(*rest, unit, ":", &value, &end);
	if (wrong)
		die(EXIT_USAGE, "--wear %s: %s %s", option, what, wrong);
	*rest = *end ? end + 1 : NULL;
	return value;
}

/* Reads one --wear FILE[:PRESSURE[:AREA]] into a class of its own. */
static void read_wear(struct partition *p, const char *option, char **cmd)
{
	const char *colon = strchr(option, ':'), *rest = colon ? colon + 1 : NULL;
	char *file = xstrdup(option);
	double pressure = NAN, share = -1;
	struct table_in *t;
	int class, realisation, step, volume, diameter, sparse;
	enum partition_status status;

	if (rest)
		file[colon - option] = '\0';
	if (rest)
		pressure = part_of(option, &rest, UNIT_PRESSURE, "the pressure");
	if (rest)
		share = part_of(option, &rest, UNIT_AREA, "the area");
	t = table_open(file);
	realisation = table_find(t, "realisation");
	step = table_find(t, "step");
	volume = table_need(t, "volume");
	sparse = table_find(t, "particle") >= 0;
	diameter = isnan(pump.critical_size) ? -1 : table_need(t, "diameter");
	class = partition_class(p, sparse, pressure, share);
	for (long row = 0; table_next(t); row++) {
		double r = realisation < 0 ? (double)row : table_number(t, realisation);
		double k = step < 0 ? 1 : table_number(t, step),
		       v = table_number(t, volume);

		if (!(r >= 0 && r <= 4294967295. && r == floor(r)))
			die(EXIT_RUN, "%s: line %ld: realisation must be a whole number",
				file, table_line(t));
		if (!(k >= 1 && k <= 1e6 && k == floor(k)))
			die(EXIT_RUN,
				"%s: line %ld: step must be a whole number from 1 to 1e6",
				file, table_line(t));
		if (!(v >= 0 && v <= 1e3))
			die(EXIT_RUN,
				"%s: line %ld: volume must lie within 0 and 1000 m3",
				file, table_line(t));
		status = partition_fragment(p, class, (long)r, (long)k, v, 1,
			table_number(t, diameter) >= pump.critical_size);
		if (status == PARTITION_MEMORY)
			die(EXIT_RUN, "out of memory");
		if (status == PARTITION_TWICE)
			die(EXIT_RUN, "%s: line %ld: realisation %g has step %g twice",
				file, table_line(t), r, k);
		stats_add("fragments_read", 1);
	}
	if (table_key(t, "cmd"))
		*cmd = xstrdup(table_key(t, "cmd"));
	table_close(t);
	free(file);
}

struct partition *fragments_read(
	const struct opt_texts *files, long first_step, char **made_by)
{
	struct partition *p = partition_new(pump.fragment_area, pump.pair.area);
	enum partition_status status;

	if (!p)
		die(EXIT_RUN, "out of memory");
	for (int i = 0; i < files->n; i++)
		read_wear(p, files->v[i], &made_by[i]);
	status = partition_close(p, pump.transition, first_step);
	switch (status) {
	case PARTITION_OK:
		break;
	case PARTITION_EMPTY:
		die(EXIT_RUN, "%s: no fragment from step %ld on",
			files->v[partition_culprit(p)], first_step);
	case PARTITION_TWICE:
		die(EXIT_RUN, "%s: a realisation has the same step twice",
			files->v[partition_culprit(p)]);
	case PARTITION_PRESSURE:
		die(EXIT_USAGE,
			"--wear %s: each of several tables needs a pressure of its own",
			files->v[partition_culprit(p)]);
	case PARTITION_AREA:
		die(EXIT_USAGE, "--wear: the areas add up to more than --area %g m2",
			pump.pair.area);
	case PARTITION_MEMORY:
		die(EXIT_RUN, "out of memory");
	}
	return p;
}
