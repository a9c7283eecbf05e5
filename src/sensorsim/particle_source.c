#include "particle_source.h"
#include "cli/msg.h"
#include "common/materials.h"
#include "common/verdicts.h"
#include "io/quantities.h"
#include "io/tables.h"
#include "material_options.h"
#include "sensor_options.h"
#include "signal/simulate/wander.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Maximum drift of the flow in standard deviations. */
enum { DRIFT_MOST = 3 };

double source_duration = NAN;

static long number = -1, burst;
static double concentration = NAN, density = 3e3, start = NAN;
static double span = NAN, gap, period = NAN, flow_drift;
static int by_volume;
static struct opt_list uniform;
static const char *const measures[] = { "diameter", "volume", NULL };

struct opt source_rows[] = {
	OPT_HEADING("Particles"),
	{ 0, "uniform", OPT_LIST, UNIT_LENGTH, &uniform, 1e-9, 1, "A:B",
		"draw particles with diameters from A to B instead of reading a table", 0,
		0 },
	{ 0, "by", OPT_WORD, UNIT_NONE, &by_volume, 0, 0, "diameter|volume",
		"quantity that is uniform with --uniform", measures, 0 },
	{ 0, "number", OPT_INT, UNIT_COUNT, &number, 0, 1e15, "N", "particles to draw", 0,
		0 },
	{ 0, "concentration", OPT_NUM, UNIT_CONCENTRATION, &concentration, 0, 1e4, "C",
		"draw a Poisson number of particles; mass concentration C in the oil", 0,
		0 },
	{ 0, "density", OPT_NUM, UNIT_DENSITY, &density, 1, 1e5, "RHO",
		"density of the particles", 0, 0 },
	OPT_TABLE(verdict_rows),
	/* arrivals */
	OPT_HEADING("Arrivals"),
	{ 0, "duration", OPT_NUM, UNIT_TIME, &source_duration, 0, 1e9, "T",
		"length of the record", 0, 0 },
	{ 0, "start", OPT_NUM, UNIT_TIME, &start, -1e9, 1e9, "T",
		"time at which particles begin to arrive", 0, 0 },
	{ 0, "span", OPT_NUM, UNIT_TIME, &span, 0, 1e9, "T",
		"time within which the particles of a burst arrive", 0, 0 },
	{ 0, "gap", OPT_NUM, UNIT_TIME, &gap, 0, 1e9, "T",
		"smallest time between arrivals", 0, 0 },
	{ 0, "burst", OPT_INT, UNIT_COUNT, &burst, 1, 1e9, "M",
		"number of particles per burst", 0, 0 },
	{ 0, "flow-drift", OPT_NUM, UNIT_FRACTION, &flow_drift, 0, 0.3, "S",
		"rms relative variation of all velocities", 0, 0 },
	{ 0, "period", OPT_NUM, UNIT_TIME, &period, 0, 1e9, "T",
		"time from the start of a burst to the next", 0, 0 },
	OPT_END,
};

/* The source of particles: a table, or random numbers. */
struct source {
	struct stream stream;
	struct arrivals *arrivals; /* NULL: the table has times */
	struct table_in *table;    /* NULL: particles are drawn */
	int time_column, diameter_column, velocity_column, material_column;
	int verdict_column;
	double *diameters; /* of a table without times */
	const struct material **materials;
	const struct material *material; /* of the particle returned last */
	struct normals *normals;         /* of the drift of the flow */
	struct wander drift;
	uint64_t count;   /* particles read or drawn */
	uint64_t outside; /* of them, not in the record */
	char *cmd;        /* pipeline that made the table; NULL: none */
	double slowest;
};

void source_check(int operands)
{
	double bore = sensors_pipe().bore;

	if (uniform.n && uniform.v[0] > uniform.v[1])
		die(EXIT_USAGE, "--uniform: want A:B with A not above B");
	if (uniform.n && uniform.v[1] >= bore)
		die(EXIT_USAGE,
			"--uniform: a particle of %g m does not fit a bore of %g m",
			uniform.v[1], bore);
	if (uniform.n && operands)
		die(EXIT_USAGE, "--uniform draws the particles: omit the file");
	if (uniform.n && (number >= 0) + !isnan(concentration) != 1)
		die(EXIT_USAGE, "--uniform requires one of --number and --concentration");
	if (uniform.n && opt_given("doubtful"))
		die(EXIT_USAGE,
			"--doubtful is for a table of particles, not for --uniform");
	if (!uniform.n && (number >= 0 || !isnan(concentration)))
		die(EXIT_USAGE, "--number and --concentration require --uniform");
	if (burst > 0 && (isnan(span) || isnan(period)))
		die(EXIT_USAGE, "--burst requires --span and --period");
	if (burst > 0 && !isnan(concentration))
		die(EXIT_USAGE, "--burst and --concentration exclude one another");
	if (burst > 0 && period < span + gap)
		die(EXIT_USAGE, "--period %g s is shorter than --span and --gap", period);
}

