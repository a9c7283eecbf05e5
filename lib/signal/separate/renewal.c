/* renewal.c - see renewal.h */
#include "signal/separate/renewal.h"
#include "num/room.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Frames between two looks at the rows, so that they do not depend on the sizes of the
 * pieces passed. */
enum { PIECE = 256 };

/* A stretch is learned from at least this part of what is usual. */
enum { LEAST_PART = 8 };

/* Share of the rows that are doubted: a record is believed up to OFTEN
 * (separate_too_many()), and no row is from HALF on (validate.h).  CERTAIN: the
 * likelihood ratio of the two at which a new stretch fits, after eight rows that are not
 * doubted, and at which the present one has changed, after three sections.  Where it has
 * not, what is learned again is learned from fewer samples: with each row of a section
 * counted, the error of delays in 1000 groups of six pulses at 20 dB was 1.13 in place of
 * at most 1.1 of its bound (tests/long/duet.t). */
static const double OFTEN = 0.1, HALF = 0.5, CERTAIN = 100;

struct stretch {
	struct separate *s; /* NULL: none */
	long long origin;   /* frame of the record */
	long long fed;      /* frames before this one are pushed */
	size_t learn;       /* frames it is learned from */
	int ended;
	enum separate_status status;
	struct transit *row; /* rows held back */
	size_t rows, room;
	double sum;             /* of the test of all rows, ... */
	double change;          /* ... of Page's test of the last ones, ... */
	size_t settled;         /* ... and rows held back up to where that was last 0 */
	double tested, doubted; /* rows released */
	struct separate_counters counted; /* when none was held back */
};

struct renewal {
	struct separate_par par;
	int channels, only; /* 1: there is one stretch only */
	struct stretch now, next;
	int judged; /* 1: the rows that were learned from have been looked at */
	double *raw;
	size_t raw_room;
	long long from, upto; /* frames in raw */
	double spent;         /* on stretches that do not fit: work, separate_spent() */
	long long retry;      /* no other stretch is tried before this frame */
	int ended;
	struct transit *row; /* released */
	size_t rows, room, given;
	double last;  /* arrival of the last of them */
	long section; /* its section */
	long before;  /* sections of earlier stretches */
	long long *change;
	size_t changes, change_room;
};

/* Work that other stretches than the present one may still take: together as much as is
 * allowed in the record. */
static double work_left(const struct renewal *r)
{
	return separate_allowed(r->now.s) - r->spent;
}

static struct separate *begin(
	const struct renewal *r, struct stretch *t, long long origin, size_t learn)
{
	struct separate_par par = r->par;

	par.effort = r->now.s && t != &r->now ? work_left(r) : 0;
	if (learn > 0)
		par.learn = learn;
	*t = (struct stretch){ .s = separate_new(&par),
		.origin = origin,
		.fed = origin,
		.learn = learn       ? learn
			 : par.learn ? par.learn
				     : SEPARATE_LEARN };
	return t->s;
}

static void drop(struct stretch *t)
{
	separate_free(t->s);
	free(t->row);
	*t = (struct stretch){ .s = NULL };
}

struct renewal *renewal_new(const struct separate_par *par)
{
	struct renewal *r = calloc(1, sizeof *r);

	if (!r)
		return NULL;
	r->par = *par;
	r->channels = par->channels > 2 ? par->channels : 2;
	r->only = par->kept || par->on_section || par->clearly || par->sources ||
		  par->method != SEPARATE_FIT;
	r->last = -INFINITY;
	if (!begin(r, &r->now, 0, 0)) {
		free(r);
		return NULL;
	}
	return r;
}

void renewal_free(struct renewal *r)
{
	if (!r)
		return;
	drop(&r->now);
	drop(&r->next);
	free(r->raw);
	free(r->row);
	free(r->change);
	free(r);
}

struct separate *renewal_now(const struct renewal *r)
{
	return r->now.s;
}

