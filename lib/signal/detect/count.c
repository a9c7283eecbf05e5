/* count.c - see count.h */
#include "signal/detect/count.h"
#include "num/parabola.h"
#include "num/robust.h"
#include "num/sigmas.h"
#include <math.h>
#include <stdlib.h>

struct count {
	double level;
	double n;                                  /* samples so far */
	double last;                               /* the sample before */
	int armed;                                 /* a peak is being followed */
	double top, top_at, top_before, top_after; /* highest sample and its neighbours */
	double valley; /* lowest since the last peak was returned */
};

double count_level(const double *x, size_t n, size_t stride, double *work)
{
	for (size_t i = 0; i < n; i++)
		work[i] = x[i * stride];
	return SIGMAS_NEVER * robust_spread(work, n);
}

struct count *count_new(double level)
{
	struct count *c = calloc(1, sizeof *c);

	if (c)
		c->level = level;
	return c;
}

void count_free(struct count *c)
{
	free(c);
}

static void give(struct count *c, struct peak *peak)
{
	double shift = parabola_top(c->top_before, c->top, c->top_after);

	peak->t = c->top_at + shift;
	peak->height = c->top - 0.25 * (c->top_before - c->top_after) * shift;
	c->armed = 0;
	c->valley = c->last;
}

int count_sample(struct count *c, double x, struct peak *peak)
{
	int found = 0;

	if (c->armed && c->top_at == c->n - 1)
		c->top_after = x;
	/* A new rise has doubled since the lowest point after the last peak. */
	if (c->armed ? x > c->top : x >= c->level && x >= 2 * c->valley) {
		c->armed = 1;
		c->top = x;
		c->top_at = c->n;
		c->top_before = c->last;
		c->top_after = x;
	}
	c->last = x;
	if (c->armed && x < 0.5 * c->top) {
		give(c, peak);
		found = 1;
	}
	if (!c->armed && (x < c->valley || found))
		c->valley = x > 0 ? x : 0;
	c->n++;
	return found;
}

int count_end(struct count *c, struct peak *peak)
{
	if (!c->armed)
		return 0;
	give(c, peak);
	return 1;
}
