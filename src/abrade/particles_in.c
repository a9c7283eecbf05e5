#include "particles_in.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "common/verdicts.h"
#include "count/codes.h"
#include "io/quantities.h"
#include "io/tables.h"
#include "num/room.h"
#include <math.h>
#include <stdlib.h>

/* Particles drawn at most, as many rows as in common/periods.h. */
enum { DRAWN_MOST = 10000000 };

static struct opt_list iso;
static double largest = NAN;
static long count = 1;

struct opt particles_rows[] = {
	OPT_HEADING("Particles"),
	{ 0, "iso", OPT_LIST, UNIT_COUNT, &iso, 0, ISO4406_CODES - 1, "C:C:C",
		"draw the particles of an oil of this ISO 4406 code, 18:16:13", NULL, 0 },
	{ 0, "largest", OPT_NUM, UNIT_LENGTH, &largest, 1e-9, DIAMETER_MOST, "D",
		"of --iso: largest particle", NULL, 0 },
	{ 'c', "count", OPT_INT, UNIT_COUNT, &count, 1, 1000000000, "N",
		"of --iso: number of realisations", NULL, 0 },
	OPT_END,
};

struct row {
	long realisation, step, part;
	size_t number;
	double diameter, aspect;
};

struct source {
	struct row *row;
	size_t rows, room, at;
	int apart, shaped, stepped;
	char *upstream, *doubt;
	double *diameter, *aspect; /* of the present gap */
	/* drawn */
	const struct population *population;
	double volume, gap;
	uint64_t seed;
	long realisation;
};

void particles_check(int operands, double area, double inlet)
{
	if (!iso.n) {
		if (!isnan(largest) || count > 1)
			die(EXIT_USAGE, "--largest and --count are for --iso");
		return;
	}
	if (operands)
		die(EXIT_USAGE, "specify either --iso or a table of particles, not both");
	if (isnan(area))
		die(EXIT_USAGE, "--iso requires --area: particles are drawn for its gap");
	if (isnan(largest) && isnan(inlet))
		die(EXIT_USAGE,
			"--iso requires --largest or --inlet: the code does not limit the size of particles");
	for (int k = 0; k + 1 < ISO4406_SIZES; k++)
		if (iso.v[k] < iso.v[k + 1])
			die(EXIT_USAGE,
				"--iso %.0f:%.0f:%.0f: counts must not increase with size",
				iso.v[0], iso.v[1], iso.v[2]);
	/* Beyond 14 um the numbers go on to fall as from 6 to 14 um. */
	if (iso.v[1] == iso.v[2])
		die(EXIT_USAGE,
			"--iso %.0f:%.0f:%.0f: as many particles from 14 um on as from 6 um on "
			"do not tell their sizes: want a lower third number",
			iso.v[0], iso.v[1], iso.v[2]);
}

const struct population *particles_population(double inlet_limit)
{
	static struct population p;

	if (!iso.n)
		return NULL;
	for (int k = 0; k < ISO4406_SIZES; k++) {
		p.diameter[k] = iso4406_size[k];
		p.number[k] = iso4406_limit((int)iso.v[k]);
	}
	p.largest = isnan(largest) ? inlet_limit : largest;
	if (p.largest <= p.diameter[0])
		die(EXIT_USAGE, "no particle of the code is smaller than %g m",
			p.largest);
	return &p;
}

static int in_order(const void *a, const void *b)
{
	const struct row *x = a, *y = b;

	if (x->realisation != y->realisation)
		return x->realisation < y->realisation ? -1 : 1;
	if (x->step != y->step)
		return x->step < y->step ? -1 : 1;
	return x->number < y->number ? -1 : x->number > y->number;
}

/* Two ensembles of the same numbers are no ensemble: their particles would share a gap.
 */
static void check_parts(const struct source *s, const char *name)
{
	for (size_t i = 1; i < s->rows; i++)
		if (s->row[i].realisation == s->row[i - 1].realisation &&
			s->row[i].part != s->row[i - 1].part)
			die(EXIT_RUN,
				"%s: realisation %ld stands in two parts of the table; "
				"the numbers of joined ensembles must differ",
				name, s->row[i].realisation);
}