/* Particles per second: flow times concentration over mean mass. */
static double particle_rate(double flow)
{
	double a = uniform.v[0], b = uniform.v[1];
	double cube =
		by_volume ? (a * a * a + b * b * b) / 2 : (a + b) * (a * a + b * b) / 4;

	return isnan(concentration) ? 0
				    : flow * concentration / (density * M_PI / 6 * cube);
}

/* Arrival times and number: the window leaves room for complete pulses at both sensors.
 */
static void make_arrivals(struct source *s, uint64_t n)
{
	double mean = pipe_mean_velocity(&s->stream.pipe),
	       half = sensors_half_pulse(mean);
	double room = half + s->stream.spacing / mean + s->stream.lag[1];
	double begin = isnan(start) ? half : start;
	double window = isnan(span) ? source_duration - begin - room : span;
	struct arrivals_par par = { s->stream.seed, s->stream.realisation,
		particle_rate(s->stream.pipe.flow), n, (uint64_t)burst, begin,
		burst ? period : 0, window, gap };
	double most = burst ? (double)burst : (double)n;

	if (isnan(window))
		die(EXIT_USAGE, "particles without times require --duration or --span");
	if (window < 0 || (par.rate == 0 && most * gap > window + gap * (1 + 1e-9)))
		die(EXIT_USAGE, "%s leaves no room for the particles",
			isnan(span) ? "--duration" : "--span");
	if (par.rate * gap > 1)
		die(EXIT_USAGE,
			"--gap %g s is above the mean time between particles, %g s", gap,
			1 / par.rate);
	s->arrivals = arrivals_new(&par);
	if (!s->arrivals)
		die(EXIT_RUN, "no memory");
}

static double read_diameter(const struct source *s)
{
	double d = table_number(s->table, s->diameter_column), bore = s->stream.pipe.bore;

	if (!(d > 0 && d < bore))
		die(EXIT_RUN,
			"%s: line %ld: diameter %g m, want above 0 and below the bore, "
			"%g m",
			table_name(s->table), table_line(s->table), d, bore);
	return d;
}

/* The next row that is a particle. */
static int next_line(struct source *s)
{
	while (table_next(s->table))
		if (verdict_of(s->table, s->verdict_column) == VERDICT_SURE)
			return 1;
	return 0;
}

/* From its column, or drawn for particle i. */
static const struct material *read_material(const struct source *s, uint64_t i)
{
	const struct material *m;

	if (s->material_column < 0)
		return material_draw(s->stream.seed, s->stream.realisation, i);
	m = material_find(table_text(s->table, s->material_column));
	if (!m)
		die(EXIT_RUN, "%s: line %ld: material '%s', want one of %s",
			table_name(s->table), table_line(s->table),
			table_text(s->table, s->material_column), material_names());
	return m;
}

/* A table without times is read completely; its particles arrive in the order of the
 * rows. */
static void read_diameters(struct source *s)
{
	uint64_t n = 0, room = 0;

	while (next_line(s)) {
		if (n == room) {
			room = room ? 2 * room : 1024;
			s->diameters = xrealloc(s->diameters, room, sizeof *s->diameters);
			s->materials = xrealloc(s->materials, room, sizeof *s->materials);
		}
		s->materials[n] = read_material(s, n);
		s->diameters[n++] = read_diameter(s);
	}
	if (table_upstream(s->table))
		s->cmd = xstrdup(table_upstream(s->table));
	make_arrivals(s, n);
}

struct source *source_open(const char *path, uint64_t seed, uint32_t realisation)
{
	struct source *s = xcalloc(1, sizeof *s);

	s->stream = sensors_stream(seed, realisation);
	s->stream.diameter[0] = uniform.v[0];
	s->stream.diameter[1] = uniform.v[1];
	s->stream.by_volume = by_volume;
	s->slowest = passage_slowest(&s->stream) * (1 - DRIFT_MOST * flow_drift);
	if (s->slowest < 0.01 * pipe_mean_velocity(&s->stream.pipe))
		die(EXIT_USAGE, "--lag makes particles slower than 1 %% of the oil");
	s->normals = normals_new(seed, realisation, RNG_MATERIAL);
	if (!s->normals)
		die(EXIT_RUN, "no memory");
	wander_start(&s->drift, s->normals, (uint64_t)1 << 47, sensors_drift_time());
	if (uniform.n) {
		/* A rate of 0 stands for a given number, also where the oil is clean. */
		make_arrivals(s, number >= 0 ? (uint64_t)number
				 : particle_rate(s->stream.pipe.flow) > 0 ? UINT64_MAX
									  : 0);
		return s;
	}
	s->table = table_open(path);
	s->diameter_column = table_need_quantity(s->table, "diameter", UNIT_LENGTH);
	s->velocity_column = table_find_quantity(s->table, "velocity", UNIT_SPEED);
	s->material_column = table_find(s->table, "material");
	s->verdict_column = verdict_column_alone(s->table);
	s->time_column = table_find_quantity(s->table, "time", UNIT_TIME);
	if (s->time_column < 0)
		s->time_column = table_find_quantity(s->table, "time1", UNIT_TIME);
	if (s->velocity_column >= 0)
		s->slowest = 0.01 * pipe_mean_velocity(&s->stream.pipe);
	if (s->time_column < 0)
		read_diameters(s);
	else if (table_key(s->table, "cmd"))
		s->cmd = xstrdup(table_key(s->table, "cmd"));
	return s;
}

