#include "fleet_table.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "common/time_unit.h"
#include "io/quantities.h"
#include "life/prior/fleet.h"
#include "num/checksum.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct fleet *fleet; /* NULL: none has been read */
static char **names;        /* of its units */
static int n_units;

void fleet_table_read(const char *file, const char *unit_column, const char *clock_column,
	double threshold, int direction, const struct series *like,
	struct reasons *doubts)
{
	struct series *in = series_open(file, unit_column);
	struct table_in *table = series_table(in);
	int clock = clock_column ? table_find(table, clock_column) : -1;
	enum num_status status;
	int failed, carried_on, n;
	char y[UNIT_WORD];

	table_unit_word(series_table(like), series_value_column(like), y);
	series_scale(in, timeunit_ratio(table, series_time_column(in)),
		table_ratio(table, series_value_column(in), y));
	if (clock >= 0)
		table_set_scale(table, clock, timeunit_ratio(table, clock));
	fleet = fleet_new(threshold, direction);
	status = fleet ? NUM_OK : NUM_MEMORY;
	while (status == NUM_OK && series_next(in)) {
		if (series_units(in) > n_units) {
			names = xrealloc(names, (size_t)n_units + 1, sizeof *names);
			names[n_units++] = xstrdup(series_unit_name(in));
		}
		if (!isnan(series_value(in)))
			status = fleet_add(fleet, series_unit(in),
				clock < 0 ? series_time(in) : table_number(table, clock),
				series_value(in));
	}
	if (status == NUM_DOMAIN)
		die(EXIT_RUN, "%s: line %ld: operating time decreases", file,
			table_line(table));
	if (status == NUM_OK)
		status = fleet_build(fleet, &failed, &carried_on);
	if (status != NUM_OK)
		die(EXIT_RUN, "no memory for the fleet");
	fleet_shapes(fleet, &n);
	if (n == 0)
		die(EXIT_RUN, "%s: none of %d units shows any wear to compare with", file,
			series_units(in));
	if (n > BANK_PATHS_MAX)
		die(EXIT_RUN, "%s: want at most %d units that show wear, got %d", file,
			BANK_PATHS_MAX, n);
	reasons_add(doubts, table_doubted(table));
	stats_set("fleet_units", failed);
	stats_set("fleet_units_carried_on", carried_on);
	stats_set("fleet_units_left_out", series_units(in) - n);
	series_close(in);
}

const struct bank_shape *fleet_table_shapes(int *n)
{
	*n = 0;
	return fleet ? fleet_shapes(fleet, n) : NULL;
}

int fleet_table_shape_of(const char *unit)
{
	for (int i = 0; i < n_units; i++)
		if (strcmp(names[i], unit) == 0)
			return fleet_shape_of(fleet, i);
	return 0;
}

uint64_t fleet_table_checksum(void)
{
	uint64_t sum = CHECKSUM_START;
	int n;
	const struct bank_shape *path = fleet_table_shapes(&n);

	for (int i = 0; i < n; i++)
		sum = checksum(
			path[i].path, (size_t)path[i].n * sizeof *path[i].path, sum);
	return sum;
}

void fleet_table_free(void)
{
	fleet_free(fleet);
	for (int i = 0; i < n_units; i++)
		free(names[i]);
	free(names);
}
