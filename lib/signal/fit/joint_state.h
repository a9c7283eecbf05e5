/* joint_state.h - data shared by the parts of the joint fit, for
 * lib/signal/fit only
 */
#ifndef SIGNAL_JOINT_STATE_H
#define SIGNAL_JOINT_STATE_H

#include "num/dot.h"
#include "num/status.h"
#include "signal/fit/joint.h"
#include <math.h>

enum {
	PAR = 3,
	NPAR = PAR * JOINT_PULSES_MAX,
	OWN_MAX = JOINT_OWN * JOINT_PULSES_MAX,
	BASIS_MAX = 2 * (JOINT_TONES_MAX + JOINT_BASELINE_MAX) + 1,
	PAIR_GAPS = 12,
	BASIS_ROOM = 4 * BASIS_MAX,
	PAIR_KNOTS = 2 * PAIR_GAPS /* of either channel */
};

/* One pulse on one channel: its derivatives by (t, t + delta, a). */
struct column {
	long first;
	size_t n;
	double *d[PAR];
};

/* Of what two pulses by a gap put on the record beside one: its part along the residual,
 * and inner products less what the fitted pulses take of them. */
struct pair_table {
	double along[PAIR_KNOTS], gram[PAIR_KNOTS][PAIR_KNOTS];
};

/* Vectors q of tones, baseline and offset: the inverse of the covariance of a channel is
 * 1 - sum q q^T.  Those of the last fits are kept: to learn, the same samples are fitted
 * again and again. */
enum { BASES = 32, BASIS_OF = 8 + JOINT_TONES_MAX };
struct basis {
	double of[BASIS_OF]; /* what it follows from */
	int vectors;
	double taken; /* degrees of freedom that they take, without the baseline's */
	double *q[2]; /* of either channel: vectors * n; the same unless they differ */
	size_t from[2][BASIS_MAX], to[2][BASIS_MAX]; /* samples that are not 0 */
};

/* Samples of a channel from sample first on, and their inner products with its basis. */
struct piece {
	long first;
	size_t n;
	const double *x, *along;
};

struct joint {
	struct joint_scene scene; /* of this fit or the last one, with its pulses */
	struct joint_pulse pulse[JOINT_PULSES_MAX];
	int m;
	struct joint_result result;
	struct joint_pulse before[JOINT_PULSES_MAX]; /* pulses before a move, */
	int m_before;                                /* which may be undone */
	size_t capacity;                             /* samples */
	size_t support;                              /* samples one pulse may touch */
	size_t n;
	double *e[2]; /* record minus pulses, with tones */
	double *r[2]; /* e without tones and offset */
	struct basis *basis, bases[BASES];
	int nbases;
	double *basis_memory; /* BASIS_ROOM of capacity */
	size_t basis_used;    /* of it, by bases[0 .. nbases) */
	double *memory;       /* columns of all pulses */
	double *scratch;      /* three of support */
	double *excess;       /* PAIR_KNOTS of support */
	struct pair_table pair;
	double *filter[2]; /* matched filter on the coarse grid */
	struct column col[JOINT_PULSES_MAX + 1][2];   /* as the pulses are */
	struct column trial[JOINT_PULSES_MAX + 1][2]; /* as they were before a step */
	int all[JOINT_PULSES_MAX]; /* 0, 1, 2, ...: the set of all pulses */
	double *h; /* 3 OWN_MAX * NPAR: normal matrix or its Cholesky factor, or
		      joint_own.c's */
	double *factor;
	double energy;           /* e^T e of both channels, ... */
	double qe[2][BASIS_MAX]; /* ... and Q^T e: kept up to date by the steps */
	double *bq;              /* Q^T J, see joint_column() */
	double gradient[NPAR], move[NPAR];
	double work; /* samples of columns computed, since it is new */
	double own[JOINT_OWN]
		  [JOINT_PULSES_MAX]; /* what a prior has moved the pulses by */
	int inverted; /* pulses whose normal matrix is in factor; 0: it was singular */
};

/* A pulse to try, and the expected reduction of chi-square. */
struct candidate {
	double t, delta, a, z2;
};

static inline double clamp(double x, double lo, double hi)
{
	return x < lo ? lo : x > hi ? hi : x;
}

/* Earliest (side 0) and latest (1) arrival. */
static inline double arrival_limit(const struct joint *j, int side)
{
	const struct joint_scene *s = &j->scene;
	double n = (double)j->n;
	double inside = s->quiet[side] > 0 ? fmin(s->quiet[side], 0.5 * n)
					   : -0.9 * shape_reach(s->shape) * s->duration;

	return side ? n - inside : inside;
}