const long long *renewal_changes(const struct renewal *r, size_t *n)
{
	*n = r->changes;
	return r->change;
}

/* Pushes the next piece into a stretch, or ends it; 0: there is none yet. */
static int feed(const struct renewal *r, struct stretch *t)
{
	long long upto = (t->fed / PIECE + 1) * PIECE;

	if (t->ended || (upto > r->upto && !r->ended))
		return 0;
	upto = upto < r->upto ? upto : r->upto;
	if (upto > t->fed)
		t->status = separate_push(t->s, r->raw + r->channels * (t->fed - r->from),
			(size_t)(upto - t->fed));
	t->fed = upto;
	if (t->status == SEPARATE_OK && r->ended && upto == r->upto)
		t->status = separate_end(t->s);
	t->ended = t->status != SEPARATE_OK || (r->ended && upto == r->upto);
	return 1;
}

/* 1 if the rows that were learned from have been tested, or never will be. */
static int is_ready(const struct stretch *t)
{
	struct instrument view;

	return t->ended || separate_instrument(t->s, &view);
}

static int is_described(const struct stretch *t)
{
	enum separate_doubt doubt = separate_doubtful(t->s);

	return separate_calibration(t->s) &&
	       (doubt == SEPARATE_BELIEVED || doubt == SEPARATE_COVERED);
}

/* 1, 0: the row is doubted, or not; -1: it is an event that is no particle. */
static int doubts(const struct transit *p)
{
	return p->verdict <= SEPARATE_OVERLAP                                       ? 0
	       : verdict_is_foreign(p->verdict) && p->verdict != SEPARATE_TRANSIENT ? -1
										    : 1;
}

/* Logarithm of the likelihood ratio of a row, of shares HALF and OFTEN doubted.  Two
 * particles that arrive together do not tell of the instrument; pulses that are fitted
 * together are doubted together. */
static double change_of(const struct transit *p)
{
	int d = doubts(p);

	if (p->together)
		return 0;
	if (d > 0)
		return log(HALF / OFTEN) /
		       (p->verdict == SEPARATE_MISFIT ? p->sources : 1);
	return d == 0 ? log((1 - HALF) / (1 - OFTEN)) : 0;
}

static void count_row(struct separate_counters *c, const struct transit *p)
{
	c->rows += p->verdict <= SEPARATE_MISFIT;
	c->negative += p->verdict <= SEPARATE_MISFIT && p->amplitude < 0;
	c->unresolved += p->verdict == SEPARATE_UNRESOLVED;
	c->events[p->verdict] += verdict_is_foreign(p->verdict);
}

/* Brings what was counted up to date where no row is held back; rows are counted as they
 * are given. */
static void count(struct stretch *t)
{
	struct separate_counters now = *separate_counters(t->s), *c = &t->counted;

	if (t->rows > 0 || t->tested == 0)
		return;
	now.rows = c->rows;
	now.negative = c->negative;
	now.unresolved = c->unresolved;
	memcpy(now.events, c->events, sizeof now.events);
	*c = now;
}

/* Gives the first n rows that were held back. */
static enum separate_status release(struct renewal *r, size_t n)
{
	struct stretch *t = &r->now;

	if (room_for(&r->row, &r->room, r->rows + n, sizeof *r->row))
		return SEPARATE_MEMORY;
	for (size_t i = 0; i < n; i++) {
		struct transit *p = &r->row[r->rows++];

		*p = t->row[i];
		p->section += r->before;
		r->section = p->section;
		if (p->t1 > r->last)
			r->last = p->t1;
		t->tested += doubts(p) >= 0;
		t->doubted += doubts(p) > 0;
		count_row(&t->counted, p);
	}
	t->rows -= n;
	t->settled -= n < t->settled ? n : t->settled;
	if (t->rows > 0)
		memmove(t->row, t->row + n, t->rows * sizeof *t->row);
	else
		t->change = 0;
	return SEPARATE_OK;
}

