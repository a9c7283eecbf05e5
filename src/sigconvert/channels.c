#include "channels.h"
#include "cli/msg.h"
#include "io/tables.h"
#include "stats/sketch.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STRETCH = 256, RUN = 4 };

/* One end of the range: its value and the samples in runs of it. */
struct rail {
	double value;
	double samples;
};

struct channel {
	struct rail low, high;
	double number, sum, missing;
	double last; /* value of the present run */
	long run;
	/* of the present segment, by Welford's recurrence */
	long n;
	double mean, square;
	struct sketch levels;
};

struct channels {
	struct signal_format format;
	char *cmd;
	double frames;
	struct channel *channel;
};

struct channels *channels_new(const struct signal_format *format)
{
	struct channels *c = xcalloc(1, sizeof *c);

	c->format = *format;
	c->cmd = format->cmd ? xstrdup(format->cmd) : NULL;
	c->channel = xcalloc((size_t)format->channels, sizeof *c->channel);
	for (int k = 0; k < format->channels; k++) {
		c->channel[k].low.value = INFINITY;
		c->channel[k].high.value = -INFINITY;
		c->channel[k].last = NAN;
	}
	return c;
}

static void add_to_rail(struct rail *r, double x, int beyond, long run)
{
	if (beyond) {
		r->value = x;
		r->samples = 0;
	}
	if (x == r->value && run >= RUN)
		r->samples += run == RUN ? RUN : 1;
}

static void end_stretch(struct channel *c)
{
	double level = c->n > 1 ? sqrt(c->square / (double)(c->n - 1)) : 0;

	if (c->n > 1 && sketch_add(&c->levels, fmax(level, DBL_MIN), SKETCH_MOST))
		die(EXIT_RUN, "out of memory");
	c->n = 0;
	c->mean = 0;
	c->square = 0;
}

static void add_sample(struct channel *c, double x)
{
	double from_mean;

	if (!isfinite(x)) {
		c->missing++;
		c->last = NAN;
		return;
	}
	c->run = x == c->last ? c->run + 1 : 1;
	c->last = x;
	add_to_rail(&c->low, x, x < c->low.value, c->run);
	add_to_rail(&c->high, x, x > c->high.value, c->run);
	c->number++;
	c->sum += x;
	from_mean = x - c->mean;
	c->mean += from_mean / (double)++c->n;
	c->square += from_mean * (x - c->mean);
	if (c->n == STRETCH)
		end_stretch(c);
}

void channels_add(struct channels *c, const double *x, size_t frames)
{
	int n = c->format.channels;

	for (size_t i = 0; i < frames; i++)
		for (int k = 0; k < n; k++)
			add_sample(&c->channel[k], x[i * (size_t)n + (size_t)k]);
	c->frames += (double)frames;
}

/* Lower decile of the segments; that of all samples where there is no complete segment.
 */
static double level_of(struct channel *c)
{
	double tenth = 0, level = NAN;

	if (c->levels.n == 0)
		end_stretch(c);
	if (sketch_sort(&c->levels))
		die(EXIT_RUN, "out of memory");
	for (size_t i = 0; i < c->levels.n; i++)
		tenth += c->levels.weight[i] / 10;
	for (size_t i = 0; i < c->levels.n && tenth > 0; i++) {
		level = c->levels.value[i];
		tenth -= c->levels.weight[i];
	}
	return level > DBL_MIN ? level : level == DBL_MIN ? 0 : NAN;
}

void channels_done(struct channels *c, const char *doubt)
{
	struct table_out *t = table_create(NULL, c->cmd, "1 Hz 1 unit unit unit unit 1 1",
		"channel rate frames low mean high level rails missing");

	for (int k = 0; k < c->format.channels; k++) {
		struct channel *at = &c->channel[k];
		int any = at->number > 0;
		double rails = at->low.samples;

		if (at->high.value > at->low.value)
			rails += at->high.samples;
		table_put(t, k + 1);
		table_put(t, (double)c->format.rate);
		table_put(t, c->frames);
		table_put(t, any ? at->low.value : NAN);
		table_put(t, at->sum / at->number);
		table_put(t, any ? at->high.value : NAN);
		table_put(t, level_of(at));
		table_put(t, rails);
		table_put(t, at->missing);
		table_end_row(t);
		sketch_free(&at->levels);
	}
	if (doubt)
		table_comment(t, "doubtful", "%s", doubt);
	table_done(t);
	free(c->cmd);
	free(c->channel);
	free(c);
}
