/* predict.c - see predict.h */
#include "life/predict.h"
#include "life/damage.h"
#include "life/draw.h"
#include "life/grey.h"
#include "life/history.h"
#include "life/metrics.h"
#include "num/select.h"
#include <math.h>
#include <stdlib.h>

enum {
	DEVIATES = 5,        /* normal deviates kept for each draw */
	LITERAL_STEPS = 1000 /* of the literal model: beyond them nothing crosses */
};

struct predict {
	struct predict_par par;
	struct history *history; /* of states, for the grey model */
	struct damage *damage;   /* for the others */
	double scale;            /* power of two near the threshold, for the grey model */
	struct climb climb;      /* what is compared with the fleet */
	long rows;
	double first, last; /* times */
	double *z;          /* [DEVIATES draws] normal deviates */
	double *life;       /* [draws] */
};

static unsigned families(enum predict_model model)
{
	static const unsigned of[] = { DAMAGE_ALL, DAMAGE_LINEAR, DAMAGE_EXPONENTIAL,
		DAMAGE_POWER, DAMAGE_RATE, 0, 0 };

	return of[model];
}

struct predict *predict_new(const struct predict_par *par)
{
	struct predict *p = calloc(1, sizeof *p);
	struct draw *draw = draw_new(par->seed, par->realisation, RNG_PREDICT);
	size_t n = (size_t)par->draws;
	int exponent = 0;

	if (p) {
		frexp(par->threshold - par->zero, &exponent);
		p->scale = ldexp(1, exponent);
		p->par = *par;
		p->climb.direction = par->direction;
		p->history = history_new();
		p->damage =
			damage_new(families(par->model), par->threshold, par->direction);
		p->z = calloc(n, DEVIATES * sizeof *p->z);
		p->life = calloc(n, sizeof *p->life);
	}
	if (!draw || !p || !p->history || !p->damage || !p->z || !p->life) {
		draw_free(draw);
		predict_free(p);
		return NULL;
	}
	draw_normals(draw, p->z, DEVIATES * n);
	draw_free(draw);
	return p;
}

void predict_free(struct predict *p)
{
	if (!p)
		return;
	history_free(p->history);
	damage_free(p->damage);
	free(p->z);
	free(p->life);
	free(p);
}

void predict_add(struct predict *p, double t, double y, double state)
{
	if (p->rows++ == 0)
		p->first = t;
	p->last = t;
	if (p->par.fleet && !isnan(y))
		climb_add(&p->climb, t, y);
	if (p->par.model == PREDICT_GREY)
		history_add(p->history, t, (state - p->par.zero) / p->scale);
	else if (p->par.model != PREDICT_LITERAL && !isnan(y))
		damage_add(p->damage, t, y);
}

void predict_restart(struct predict *p)
{
	history_clear(p->history);
	damage_clear(p->damage);
	p->climb = (struct climb){ .direction = p->par.direction };
}

/* Time from span on until the curve of means over a gap reaches the threshold. */
static double grey_crossing(
	const struct predict *p, double level, double rate, double span, double gap)
{
	double now = grey_curve(level, rate, span, gap),
	       limit = (p->par.threshold - p->par.zero) / p->scale;
	double time;

	if (p->par.direction * (now - limit) >= 0)
		return 0;
	time = -log(limit / now) / rate;
	return time >= 0 ? time : INFINITY; /* also NAN: a sign that never changes */
}

static void draw_grey(struct predict *p, const double *t, const double *x, int n)
{
	struct grey g = { 0 };
	double gap = (t[n - 1] - t[0]) / (n - 1);

	for (int k = n; k-- > 0;)
		grey_add(&g, x[k], k + 1 < n ? t[k + 1] - t[k] : 0);
	for (int i = 0; i < p->par.draws; i++) {
		double rate = grey_rate(&g) + grey_rate_error(&g) * p->z[2 * i];
		double level = g.mean_x + grey_level_error(&g) * p->z[2 * i + 1] +
			       rate * (g.tail - g.mean_u);

		p->life[i] =
			grey_crossing(p, level, rate, g.span + p->last - t[n - 1], gap);
	}
}

/* Lives by comparison with the fleet, given that the unit still lives: draws that have
 * run out already are replaced by others that have not.  0 where there are none. */
static int draw_from_fleet(struct predict *p)
{
	double since = p->last - p->climb.first - p->climb.age;
	int n = p->par.draws, alive = 0;

	if (!p->par.fleet || p->climb.rows == 0 ||
		!fleet_life(p->par.fleet, p->climb.level, p->climb.age, p->z, p->life, n))
		return 0;
	for (int i = 0; i < n; i++)
		if (p->life[i] > since)
			p->life[alive++] = p->life[i] - since;
	for (int i = alive; alive > 0 && i < n; i++)
		p->life[i] = p->life[i - alive];
	return alive > 0;
}

/* Fills life[]; 0 while there are too few rows. */
static int draw_lives(struct predict *p)
{
	const double *t, *x;
	int rows;

	if (draw_from_fleet(p))
		return 1;

	if (p->par.model == PREDICT_LITERAL)
		return adaptive_lives(p->par.adaptive, p->par.threshold - p->par.zero,
			p->par.direction, LITERAL_STEPS, p->life);
	if (p->par.model != PREDICT_GREY) {
		if (damage_rows(p->damage) < GREY_ORDER_MIN)
			return 0;
		damage_draw(p->damage, p->last, p->z, DEVIATES * p->par.draws, p->life,
			p->par.draws);
		return 1;
	}
	rows = history_get(p->history, &t, &x);
	if (rows >= GREY_ORDER_MIN)
		draw_grey(p, t, x, rows);
	return rows >= GREY_ORDER_MIN;
}

/* Sorts what metric_quantile() will look at: the two values about each level. */
static void sort_levels(double *life, int draws, const double *level, int n)
{
	for (int k = 0; k < n; k++) {
		size_t n_draws = (size_t)draws, i = (size_t)(level[k] * (draws - 1));
		size_t pair[2] = { i, i + 1 };

		select_ranks(life, n_draws, pair, i + 1 < n_draws ? 2 : 1);
	}
}

void predict_life(struct predict *p, const double *level, double *quantile, int n,
	double *no_crossing)
{
	double horizon = p->par.horizon;
	int draws = p->par.draws, never = 0;

	if (!(horizon > 0))
		horizon = p->par.fleet ? INFINITY : 10 * (p->last - p->first);
	*no_crossing = NAN;
	for (int k = 0; k < n; k++)
		quantile[k] = NAN;
	if (!draw_lives(p))
		return;
	for (int i = 0; i < draws; i++)
		if (!(p->life[i] <= horizon && p->life[i] < INFINITY)) {
			p->life[i] = INFINITY;
			never++;
		}
	sort_levels(p->life, draws, level, n);
	for (int k = 0; k < n; k++)
		quantile[k] = metric_quantile(p->life, (size_t)draws, level[k]);
	*no_crossing = (double)never / draws;
}
