/* validate.c - see validate.h */
#include "signal/separate/validate.h"
#include "num/robust.h"
#include "num/sigmas.h"
#include <math.h>
#include <stdlib.h>

enum { FEW = 8 }; /* fewest delays for an estimate of the variance */

struct delay {
	double value, var;
	int alone;
};

/* A weak pulse beside a larger one, see weak_beside(). */
struct weak {
	double place, ratio;
};

struct validation {
	struct delay delay[EVIDENCE_KEPT];
	unsigned char doubted[EVIDENCE_KEPT], at_edge[EVIDENCE_KEPT];
	double weaker[EVIDENCE_KEPT];
	size_t delays, rows; /* taken in so far */
	/* Range of delays; transit 0: not known. */
	double transit, least, most;
	struct flow flow, told;          /* as estimated, and as told before */
	struct weak weak[EVIDENCE_KEPT]; /* weak pulses beside larger ones */
	size_t weaks;
	double groups;
};

struct validation *validation_new(void)
{
	return calloc(1, sizeof(struct validation));
}

void validation_free(struct validation *v)
{
	free(v);
}

void validation_range(struct validation *v, double transit, double least, double most)
{
	v->transit = transit;
	v->least = least;
	v->most = most;
}

void validation_tell_flow(struct validation *v, const struct flow *flow)
{
	v->told = *flow;
}

void validation_flow(const struct validation *v, struct flow *flow)
{
	*flow = v->flow.count > 0 ? v->flow : v->told;
}

/* Number of rows of the group that begins at row i. */
static size_t group_size(const struct evidence *e, size_t i, size_t n)
{
	size_t k = i;

	while (k < n && e[k].group == e[i].group)
		k++;
	return k - i;
}

static int fits(const struct evidence *e, size_t m)
{
	for (size_t i = 0; i < m; i++)
		if (!e[i].fits)
			return 0;
	return 1;
}

/* --- the flow */

/* Adds the delay of the largest pulse of a group that fits. */
static void take_delay(struct validation *v, const struct evidence *e, size_t m)
{
	size_t largest = 0;

	for (size_t i = 1; i < m; i++)
		if (fabs(e[i].amplitude) > fabs(e[largest].amplitude))
			largest = i;
	if (!fits(e, m) || !(e[largest].var > 0))
		return;
	v->delay[v->delays++ % EVIDENCE_KEPT] =
		(struct delay){ e[largest].delay, e[largest].var, m == 1 };
}

/* Mean and variance of the delays of particles, by those that stand alone if there are
 * any. */
static void learn_flow(struct validation *v)
{
	double x[EVIDENCE_KEPT], scale, sum = 0, count = 0;
	size_t n = 0, alone = 0;

	for (size_t i = 0; i < evidence_kept(v->delays); i++)
		alone += (size_t)v->delay[i].alone;
	for (size_t i = 0; i < evidence_kept(v->delays); i++)
		if (v->delay[i].alone || alone < FEW)
			x[n++] = v->delay[i].value;
	if (n < FEW) {
		v->flow = v->told.count > 0 ? v->told : (struct flow){ .var = INFINITY };
		v->flow.count = 0;
		return;
	}
	v->flow.mean = robust_median(x, n);
	scale = robust_spread(x, n);
	for (size_t i = 0; i < evidence_kept(v->delays); i++) {
		const struct delay *d = &v->delay[i];
		double off = d->value - v->flow.mean;

		if ((!d->alone && alone >= FEW) || fabs(off) > SIGMAS_NEVER * scale)
			continue;
		sum += off * off - d->var;
		count++;
	}
	v->flow.count = count;
	v->flow.var = fmax(sum / count, 0);
	v->flow.margin =
		fmax(v->flow.var, scale * scale) * (1 + SIGMAS_SELDOM * sqrt(2 / count));
}

/* 1 if the velocities of a group are not those of the flow, by the cube root of
 * chi-square (Wilson and Hilferty, Proc. Natl. Acad. Sci. 17, 1931). */
static int is_impossible(const struct validation *v, const struct evidence *e, size_t m)
{
	double sum = 0, spread = 2 / (9 * (double)m);

	if (m < 2 || isinf(v->flow.var))
		return 0;
	for (size_t i = 0; i < m; i++)
		if (e[i].var > 0)
			sum += pow(e[i].delay - v->flow.mean, 2) /
			       (v->flow.margin + 2 * e[i].var);
	return cbrt(sum / (double)m) > 1 - spread + SIGMAS_NEVER * sqrt(spread);
}

/* Share of the range of delays, half of it on either side, that is its edge. */
static const double EDGE = 0.2;

/* 1 if the delay lies at the edge, and its error is smaller than that.  The range is
 * learned to be wider than that of the particles, by a share of their velocities: these
 * are compared by their logarithms. */
static int is_at_edge(const struct validation *v, const struct evidence *e)
{
	double half, middle, whole = v->transit + e->delay;

	if (!(v->transit > 0) || !(e->var > 0))
		return 0;
	half = 0.5 * log((v->transit + v->most) / (v->transit + v->least));
	middle = 0.5 * log((v->transit + v->most) * (v->transit + v->least));
	return sqrt(e->var) < EDGE * half * whole &&
	       fabs(log(whole) - middle) > (1 - EDGE) * half;
}

double validation_half(const struct validation *v)
{
	return isfinite(v->flow.var) ? 0.5 * (v->most - v->least) : 0;
}

/* --- weak pulses that recur */

/* 1 if pulse l is at least twice as high as e, and their velocities differ by no more
 * than the error. */