/* Takes the rows of a stretch; of the present one, those that are settled are given. */
static enum separate_status take_rows(struct renewal *r, struct stretch *t)
{
	struct transit p;

	while (separate_next(t->s, &p)) {
		p.t1 += (double)t->origin;
		p.t2 += (double)t->origin;
		if (room_for(&t->row, &t->room, t->rows + 1, sizeof *t->row))
			return SEPARATE_MEMORY;
		t->row[t->rows++] = p;
		t->sum += change_of(&p);
		t->change = fmax(0, t->change + change_of(&p));
		if (t->change == 0)
			t->settled = t->rows;
	}
	return t == &r->now && r->judged && !r->next.s ? release(r, t->settled)
						       : SEPARATE_OK;
}

/* Half of the frames that a stretch is learned from, or of those there are of it. */
static size_t half_of(const struct renewal *r, const struct stretch *t)
{
	size_t most = (size_t)(r->upto - t->origin);

	return (t->learn < most ? t->learn : most) / 2;
}

/* 1 if nothing can be learned from the first samples, which are not noise. */
static int is_unlearned(const struct stretch *t)
{
	return !separate_calibration(t->s) &&
	       (separate_counters(t->s)->unlearned > 0 ||
		       (t->ended &&
			       (t->status == SEPARATE_HARD ||
				       separate_doubtful(t->s) != SEPARATE_BELIEVED)));
}

/* Begins another stretch in place of the rows held back, if there is reason to. */
static enum separate_status look(struct renewal *r)
{
	struct stretch *now = &r->now;
	long long origin = now->origin;
	size_t learn = 0;

	if (r->next.s)
		return SEPARATE_OK;
	if (!r->judged && (is_ready(now) || is_unlearned(now))) {
		r->judged = 1;
		if (is_unlearned(now) || separate_doubtful(now->s) == SEPARATE_FOREIGN)
			learn = half_of(r, now);
		else if (release(r, now->settled) != SEPARATE_OK)
			return SEPARATE_MEMORY;
	}
	if (learn == 0) {
		double first;

		if (!r->judged || now->rows == 0 || now->tested == 0 ||
			now->change <= log(CERTAIN))
			return SEPARATE_OK;
		first = now->row[0].t1 >= 0 ? now->row[0].t1 : now->row[0].t2;
		origin = (long long)(0.5 * (r->last + first));
	}
	if (r->upto < r->retry || work_left(r) <= 0)
		return release(r, now->rows);
	origin = origin > r->from ? origin : r->from;
	return begin(r, &r->next, origin, learn) ? SEPARATE_OK : SEPARATE_MEMORY;
}

/* The next stretch takes the place of the present one and of the rows held back. */
static enum separate_status renew(struct renewal *r)
{
	if (r->next.origin > r->now.origin) {
		if (room_for(&r->change, &r->change_room, r->changes + 1,
			    sizeof *r->change))
			return SEPARATE_MEMORY;
		r->change[r->changes++] = r->next.origin;
	}
	r->now.counted.samples = (double)r->next.origin / separate_ratio(r->now.s);
	separate_continue(r->next.s, r->now.s, &r->now.counted,
		separate_too_many(r->now.doubted, r->now.tested));
	r->next.counted = r->now.counted;
	drop(&r->now);
	r->now = r->next;
	r->next = (struct stretch){ .s = NULL };
	r->before = r->section;
	return release(r, r->now.settled);
}

/* 1 if the next stretch has as many rows that are not doubted as there are among the rows
 * held back that arrive before its last one. */
static int is_as_good(const struct renewal *r)
{
	const struct stretch *t = &r->next;
	long more = 0;

	for (size_t i = 0; i < t->rows; i++)
		more += doubts(&t->row[i]) == 0;
	for (size_t i = 0; i < r->now.rows && t->rows > 0; i++)
		more -= doubts(&r->now.row[i]) == 0 &&
			r->now.row[i].t1 <= t->row[t->rows - 1].t1;
	return more >= 0;
}

