#include "tables.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "cli/text.h"
#include "contact/patches.h"
#include "io/tables.h"
#include <math.h>
#include <stdlib.h>

static const char *table_path, *patches_path;
static struct table_out *table, *patches;

struct opt table_opts[] = {
	{ 0, "table", OPT_TEXT, UNIT_NONE, &table_path, 0, 0, "FILE",
		"write load, approach, area, stiffness, pressures: one row per contact",
		0, 1 },
	{ 0, "patches", OPT_TEXT, UNIT_NONE, &patches_path, 0, 0, "FILE",
		"write the patches of each contact: one row per patch", 0, 1 },
	OPT_END,
};

int table_wanted(void)
{
	return table_path != NULL;
}

/* The pipeline that prints such a table on standard output. */
static char *cmd_of(const char *upstream, const char *option)
{
	char *turn = xprintf("%s /dev/fd/3 3>&1 >/dev/null", option);
	char *cmd = opt_cmd(upstream, turn);

	free(turn);
	return cmd;
}

static struct table_out *open_table(const char *path, const char *upstream,
	const char *option, const char *units, const char *columns)
{
	char *cmd = cmd_of(upstream, option);
	struct table_out *t = path ? table_create(path, cmd, units, columns) : NULL;

	free(cmd);
	return t;
}

void tables_open(const char *upstream)
{
	table = open_table(table_path, upstream, "--table",
		"1 N Pa m m 1 1 N/m 1 m Pa Pa Pa Pa Pa 1 J 1 1 1 1",
		"realisation load mean_pressure approach indentation area corrected_area "
		"stiffness patches perimeter contact_pressure p10 p50 p90 peak plastic_area "
		"energy optimality_gap iterations converged edge_load");
	patches = open_table(patches_path, upstream, "--patches", "1 1 m2 m2 m N Pa m m",
		"realisation cells area corrected_area perimeter load peak x y");
}

static void follow_cmd(struct table_out *t, const struct record *r, const char *option)
{
	char *cmd = cmd_of(r->cmd, option);

	table_cmd(t, cmd);
	free(cmd);
}

static void put_patches(const struct record *r, const struct patch_grid *grid,
	const struct contact_patch *list, size_t n)
{
	follow_cmd(patches, r, "--patches");
	for (size_t i = 0; i < n; i++) {
		const struct contact_patch *a = &list[i];
		double row[] = { (double)r->realisation, a->cells, a->area,
			contact_corrected_area(grid, a->area, a->perimeter), a->perimeter,
			a->load, a->peak, a->x, a->y };

		table_put_row(patches, row, sizeof(row) / sizeof *row);
	}
	stats_add("patches", (double)n);
}

static void put_contact(const struct record *r, const struct patch_grid *grid,
	const struct contact_result *found, const double *quantile, double stiffness,
	double perimeter, size_t n, int converged, double edge_load)
{
	double whole = grid->nx * grid->dx * grid->ny * grid->dy;
	double corrected =
		contact_corrected_area(grid, found->area * whole, perimeter) / whole;
	double row[] = { (double)r->realisation, found->load, found->pressure,
		found->approach, found->indentation, found->area, corrected, stiffness,
		(double)n, perimeter,
		found->area > 0 ? found->pressure / found->area : NAN, quantile[0],
		quantile[1], quantile[2], quantile[3], found->plastic, found->energy,
		found->optimality_gap, (double)found->iterations, converged, edge_load };

	follow_cmd(table, r, "--table");
	table_put_row(table, row, sizeof(row) / sizeof *row);
}

void tables_put(const struct record *r, const struct contact_par *par,
	const struct contact_result *found, const double *pressure, double stiffness,
	int converged, int last)
{
	static const double part[4] = { 0.1, 0.5, 0.9, 1 };
	struct patch_grid grid = { par->nx, par->ny, par->dx, par->dy,
		par->boundary == CONTACT_PERIODIC };
	struct contact_patch *list;
	double quantile[4], perimeter = 0;
	size_t n;

	if (!table && !(patches && last))
		return;
	if (contact_patches(&grid, pressure, &list, &n) != NUM_OK)
		die(EXIT_RUN, "out of memory");
	for (size_t i = 0; i < n; i++)
		perimeter += list[i].perimeter;
	if (patches && last)
		put_patches(r, &grid, list, n);
	free(list);
	if (!table)
		return;
	if (contact_quantiles(
		    pressure, (size_t)par->nx * (size_t)par->ny, part, quantile, 4) != 0)
		die(EXIT_RUN, "the pressures of a contact:");
	put_contact(r, &grid, found, quantile, stiffness, perimeter, n, converged,
		contact_edge_load(&grid, pressure));
}

void tables_doubt(const char *why)
{
	if (table)
		table_comment(table, "doubtful", "%s", why);
	if (patches)
		table_comment(patches, "doubtful", "%s", why);
}

void tables_done(void)
{
	if (table)
		table_done(table);
	if (patches)
		table_done(patches);
}