static int may_leave(const struct evidence *l, const struct evidence *e)
{
	return fabs(e->amplitude) < 0.5 * fabs(l->amplitude) && e->var > 0 &&
	       pow(e->delay - l->delay, 2) <= 10 * (e->var + l->var);
}

/* By how many durations of pulse l, which is long if it is slow, e follows it, and the
 * ratio of their amplitudes; place NAN: it is no error of the shape of l. */
static struct weak weak_beside(
	const struct validation *v, const struct evidence *l, const struct evidence *e)
{
	double longer = v->transit > 0 ? 1 + l->delay / v->transit : 1;

	return (struct weak){ .place = may_leave(l, e) ? (e->time - l->time) / longer
						       : NAN,
		.ratio = e->amplitude / l->amplitude };
}

/* Probability that chance puts as many weak pulses at one place: at most one correct
 * group in ten thousand is doubted. */
static const double RARELY = 1e-4;

/* 1 - the probability that a Poisson number is less than count. */
static double poisson_tail(int count, double mean)
{
	double term = exp(-mean), tail = 1;

	for (int k = 0; k < count; k++) {
		tail -= term;
		term *= mean / (k + 1);
	}
	return tail;
}

/* 1 if a tenth of the groups, of the last ones in a long record, have a weak pulse at
 * this place, of half to twice this ratio, more than chance explains.  Chance puts them
 * there as often as up to four times farther off or, where that is more, up to sixteen
 * times.  With a place of 1/32, 1/16 and 1/8 of a duration 6, 31 and 38 of 231227 pulses
 * at random, 3 per duration in groups of up to eight, are doubted if the ratio is not
 * looked at; a pulse of another shape in coloured noise, whose second pulses scatter by
 * 0.03, is found with the first two.  With 1/32 as here, 38 of 215641 pulses at random
 * are doubted in records of twelve groups and 15 in records of sixty.  Without the ratio
 * and the sixteen times these are 38 and 38, and seven echoes in a record of eight groups
 * are not doubted. */
static int recurs(const struct validation *v, struct weak w)
{
	static const double SAME = 0.03125;
	const size_t kept = evidence_kept(v->weaks);
	int here = 0, near = 0, far = 0;

	for (size_t k = 0; k < kept; k++) {
		double apart = fabs(v->weak[k].place - w.place);
		double times = v->weak[k].ratio / w.ratio;

		if (!(times >= 0.5 && times <= 2))
			continue;
		here += apart < SAME;
		near += apart >= SAME && apart < 4 * SAME;
		far += apart >= SAME && apart < 16 * SAME;
	}
	return here > 0.1 * fmin(v->groups, EVIDENCE_KEPT) &&
	       poisson_tail(here, fmax(near / 3.0, (far + 1) / 15.0)) * (double)kept <
		       RARELY;
}

/* --- the test */

static void take_in(struct validation *v, const struct evidence *e, size_t n)
{
	for (size_t i = 0, m; i < n; i += m) {
		m = group_size(e, i, n);
		take_delay(v, e + i, m);
		v->groups++;
		for (size_t k = 0; k < m * m; k++) {
			struct weak w = weak_beside(v, &e[i + k / m], &e[i + k % m]);

			if (!isnan(w.place))
				v->weak[v->weaks++ % EVIDENCE_KEPT] = w;
		}
	}
	learn_flow(v);
}

static void test_group(const struct validation *v, struct evidence *e, size_t m)
{
	int impossible = is_impossible(v, e, m);

	for (size_t i = 0; i < m; i++)
		e[i].doubted = impossible || !e[i].fits || is_at_edge(v, &e[i]);
	for (size_t k = 0; k < m * m; k++)
		if (recurs(v, weak_beside(v, &e[k / m], &e[k % m])))
			e[k / m].doubted = e[k % m].doubted = 1;
}

/* What a pulse has to explain, on average, at the sensor that shows it less: there the
 * fit finds 2 in noise, at the best of the delays of a range shorter than a pulse, with a
 * variance of 4, and the mean of FEW seldom more than this. */
static const double WEAKEST = 4;

/* 1 if more than half of the latest rows are doubted, or more than a tenth lie at the
 * edge, or what they show at one sensor is noise. */
static int fails(struct validation *v, const struct evidence *e, size_t n)
{
	size_t sum = 0, edge = 0, known = 0, rows;
	double weaker = 0;

	for (size_t i = 0; i < n; i++) {
		v->doubted[v->rows % EVIDENCE_KEPT] = (unsigned char)e[i].doubted;
		v->weaker[v->rows % EVIDENCE_KEPT] = e[i].weaker;
		v->at_edge[v->rows++ % EVIDENCE_KEPT] =
			(unsigned char)is_at_edge(v, &e[i]);
	}
	rows = evidence_kept(v->rows);
	for (size_t i = 0; i < rows; i++) {
		sum += v->doubted[i];
		edge += v->at_edge[i];
		known += v->weaker[i] > 0;
		weaker += v->weaker[i];
	}
	return (rows >= FEW && (2 * sum > rows || (edge > 2 && 10 * edge > rows))) ||
	       (known >= FEW && weaker < WEAKEST * (double)known);
}

void validation_test(struct validation *v, struct evidence *e, size_t n)
{
	take_in(v, e, n);
	for (size_t i = 0, m; i < n; i += m) {
		m = group_size(e, i, n);
		test_group(v, e + i, m);
	}
	if (fails(v, e, n))
		for (size_t i = 0; i < n; i++)
			e[i].doubted = 1;
}