struct source *particles_read(const char *path)
{
	struct source *s = xcalloc(1, sizeof *s);
	struct table_in *t = table_open(path);
	const char *why;
	int more = table_next(t), shaped = 1, cd, ca, cr, cs, cv;

	cd = table_need_quantity(t, "diameter", UNIT_LENGTH);
	ca = table_find(t, "aspect");
	cr = table_find(t, "realisation");
	cs = table_find(t, "step");
	cv = verdict_column(t);
	for (; more; more = table_next(t)) {
		struct row r = { .number = s->rows, .aspect = 1 };

		if (verdict_of(t, cv) != VERDICT_SURE)
			continue;
		if (room_for(&s->row, &s->room, s->rows + 1, sizeof *s->row))
			die(EXIT_RUN, "out of memory");
		r.diameter = table_diameter(t, cd);
		/* A surrogate gives none, and particles without end have none. */
		if (ca >= 0 && !isnan(table_number(t, ca)))
			r.aspect = table_positive(t, ca);
		else
			shaped = 0;
		if (r.aspect < 1)
			die(EXIT_RUN, "%s: line %ld: aspect is %g, want 1 or more",
				table_name(t), table_line(t), r.aspect);
		if (cr >= 0)
			r.realisation = table_whole(t, cr, 0, 1e15);
		if (cs >= 0)
			r.step = table_whole(t, cs, 0, 1e15);
		r.part = table_part(t);
		s->row[s->rows++] = r;
	}
	s->apart = cr >= 0;
	s->shaped = shaped;
	s->stepped = cs >= 0;
	if (table_upstream(t))
		s->upstream = xstrdup(table_upstream(t));
	qsort(s->row, s->rows, sizeof *s->row, in_order);
	if (cr >= 0)
		check_parts(s, table_name(t));
	why = table_doubted(t);
	if (why)
		s->doubt = xstrdup(why);
	table_close(t);
	s->diameter = xcalloc(s->rows + 1, sizeof *s->diameter);
	s->aspect = xcalloc(s->rows + 1, sizeof *s->aspect);
	return s;
}

struct source *particles_drawn(
	const struct population *p, double area, double gap, uint64_t seed)
{
	struct source *s = xcalloc(1, sizeof *s);

	s->population = p;
	s->volume = area * gap;
	s->gap = gap;
	s->seed = seed;
	s->apart = 1;
	return s;
}

static int draw(struct source *s, struct particles_in *in)
{
	double all = s->volume * population_larger(s->population, iso4406_size[0]);

	if (s->realisation == count)
		return 0;
	free(s->diameter);
	if (population_draw(s->population, s->volume, s->gap, s->seed,
		    (uint32_t)s->realisation, DRAWN_MOST, &s->diameter, &in->n))
		die(EXIT_RUN,
			"out of memory, or more than %d particles in the gap: use a smaller --area",
			DRAWN_MOST);
	stats_add("particles_left_out", floor(fmax(all - (double)in->n, 0)));
	in->diameter = s->diameter;
	in->aspect = NULL;
	in->realisation = s->realisation++;
	return 1;
}

int particles_next(struct source *s, struct particles_in *in)
{
	const struct row *first;

	if (s->population)
		return draw(s, in);
	if (s->at == s->rows)
		return 0;
	first = &s->row[s->at];
	*in = (struct particles_in){ first->realisation, first->step, s->diameter,
		s->aspect, 0 };
	for (; s->at < s->rows && s->row[s->at].realisation == in->realisation &&
		s->row[s->at].step == in->step;
		s->at++, in->n++) {
		s->diameter[in->n] = s->row[s->at].diameter;
		s->aspect[in->n] = s->row[s->at].aspect;
	}
	return 1;
}

int particles_apart(const struct source *s)
{
	return s->apart;
}

int particles_shaped(const struct source *s)
{
	return s->shaped;
}

int particles_stepped(const struct source *s)
{
	return s->stepped;
}

const char *particles_doubted(const struct source *s)
{
	return s->doubt;
}

const char *particles_upstream(const struct source *s)
{
	return s->upstream;
}

void particles_close(struct source *s)
{
	free(s->row);
	free(s->upstream);
	free(s->doubt);
	free(s->diameter);
	free(s->aspect);
	free(s);
}
