/* together.c - see together.h */
#include "signal/separate/together.h"
#include "num/select.h"
#include <math.h>
#include <stdlib.h>

/* Expected share of wrong rows among those that are not doubted.  0.01, 0.007, 0.005 and
 * 0.0025 leave 1.9, 1.4, 0.8 and 0.4 % of them wrong in twelve records of 100 to 250
 * particles a second (scenes dense of tests/matrix/scenes.tsv, -s 500), and keep 0.88,
 * 0.86, 0.83 and 0.73 of the particles: pairs hidden by a third pulse are underrated.  In
 * seven of 200 to 300 (two of pulses sech; seeds 61001, 61002, 62001) 0.006 leaves 1.6 %
 * and 0.005 1.4 % wrong, of 3 % fewer rows; 0.005 leaves less than four fifths of groups
 * of Gaussian pulses (group-gauss-3). */
static const double SHARE = 0.006;

/* Durations by which one pulse follows another that count for how often one does: nearer
 * ones may have been fitted as one. */
static const double NEAR = 0.1, FAR = 0.6;

/* Height over that of the nearest larger pulse below which a pulse near it may be an
 * error of the shape of the larger one: residuals of a shape are smaller. */
static const double WEAK = 0.1;

struct together {
	struct evidence row[EVIDENCE_KEPT]; /* not doubted */
	int followers[EVIDENCE_KEPT];       /* NEAR to FAR behind each; -1: it is weak */
	double gap[EVIDENCE_KEPT]; /* to the next one of its sign, at most NEAR */
	size_t rows, all;          /* taken in so far: not doubted, and all */
	double density;            /* followers per duration */
	double mean, sd, width;    /* of sizes, and of their kernel */
	size_t sized;              /* rows when the width was chosen */
	double limit;              /* probability beyond which rows are doubted */
};

struct together *together_new(void)
{
	return calloc(1, sizeof(struct together));
}

void together_free(struct together *t)
{
	free(t);
}

static int count_followers(const struct evidence *a, size_t i, size_t n)
{
	int count = a[i].weak ? -1 : 0;

	for (size_t k = i + 1; count >= 0 && k < n && a[k].group == a[i].group; k++) {
		double apart = a[k].time - a[i].time;

		if (apart > FAR)
			break;
		count += apart > NEAR && !a[k].weak;
	}
	return count;
}

/* How far, in durations, pulse i is behind the one before it; INFINITY if it is not near,
 * of the other sign, or one of the two is weak. */
static double gap_before(const struct evidence *a, size_t i, size_t n)
{
	const struct evidence *p, *q;

	if (i == 0 || i == n)
		return INFINITY;
	p = &a[i - 1];
	q = &a[i];
	if (p->group != q->group || p->weak || q->weak ||
		p->amplitude * q->amplitude < 0 || q->time - p->time > NEAR)
		return INFINITY;
	return q->time - p->time;
}

/* The largest pulse on one side of pulse i, step 1 or -1; 0: there is none. */
static double largest_beside(
	const struct evidence *a, size_t i, size_t n, double beside, int step)
{
	double largest = 0;

	for (size_t k = i + (size_t)step;
		k < n && a[k].group == a[i].group && fabs(a[k].time - a[i].time) < beside;
		k += (size_t)step)
		largest = fmax(largest, fabs(a[k].amplitude));
	return largest;
}

static double kernel(double x, double width)
{
	double z = x / width;

	return exp(-0.5 * z * z) / (sqrt(2 * M_PI) * width);
}

/* Density of the sizes of particles unlike any other. */
static double unlike(const struct together *t, double x)
{
	double off = x - t->mean;

	return t->sd / (M_PI * (t->sd * t->sd + off * off));
}

/* Probability density of the logarithm of the amplitude of row self, were it one
 * particle, with standard error blur: that of the others, as far as they are believed,
 * and, as one among them, of a particle unlike any other (a Dirichlet process, Ferguson,
 * Ann. Stat. 1, 1973). */
static double size_density(const struct together *t, double x, size_t self, double blur)
{
	double sum = unlike(t, x), all = 1, width = hypot(t->width, blur);

	for (size_t i = 0; i < evidence_kept(t->rows); i++)
		if (i != self) {
			sum += (1 - t->row[i].wrong) * kernel(x - t->row[i].size, width);
			all += 1 - t->row[i].wrong;
		}
	return sum / all;
}

