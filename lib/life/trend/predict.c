/* predict.c - see predict.h */
#include "life/trend/predict.h"
#include "life/grey/grey.h"
#include "life/score/metrics.h"
#include "life/trend/passage.h"
#include <math.h>
#include <stdlib.h>

/* Of the literal model: a particle that needs more never reaches the threshold. */
enum { LITERAL_STEPS = 1000 };

struct predict {
	struct predict_par par;
	struct bank *bank; /* NULL for the grey and the literal model */
	struct progress {
		long rows;
		double first, last;      /* times */
		struct grey_series grey; /* of states, for the grey model */
	} now;
};

struct predict *predict_new(const struct predict_par *par)
{
	static const unsigned families[] = { BANK_ALL, BANK_LINEAR, BANK_EXPONENTIAL,
		BANK_POWER, BANK_RATE, BANK_SATURATING, 0, 0 };
	struct predict *p = calloc(1, sizeof *p);

	if (!p)
		return NULL;
	p->par = *par;
	p->par.bank.families =
		families[par->model] | (par->bank.n_more > 0 ? BANK_OTHER : 0);
	p->par.bank.steady = par->model != PREDICT_AVERAGE;
	if (par->model >= PREDICT_GREY || (p->bank = bank_new(&p->par.bank)))
		return p;
	free(p);
	return NULL;
}

void predict_free(struct predict *p)
{
	if (!p)
		return;
	bank_free(p->bank);
	free(p);
}

void predict_pass(struct predict *p, struct state *s)
{
	state_move(s, &p->now, sizeof p->now);
	if (p->bank)
		bank_pass(p->bank, s);
}

void predict_add(struct predict *p, double t, double y, double state, const double *load)
{
	if (p->par.model == PREDICT_GREY)
		grey_append(&p->now.grey, state - p->par.zero, t - p->now.last);
	if (p->now.rows++ == 0)
		p->now.first = t;
	p->now.last = t;
	if (!p->bank)
		return;
	bank_load(p->bank, t, load);
	bank_add(p->bank, t, y);
}

int predict_draws(const struct predict *p)
{
	return p->par.model == PREDICT_LITERAL ? p->par.draws
					       : bank_chances_count(p->par.chances);
}

struct bank *predict_bank(struct predict *p)
{
	return p->bank;
}

static enum num_status draw_grey(const struct predict *p, double *life)
{
	if (p->now.grey.n < GREY_ORDER_MIN)
		return NUM_DOMAIN;
	for (int i = 0; i < predict_draws(p); i++)
		life[i] = grey_life(&p->now.grey, p->par.bank.threshold - p->par.zero,
			p->par.bank.direction, bank_chance_normal(p->par.chances, i, 0),
			bank_chance_normal(p->par.chances, i, 1));
	return NUM_OK;
}

/* Fills life[]; NUM_DOMAIN while there are too few rows. */
static enum num_status draw_lives(struct predict *p, double *life)
{
	if (p->par.model == PREDICT_GREY)
		return draw_grey(p, life);
	if (!p->bank)
		return adaptive_lives(p->par.adaptive,
			p->par.bank.threshold - p->par.zero, p->par.bank.direction,
			LITERAL_STEPS, life);
	if (!bank_ready(p->bank))
		return NUM_DOMAIN;
	return bank_draw(
		p->bank, p->par.chances, p->now.last, p->par.bank.threshold, life);
}

enum num_status predict_life(struct predict *p, double *life)
{
	double horizon = p->par.horizon;
	enum num_status status = draw_lives(p, life);

	if (status != NUM_OK)
		return status;
	if (!(horizon > 0))
		horizon = p->par.bank.n_more > 0 ? INFINITY
						 : 10 * (p->now.last - p->now.first);
	metric_cut(life, (size_t)predict_draws(p), horizon);
	return NUM_OK;
}

double predict_replacement(const double *life, int n, double age, double ratio)
{
	double best = INFINITY, at = INFINITY, area = 0, before = 0;

	/* cost per time of a replacement just before the i-th failure */
	for (int i = 0; i < n && isfinite(life[i]); i++) {
		double failed = (double)i / n, cost;

		area += (1 - failed) * (life[i] - before);
		before = life[i];
		cost = (1 + (ratio - 1) * failed) / (age + area);
		if (cost < best) {
			best = cost;
			at = life[i];
		}
	}
	/* If the cost still falls at the last failure, no replacement is advised. */
	return at == before ? INFINITY : at;
}