/* Judges the next stretch by its rows, once they tell; *again: 1 if this has changed
 * anything. */
static enum separate_status judge(struct renewal *r, int *again)
{
	struct stretch *t = &r->next;
	size_t learn = half_of(r, t);
	long long origin = t->origin;

	*again = 0;
	while (!(is_ready(t) && fabs(t->sum) >= log(CERTAIN)) && !t->ended &&
		!is_unlearned(t) && separate_spent(t->s) < work_left(r)) {
		if (!feed(r, t))
			return SEPARATE_OK;
		if (take_rows(r, t) != SEPARATE_OK)
			return SEPARATE_MEMORY;
	}
	*again = 1;
	if (t->status == SEPARATE_MEMORY)
		return SEPARATE_MEMORY;
	if (t->sum <= -log(CERTAIN) && is_described(t) && is_as_good(r))
		return renew(r);
	r->spent += separate_spent(t->s);
	drop(t);
	if (origin >= r->from && work_left(r) > 0 && learn >= r->now.learn / LEAST_PART &&
		learn >= SEPARATE_SHORTEST)
		return begin(r, t, origin, learn) ? SEPARATE_OK : SEPARATE_MEMORY;
	r->retry = 2 * r->upto;
	return release(r, r->now.rows);
}

static enum separate_status work(struct renewal *r)
{
	int again = 1;
	enum separate_status status;

	while (again) {
		again = 0;
		status = r->next.s ? judge(r, &again) : SEPARATE_OK;
		if (status != SEPARATE_OK)
			return status;
		if (!again && feed(r, &r->now))
			again = 1;
		status = take_rows(r, &r->now);
		if (status == SEPARATE_OK)
			status = look(r);
		if (status != SEPARATE_OK)
			return status;
		again = again || (r->next.s && r->ended);
		count(&r->now);
		if (r->now.ended && !r->next.s && r->now.status != SEPARATE_OK &&
			!r->ended)
			return r->now.status;
	}
	return SEPARATE_OK;
}

/* Forgets what is older than twice as much as is learned from. */
static void forget(struct renewal *r)
{
	long long kept = 2 * (long long)(r->par.learn ? r->par.learn : SEPARATE_LEARN);
	long long from = r->now.fed;

	if (r->next.s && r->next.fed < from)
		from = r->next.fed;
	if (r->upto - kept < from)
		from = r->upto - kept;
	if (from - r->from < kept / 2)
		return;
	memmove(r->raw, r->raw + r->channels * (from - r->from),
		(size_t)(r->channels * (r->upto - from)) * sizeof *r->raw);
	r->from = from;
}

enum separate_status renewal_push(struct renewal *r, const double *x, size_t n)
{
	size_t channels = (size_t)r->channels, have = (size_t)(r->upto - r->from);
	enum separate_status status;

	if (r->only) {
		r->upto += (long long)n;
		r->now.status = separate_push(r->now.s, x, n);
		return r->now.status;
	}
	if (room_for(&r->raw, &r->raw_room, channels * (have + n), sizeof *r->raw))
		return SEPARATE_MEMORY;
	memcpy(r->raw + channels * have, x, channels * n * sizeof *x);
	r->upto += (long long)n;
	status = work(r);
	forget(r);
	return status;
}

enum separate_status renewal_end(struct renewal *r)
{
	enum separate_status status;

	r->ended = 1;
	if (r->only)
		return separate_end(r->now.s);
	status = work(r);
	if (status == SEPARATE_OK)
		status = release(r, r->now.rows);
	return status == SEPARATE_OK ? r->now.status : status;
}

int renewal_next(struct renewal *r, struct transit *p)
{
	if (r->only)
		return separate_next(r->now.s, p);
	if (r->given == r->rows) {
		r->given = r->rows = 0;
		return 0;
	}
	*p = r->row[r->given++];
	return 1;
}