/* The width of the kernel, of the widest, its half, and so on, that foretells each size
 * best from the others.  The widest is right for a normal distribution (Silverman,
 * Density Estimation, 1986, eq. 3.28), narrower ones for steep edges, beyond which there
 * are only pairs. */
static double best_width(const struct together *t, double widest)
{
	enum { WIDTHS = 4 };
	double others[EVIDENCE_KEPT][WIDTHS] = { { 0 } }, most = -INFINITY, best = widest;

	for (size_t i = 0; i < evidence_kept(t->rows); i++)
		for (size_t k = 0; k < i; k++) {
			double z = (t->row[i].size - t->row[k].size) / widest;
			double one = exp(-0.5 * z * z);

			/* Of half the width it is the fourth power. */
			for (int w = 0; w < WIDTHS; w++, one *= one * one * one) {
				others[i][w] += (1 - t->row[k].wrong) * one;
				others[k][w] += (1 - t->row[i].wrong) * one;
			}
		}
	for (int w = 0; w < WIDTHS; w++) {
		double width = ldexp(widest, -w), sum = 0;

		for (size_t i = 0; i < evidence_kept(t->rows); i++)
			sum += (1 - t->row[i].wrong) *
			       log(unlike(t, t->row[i].size) +
				       others[i][w] / (sqrt(2 * M_PI) * width));
		if (sum > most) {
			most = sum;
			best = width;
		}
	}
	return best;
}

/* How often pulses follow, and how large they are.  Rows count as far as they are
 * believed; a pulse that follows may hide another one.  The width, which takes the most
 * time, is chosen again when a sixteenth of the rows are new. */
static void learn(struct together *t)
{
	double n = 0, strong = 0, pairs = 0, mean = 0, square = 0, sum = 0, followed = 0;

	for (size_t i = 0; i < evidence_kept(t->all); i++)
		if (t->followers[i] >= 0) {
			sum += t->followers[i];
			followed++;
		}
	for (size_t i = 0; i < evidence_kept(t->rows); i++) {
		n += 1 - t->row[i].wrong;
		strong += t->row[i].weak ? 0 : 1 - t->row[i].wrong;
		pairs += t->row[i].pair;
		mean += (1 - t->row[i].wrong) * t->row[i].size;
	}
	n = fmax(n, 1);
	mean /= n;
	for (size_t i = 0; i < evidence_kept(t->rows); i++)
		square += (1 - t->row[i].wrong) * pow(t->row[i].size - mean, 2);
	t->density = n / fmax(strong, 1) * (1 + pairs / (double)evidence_kept(t->rows)) *
		     sum / fmax(followed, 1) / (FAR - NEAR);
	t->mean = mean;
	t->sd = fmax(sqrt(square / n), 0.01);
	if (t->sized > 0 && t->rows <= t->sized + evidence_kept(t->rows) / 16)
		return;
	t->sized = t->rows;
	t->width = 1.06 * t->sd * pow(n, -0.2);
	if (t->density > 0)
		t->width = best_width(t, t->width);
}

/* Probability that a row is a pair.  With f the density of amplitudes, pairs of sum A and
 * share w of the smaller one are A f(wA) f((1 - w)A) / f(A) times as frequent as one of
 * A, per follower. */
static double pair_probability(const struct together *t, size_t self)
{
	double x = t->row[self].size, odds = 0, one;

	if (t->density == 0)
		return 0;
	one = size_density(t, x, self, 0);
	for (int k = 0; k < JOINT_SHARES; k++) {
		double w = joint_share(k), step = JOINT_SHARE_STEP / sqrt(12);

		odds += t->row[self].odds[k] * JOINT_SHARE_STEP *
			size_density(t, x + log(w), self, step / w) *
			size_density(t, x + log(1 - w), self, step / (1 - w)) /
			(w * (1 - w) * one);
	}
	odds *= t->density;
	return odds / (1 + odds);
}

/* Probability that a weak row beside a larger one is an error of the shape of that one:
 * the share by which such rows are more frequent than particles as small are beside
 * larger ones at random.  What is beside other rows tells where particles as small would
 * be weak, and those that are not weak tell how many there are.  Two standard deviations
 * of the difference of both numbers are allowed for. */
static double shape_probability(const struct together *t, double x)
{
	double weak = 1, strong = 1, seen = 0, others = unlike(t, x), random;

	for (size_t i = 0; i < evidence_kept(t->rows); i++) {
		double here = kernel(x - t->row[i].size, t->width);

		if (t->row[i].weak)
			seen += here;
		else
			others += (1 - t->row[i].wrong) * here;
		if (t->row[i].beside + log(WEAK) > x)
			weak += 1 - t->row[i].wrong;
		else
			strong += 1 - t->row[i].wrong;
	}
	random = weak / strong * others;
	random += 2 * sqrt((1 + weak / strong) * random * kernel(0, t->width));
	return fmax(1 - random / seen, 0);
}

