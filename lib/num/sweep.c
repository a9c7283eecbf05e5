#include "num/sweep.h"
#include <math.h>

enum { CHUNK_MIN = 2048 };

struct task {
	size_t n, chunk;
	void (*pass)(void *context, size_t begin, size_t end, struct sweep *s);
	void *context;
	struct sweep part[SWEEP_CHUNKS];
};

static void run_chunk(void *context, size_t i, int worker)
{
	struct task *t = context;
	size_t begin = i * t->chunk, end = begin + t->chunk;

	(void)worker;
	t->part[i] = (struct sweep){ .max = -INFINITY };
	t->pass(t->context, begin, end < t->n ? end : t->n, &t->part[i]);
}

struct sweep sweep_run(struct pool *pool, size_t n,
	void (*pass)(void *context, size_t begin, size_t end, struct sweep *s),
	void *context)
{
	struct task t = { .n = n, .pass = pass, .context = context };
	struct sweep all = { .max = -INFINITY };
	size_t chunks;

	t.chunk = (n + SWEEP_CHUNKS - 1) / SWEEP_CHUNKS;
	if (t.chunk < CHUNK_MIN)
		t.chunk = CHUNK_MIN;
	chunks = (n + t.chunk - 1) / t.chunk;
	pool_run(pool, chunks, run_chunk, &t);
	for (size_t i = 0; i < chunks; i++) {
		for (int k = 0; k < SWEEP_SUMS; k++)
			all.sum[k] += t.part[i].sum[k];
		if (t.part[i].max > all.max)
			all.max = t.part[i].max;
	}
	return all;
}