/* Inner products of row x of J within channel c with the basis. */
static inline double *joint_row(const struct joint *j, int x, int c)
{
	return j->bq + (2 * x + c) * j->basis->vectors;
}

/* Column u of pulse i within channel c, the pth of those that J was made of. */
static inline struct piece joint_column(const struct joint *j, int i, int p, int u, int c)
{
	const struct column *col = &j->col[i][c];

	return (struct piece){ col->first, col->n, col->d[u],
		joint_row(j, PAR * p + u, c) };
}

/* Inner product of two pieces of one channel, less what the basis takes of it. */
static inline double joint_inner(const struct joint *j, struct piece x, struct piece y)
{
	return dot_within(x.x, x.n, y.x, y.n, x.first - y.first) -
	       dot(x.along, y.along, (size_t)j->basis->vectors);
}

/* joint_model.c: the record minus pulses, and its parts */

/* Stores the scene, the record and its m known pulses, and subtracts these. */
enum joint_status joint_start(struct joint *j, const struct joint_scene *s,
	const double *y1, const double *y2, size_t n, const struct joint_pulse *pulses,
	int m);
/* Room for columns of pulses in the range of delays of this scene. */
enum joint_status joint_reserve_columns(struct joint *j, const struct joint_scene *s);
/* The inner products of the first vectors of a channel's basis with x[0 .. n), whose
 * first sample is sample first. */
void joint_along(const struct joint *j, int c, int vectors, long first, const double *x,
	size_t n, double *along);
/* Energy of e and its part along the basis, from scratch. */
void joint_measure(struct joint *j);
double joint_chi_square(const struct joint *j);
/* r = e without its tones, as far as they are not known beforehand. */
void joint_project(struct joint *j);
/* e less sign times the pulse. */
void joint_subtract(struct joint *j, const struct joint_pulse *p, double sign);
void joint_subtract_all(struct joint *j, double sign);
/* Columns of pulse i. */
void joint_make_columns(struct joint *j, int i);

/* Samples of the last fit in [from, to) of a channel that are not hidden. */
size_t joint_visible(const struct joint *joint, int channel, size_t from, size_t to);

/* Sets those that are, of n samples of the channel from sample first on, to zero in x. */
void joint_hide(const struct joint *joint, int channel, long first, size_t n, double *x);

/* joint_step.c: the fit; pulses must have been subtracted */

/* One step from old along move, limited to meaningful pulses. */
struct joint_pulse joint_moved(
	const struct joint *j, const struct joint_pulse *old, const double *move);

/* Levenberg-Marquardt on the m pulses in set, the others held; returns chi-square. */
double joint_fit_set(
	struct joint *j, const int *set, int m, int max_steps, double tolerance);
void joint_fit_all(struct joint *j); /* sets chi-square */
/* Covariances from the inverse of the undamped normal matrix. */
void joint_fill_covariance(struct joint *j);

/* Each x becomes L^-1 x by the last factor, from row start on (x is zero above). */
void joint_reduce(const struct joint *j, int np, int start, double *const x[3]);
/* x becomes (L L^T)^-1 x. */
void joint_solve(const struct joint *j, int np, double *x);

/* Factor of the normal matrix of the pulses in set, with their columns. */
enum num_status joint_factorise(struct joint *j, const int *set, int m);

/* joint_own.c */

/* Fits what pulses have of their own, with their priors; the errors must be known, and
 * the residual projected. */
void joint_relax(struct joint *j);
/* Removes pulses that are insignificant once the others have something of their own. */
void joint_prune_relaxed(struct joint *j);

/* joint_pair.c */

/* Makes the table of pulse i, one of the m in set, whose factor was made. */
void joint_pair_start(struct joint *j, int i, const int *set, int m);
/* Largest of it among the gaps of the table, the same on both channels: gaps that differ
 * describe a wrong gain as well.  0: one pulse is most likely. */
double joint_pair_best(const struct joint *j, double *gap);

/* joint_moves.c: pulses, m and chi-square are kept up to date */

/* Tries one more pulse at c; 0 if chi-square does not fall enough: nothing has changed.
 */
int joint_try_pulse(struct joint *j, const struct candidate *c);
/* Splits pulses that look like two; returns how many were split. */
int joint_split_pulses(struct joint *j);
/* Exchanges arrivals of pulses at the second sensor if that reduces chi-square. */
void joint_swap_pulses(struct joint *j);
/* Forgets exchanges of pulses that have moved to another place since they were kept. */
void joint_forget_moved(struct joint *j);
/* Merges pulses so close that they may be one that was split in vain. */
void joint_merge_pulses(struct joint *j);
/* Removes insignificant pulses, the least significant first. */
void joint_prune(struct joint *j);

#endif