/* Probability that a row is half of a pulse that two were fitted to because the shape is
 * slightly wrong: the share by which gaps of half to twice its gap are more frequent than
 * between particles at random (a local false discovery rate: Efron, Tibshirani, Storey,
 * Tusher, J. Am. Stat. Assoc. 96, 2001).  Two standard deviations of the number of
 * these are allowed for. */
static double half_probability(const struct together *t, double gap)
{
	const double least = gap / 2, most = fmin(2 * gap, NEAR);
	/* One more than seen: none in few rows does not mean that there are none. */
	double followers = 1, seen = 0, random;

	if (gap > NEAR)
		return 0;
	for (size_t i = 0; i < evidence_kept(t->all); i++) {
		seen += t->gap[i] >= least && t->gap[i] <= most;
		followers += fmax(t->followers[i], 0);
	}
	random = followers * (most - least) / (FAR - NEAR);
	return fmax(1 - (random + 2 * sqrt(random)) / seen, 0);
}

/* The largest probability, at most a half, up to which no more than SHARE of the rows are
 * wrong. */
static double find_limit(const struct together *t)
{
	double sorted[EVIDENCE_KEPT], sum = 0;
	size_t n = evidence_kept(t->rows), k = 0;

	for (size_t i = 0; i < n; i++)
		sorted[i] = t->row[i].wrong;
	sort_numbers(sorted, n);
	while (k < n && sorted[k] <= 0.5 && sum + sorted[k] <= SHARE * (double)(k + 1))
		sum += sorted[k++];
	return k == n ? 1 : k ? sorted[k - 1] : 0;
}

/* Passes over rows that are tested together, whose probabilities depend on one another.
 */
enum { PASSES = 4 };

/* The probabilities of the rows from first on. */
static void tell(struct together *t, size_t first)
{
	for (; first < t->rows; first++) {
		size_t self = first % EVIDENCE_KEPT;
		struct evidence *r = &t->row[self];

		r->pair = pair_probability(t, self);
		r->shape = r->weak ? shape_probability(t, r->size) : 0;
		r->wrong = 1 - (1 - r->pair) * (1 - r->shape) * (1 - r->half) /
				       (1 + r->exchange);
	}
}

/* Judges rows [begin, end) of n, as many as are held or fewer. */
static void test_some(
	struct together *t, struct evidence *a, size_t n, size_t begin, size_t end)
{
	size_t first = t->rows;

	for (size_t i = begin; i < end; i++) {
		t->followers[t->all % EVIDENCE_KEPT] = count_followers(a, i, n);
		t->gap[t->all++ % EVIDENCE_KEPT] = gap_before(a, i, n);
		a[i].wrong = a[i].pair = 0;
		if (a[i].doubted)
			continue;
		t->row[t->rows++ % EVIDENCE_KEPT] = a[i];
	}
	if (t->rows == first)
		return;
	for (size_t i = first; i < t->rows; i++)
		t->row[i % EVIDENCE_KEPT].half =
			half_probability(t, t->row[i % EVIDENCE_KEPT].gap);
	for (int pass = 0; pass < PASSES; pass++) {
		learn(t);
		tell(t, first);
	}
	t->limit = find_limit(t);
	for (size_t i = begin; i < end; i++)
		if (!a[i].doubted) {
			a[i] = t->row[first++ % EVIDENCE_KEPT];
			a[i].doubted = a[i].wrong > t->limit;
		}
}

void together_test(struct together *t, double beside, struct evidence *a, size_t n)
{
	for (size_t i = 0; i < n; i++) {
		double largest = fmax(largest_beside(a, i, n, beside, 1),
			largest_beside(a, i, n, beside, -1));

		a[i].size = log(fabs(a[i].amplitude));
		a[i].beside = log(largest);
		a[i].weak = fabs(a[i].amplitude) < WEAK * largest;
	}
	for (size_t i = 0; i < n; i++)
		a[i].gap = fmin(gap_before(a, i, n), gap_before(a, i + 1, n));
	for (size_t i = 0; i < n; i += EVIDENCE_KEPT)
		test_some(t, a, n, i, n - i < EVIDENCE_KEPT ? n : i + EVIDENCE_KEPT);
}
