#include "scores.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "example_options.h"
#include "io/tables.h"
#include <math.h>
#include <stdlib.h>

static void put_sines(struct table_out *t, double sd, const struct delayscore *s)
{
	struct delaylevels level = delaylevels((int)lessons.sources);
	const double row[] = { sd, (double)s->samples, s->ordered, s->ordered_se,
		s->unordered, s->unordered_se, s->sorted, s->sums, level.constant,
		level.constant_sorted, level.sorted_ordered, level.draw };

	table_put_row(t, row, sizeof row / sizeof *row);
}

/* One row: scores of the network for samples with this noise. */
static void score_sines(struct table_out *t, struct network *net, double sd)
{
	struct delayloss_par loss_par = lessons_loss();
	struct delayscore score = { 0 };
	struct lesson l;

	lessons.noise = sd;
	l = lessons_make();
	lessons_keep(&l);
	for (long i = 0; i < lessons.count; i += FORWARD) {
		int n = lessons.count - i < FORWARD ? (int)(lessons.count - i) : FORWARD;

		delayscore_add(&score, &loss_par, n, (int)lessons.sources,
			network_forward(net, l.x + i * l.inputs, n),
			l.target + i * l.targets);
	}
	delayscore_finish(&score);
	put_sines(t, sd, &score);
	stats_add("samples", (double)lessons.count);
	lesson_drop(&l);
}

static void put_pulses(struct table_out *t, int n, const struct cnndata_score *s)
{
	const double row[] = { n, (double)lessons.count, s->count_right, s->arrival,
		s->delay, s->alone, s->size };

	table_put_row(t, row, sizeof row / sizeof *row);
}

/* One row: sections of n pulses. */
static void score_pulses(struct table_out *t, struct network *net, int n)
{
	struct cnndata_par par = lessons_pulses();
	struct cnndata_score score;

	par.sources[0] = par.sources[1] = n;
	score = cnndata_score(net, &par, (uint32_t)lessons.first, lessons.count);
	put_pulses(t, n, &score);
	stats_add("samples", (double)lessons.count);
}

void score_network(const char *path)
{
	struct netfile file;
	struct network *net = lessons_network(path, &file);
	char *cmd = opt_cmd(file.cmd, NULL);
	struct table_out *t = table_create(NULL, cmd,
		lessons.model == SINES ? "1 1 1 1 1 1 1 1 1 1 1 1" : "1 1 1 1 1 1 1",
		lessons.model == SINES
			? "noise samples ordered ordered_se unordered unordered_se sorted "
			  "sums constant constant_sorted sorted_ordered draw"
			: "sources sections count_right arrival_rmse delay_rmse "
			  "delay_alone size_rmse");
	double sd = isnan(lessons.noise) ? sqrt(0.1) : lessons.noise;

	if (lessons.model == SINES && (network_input(net).width != lessons.points ||
					      network_outputs(net) != lessons.sources))
		die(EXIT_RUN,
			"%s: %d points and %d delays, but the samples have %ld and %ld",
			path ? path : "standard input", network_input(net).width,
			network_outputs(net), lessons.points, lessons.sources);
	if (lessons.model == SINES)
		score_sines(t, net, 0);
	if (lessons.model == SINES && sd > 0)
		score_sines(t, net, sd);
	for (int n = 1; n <= CNN_SOURCES && lessons.model == PULSES; n++)
		if (!opt_given("sources") || n == lessons.sources)
			score_pulses(t, net, n);
	table_done(t);
	free(cmd);
	free(file.cmd);
	network_free(net);
}
