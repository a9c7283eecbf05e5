#include "whole_record.h"
#include "cli/msg.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include "signal/mixture/mixture.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 4096, SHOWN = 8 };

static void tell(long done, long windows)
{
	progress("windows", (double)done, (double)windows);
}

static struct mixture *read_record(struct signal_in *in, const struct mixture_par *par)
{
	static double x[2 * BLOCK];
	struct mixture *m = mixture_new(par);
	size_t n;

	if (!m)
		die(EXIT_RUN, "no memory");
	while ((n = signal_read_some(in, x, BLOCK)) > 0) {
		for (size_t i = 0; i < 2 * n; i++)
			if (!isfinite(x[i]))
				die(EXIT_RUN,
					"%s: channel %zu, frame %zu: not a finite number",
					signal_name(in), i % 2 + 1,
					mixture_frames(m) + i / 2);
		if (mixture_push(m, x, n) != NUM_OK)
			die(EXIT_RUN, "%s: no memory to hold the record",
				signal_name(in));
	}
	return m;
}

/* One row of the sections, which is the record. */
static void put_record(struct found *out, const struct mixture *m, int count)
{
	const double row[] = { 1, 0, (double)mixture_frames(m) / (double)out->rate,
		count };

	for (int i = 0; i < 12; i++)
		table_put(out->section_rows, i < 4 ? row[i] : NAN);
	table_put_text(out->section_rows, "mixture");
	table_end_row(out->section_rows);
}

static void put_histogram(struct found *out, const struct mixture *m)
{
	for (int i = 0; i < HISTOGRAM_ALL; i++) {
		double a, delta;

		mixture_cell(m, i / HISTOGRAM_CELLS, i % HISTOGRAM_CELLS, &a, &delta);
		const double row[4] = { 1, a, delta / (double)out->rate,
			mixture_histogram(m)[i] };

		table_put_row(out->weights, row, 4);
	}
}

/* Source k goes to channel k throughout; beyond the eighth they share the channels. */
static void put_sources(struct found *out, struct mixture *m, int count)
{
	size_t n = mixture_frames(m);
	double *x = xcalloc((size_t)count * n + 1, sizeof *x);

	if (mixture_separate(m, x) != NUM_OK)
		die(EXIT_RUN, "no memory");
	for (size_t i = 0; i < n; i++) {
		double frame[SHOWN] = { 0 };

		for (int k = 0; k < count; k++)
			frame[k % SHOWN] += x[(size_t)k * n + i];
		signal_write(out->sources, frame, 1);
	}
	out->drawn = (long long)n;
	free(x);
}

int whole_record(
	struct signal_in *in, struct found *out, size_t window, size_t hop, int sources)
{
	struct mixture_par par = {
		.window = window, .hop = hop, .sources = sources, .progress = tell
	};
	struct mixture_source source[MIXTURE_SOURCES];
	struct mixture *m;
	int count, doubtful;

	/* The power of two nearest to 64 ms, by ratio: speech is most nearly disjoint in
	 * windows of 1024 samples at 16 kHz (Yilmaz and Rickard, see mixture.h). */
	if (!window)
		for (par.window = 4; (double)par.window < 0.045 * (double)out->rate;)
			par.window *= 2;
	if (!hop)
		par.hop = par.window / 4 ? par.window / 4 : 1;
	m = read_record(in, &par);
	count = mixture_find(m, source);
	for (int k = 0; k < count; k++)
		table_comment(out->particles, "source",
			"%d attenuation %.6g delay %.6g s share %.3g", k + 1,
			source[k].attenuation, source[k].delta / (double)out->rate,
			source[k].share);
	if (!count) {
		warn("%s: nothing in common of both channels", signal_name(in));
		found_doubt(out, "nothing in common of both channels");
	}
	doubtful = mixture_is_far(m);
	if (doubtful) {
		warn("%s: delays beyond 16 samples: these sources are doubtful",
			signal_name(in));
		found_doubt(out, "delays beyond 16 samples");
	}
	if (out->section_rows)
		put_record(out, m, count);
	if (out->weights)
		put_histogram(out, m);
	if (out->sources)
		put_sources(out, m, count);
	stats_set("samples", (double)mixture_frames(m));
	stats_set("sources", count);
	mixture_free(m);
	return doubtful || !count;
}
