#include "num/sweep.h"
#include <math.h>

/* 256 to 65536 terms take the same CPU time, with one and two threads: jobs cost little.
 */
enum { CHUNK_MIN = 2048 };

struct task {
	size_t n, chunk;
	void (*pass)(void *context, size_t begin, size_t end, struct sweep *s);
	void *context;
	struct sweep part[SWEEP_CHUNKS];
};

struct sweep sweep_start(void)
{
	return (struct sweep){ .max = -INFINITY, .min = INFINITY };
}

void sweep_add(struct sweep *all, const struct sweep *part)
{
	for (int k = 0; k < SWEEP_SUMS; k++)
		all->sum[k] += part->sum[k];
	all->max = part->max > all->max ? part->max : all->max;
	all->min = part->min < all->min ? part->min : all->min;
}

static void run_chunk(void *context, size_t i, int worker)
{
	struct task *t = context;
	size_t begin = i * t->chunk, end = begin + t->chunk;

	(void)worker;
	t->part[i] = sweep_start();
	t->pass(t->context, begin, end < t->n ? end : t->n, &t->part[i]);
}

static size_t chunk_size(size_t n)
{
	size_t chunk = (n + SWEEP_CHUNKS - 1) / SWEEP_CHUNKS;

	return chunk < CHUNK_MIN ? CHUNK_MIN : chunk;
}

double sweep_terms(size_t n)
{
	return (double)chunk_size(n) + SWEEP_CHUNKS;
}

struct sweep sweep_run(struct pool *pool, size_t n,
	void (*pass)(void *context, size_t begin, size_t end, struct sweep *s),
	void *context)
{
	struct task t = { .n = n, .pass = pass, .context = context };
	struct sweep all = sweep_start();
	size_t chunks;

	t.chunk = chunk_size(n);
	chunks = (n + t.chunk - 1) / t.chunk;
	pool_run(pool, chunks, run_chunk, &t);
	for (size_t i = 0; i < chunks; i++)
		sweep_add(&all, &t.part[i]);
	return all;
}
