#include "scratches.h"
#include "abrasion/groove.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "common/moments.h"
#include "io/fields.h"
#include "num/philox.h"
#include "num/room.h"
#include <math.h>
#include <stdlib.h>

const char scratched_again[] = "the grooves of some particles are cut more than once";

struct scratch {
	struct moment from;
	double diameter, depth, share;
	int cut;
};

static struct scratch *list;
static size_t n, room;
static struct moments seen;

void scratches_add(
	long realisation, long step, double diameter, double depth, double share)
{
	if (room_for(&list, &room, n + 1, sizeof *list))
		die(EXIT_RUN, "out of memory");
	list[n++] = (struct scratch){ { realisation, (double)step }, diameter, depth,
		share, 0 };
}

/* A surface keeps the grooves of earlier steps. */
static struct moment moment_of(const struct record *r, int stepped)
{
	double step = stepped ? record_get_number(r, "step") : NAN;

	return (struct moment){ r->realisation, isnan(step) ? INFINITY : step };
}

size_t scratches_cut(const char *path, double length, double cut, uint64_t seed,
	int apart, int stepped, const char *cmd, const char *why, size_t *again,
	char **own)
{
	size_t left = 0;
	struct fields_in *in = fields_open(path, NULL);
	struct fields_out *out = NULL;
	struct record r = { 0 };
	const char *doubted;
	double laps = 0; /* the most */

	*again = 0;
	while (fields_read(in, &r)) {
		double *z = record_need(&r, "height", 1, in), lx = r.nx * r.dx,
		       ly = r.ny * r.dy;
		struct moment now = moment_of(&r, stepped);

		if (r.nz != 1)
			die(EXIT_RUN, "%s: record %ld: %d layers, want a plane field",
				fields_name(in), fields_count(in), r.nz);
		if (moments_again(&seen, now)) {
			++*again;
			record_doubt(&r, scratched_again);
		}
		if (why)
			record_doubt(&r, why);
		for (size_t i = 0; i < n; i++) {
			struct groove g = { .length = list[i].share * length,
				.diameter = list[i].diameter,
				.depth = list[i].depth,
				.cut = cut };

			if ((apart && list[i].from.realisation != now.realisation) ||
				list[i].from.step > now.step)
				continue;
			g.x = lx * philox_uniform(seed, (uint32_t)r.realisation,
					   RNG_ABRASION, (1ull << 40) + 2 * i);
			g.y = ly * philox_uniform(seed, (uint32_t)r.realisation,
					   RNG_ABRASION, (1ull << 40) + 2 * i + 1);
			stats_add("heights_changed",
				groove_cut(r.nx, r.ny, r.dx, r.dy, z, &g));
			stats_add("grooves_cut", 1);
			list[i].cut = 1;
			laps = fmax(laps, g.length / lx);
		}
		for (int k = r.nfields - 1; k >= 0; k--)
			if (z != r.data[k])
				record_drop(&r, r.name[k]);
		free(r.cmd);
		r.cmd = xstrdup(cmd);
		if (!out)
			out = fields_create(NULL);
		fields_write(out, &r, fields_more(in));
		stats_add("records", 1);
	}
	record_free(&r);
	if (out)
		fields_done(out);
	for (size_t i = 0; i < n; i++)
		left += !list[i].cut;
	if (laps > 1)
		warn("%s: grooves pass over the surface up to %.3g times in the same track: "
		     "--slide is longer than its side",
			fields_name(in), laps);
	doubted = fields_doubted(in);
	*own = doubted ? xstrdup(doubted) : NULL;
	fields_close(in);
	free(list);
	free(seen.of);
	return left;
}