/* The drift is limited where it would stop the flow. */
static void drift_flow(struct source *s, struct passage *p)
{
	double z;

	if (flow_drift <= 0)
		return;
	wander_move(&s->drift, fmax(p->time[0], 0));
	z = fmax(-DRIFT_MOST, fmin(DRIFT_MOST, wander_value(&s->drift, 0)));
	p->velocity *= 1 + flow_drift * z;
	p->time[1] = p->time[0] + s->stream.spacing / p->velocity;
}

static int next_row(struct source *s, struct passage *p)
{
	struct table_in *t = s->table;
	double before = p->time[0];

	if (!next_line(s))
		return 0;
	s->material = read_material(s, s->count);
	p->diameter = read_diameter(s);
	p->time[0] = table_number(t, s->time_column);
	if (!(fabs(p->time[0]) <= 1e9) || (s->count && p->time[0] < before))
		die(EXIT_RUN,
			"%s: line %ld: time %g s, want times in order, up to 1e9 s (before: %g s)",
			table_name(t), table_line(t), p->time[0], before);
	passage_carry(&s->stream, s->count, p);
	if (s->velocity_column < 0) {
		drift_flow(s, p);
		return 1;
	}
	p->velocity = table_number(t, s->velocity_column);
	if (!(p->velocity >= s->slowest && p->velocity <= 1e4 * s->slowest))
		die(EXIT_RUN,
			"%s: line %ld: velocity %g m/s, want 0.01 to 100 times that of the "
			"oil, %g to %g m/s",
			table_name(t), table_line(t), p->velocity, s->slowest,
			1e4 * s->slowest);
	p->time[1] = p->time[0] + s->stream.spacing / p->velocity;
	p->radius = NAN;
	return 1;
}

static int next_particle(struct source *s, struct passage *p)
{
	if (!s->arrivals) {
		if (!next_row(s, p))
			return 0;
	} else if (!arrivals_next(s->arrivals, &p->time[0])) {
		return 0;
	} else if (s->diameters) {
		p->diameter = s->diameters[s->count];
		s->material = s->materials[s->count];
		passage_carry(&s->stream, s->count, p);
		drift_flow(s, p);
	} else {
		s->material =
			material_draw(s->stream.seed, s->stream.realisation, s->count);
		passage_draw(&s->stream, s->count, p);
		drift_flow(s, p);
	}
	material_respond(s->material, p);
	s->count++;
	return 1;
}

int source_next(struct source *s, struct passage *p)
{
	while (next_particle(s, p)) {
		double half = sensors_half_pulse(p->velocity);

		/* Those that passed both sensors before the record begins are not in it.
		 */
		if (fmax(p->time[0], p->time[1]) + half > 0 &&
			(isnan(source_duration) || p->time[0] - half < source_duration))
			return 1;
		s->outside++;
		if (p->time[0] - sensors_half_pulse(s->slowest) >= source_duration)
			return 0;
	}
	return 0;
}

uint64_t source_count(const struct source *s)
{
	return s->count;
}

const char *source_material(const struct source *s)
{
	return s->material->name;
}

double source_slowest(const struct source *s)
{
	return s->slowest;
}

const char *source_cmd(const struct source *s)
{
	return s->cmd;
}

const char *source_doubt(struct source *s)
{
	return s->table ? table_doubt(s->table) : NULL;
}

const char *source_doubted(struct source *s)
{
	if (!s->table)
		return NULL;
	/* The comment may follow the rows, of which the last may be after the record. */
	while (next_line(s))
		s->outside++;
	if (s->outside > 0)
		warn("%s: %.0f particles pass before or after the record",
			table_name(s->table), (double)s->outside);
	verdict_report();
	return table_doubted(s->table);
}

void source_close(struct source *s)
{
	if (s->table)
		table_close(s->table);
	arrivals_free(s->arrivals);
	normals_free(s->normals);
	free(s->diameters);
	free(s->materials);
	free(s->cmd);
	free(s);
}
