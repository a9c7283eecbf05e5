/* pool.h - a pool of threads whose results do not depend on how many there are
 *
 * Work is divided into jobs that depend only on the size of the problem; each job writes
 * to its own memory. Sums are computed per chunk and added in the order of the chunks.
 */
#ifndef NUM_POOL_H
#define NUM_POOL_H

#include <stddef.h>

struct pool;

/* threads >= 1; NULL with errno when threads cannot be created.  A pool of 1 starts none.
 */
struct pool *pool_new(int threads);
void pool_free(struct pool *pool);
int pool_threads(const struct pool *pool); /* 1 for NULL */

/* Calls job(context, i, worker) for i in [0, njobs), njobs < 2^32, in any order, and
 * returns when all are done.  worker in [0, threads) picks scratch memory.  pool NULL: in
 * place. */
void pool_run(struct pool *pool, size_t njobs,
	void (*job)(void *context, size_t i, int worker), void *context);

#endif
