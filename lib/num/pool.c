#include "num/pool.h"
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>

struct worker {
	struct pool *pool;
	int number;
	pthread_t thread;
};

struct pool {
	int threads;            /* the caller's included */
	struct worker *workers; /* threads - 1 of them */
	pthread_mutex_t lock;
	pthread_cond_t start, finish;
	unsigned long round; /* counts calls of pool_run() */
	int running, quit;
	void (*job)(void *context, size_t i, int worker);
	void *context;
	size_t njobs, next;
};

/* Takes jobs until none is left; the lock is held on entry and exit. */
static void work(struct pool *p, int number)
{
	while (p->next < p->njobs) {
		size_t i = p->next++;

		pthread_mutex_unlock(&p->lock);
		p->job(p->context, i, number);
		pthread_mutex_lock(&p->lock);
	}
}

static void *serve(void *argument)
{
	struct worker *w = argument;
	struct pool *p = w->pool;
	unsigned long seen = 0;

	pthread_mutex_lock(&p->lock);
	for (;;) {
		while (p->round == seen && !p->quit)
			pthread_cond_wait(&p->start, &p->lock);
		if (p->quit)
			break;
		seen = p->round;
		work(p, w->number);
		if (--p->running == 0)
			pthread_cond_signal(&p->finish);
	}
	pthread_mutex_unlock(&p->lock);
	return NULL;
}

struct pool *pool_new(int threads)
{
	struct pool *p = calloc(1, sizeof *p);

	if (!p)
		return NULL;
	p->threads = 1;
	pthread_mutex_init(&p->lock, NULL);
	pthread_cond_init(&p->start, NULL);
	pthread_cond_init(&p->finish, NULL);
	p->workers = calloc((size_t)threads, sizeof *p->workers);
	for (int i = 1; p->workers && i < threads; i++) {
		struct worker *w = &p->workers[i - 1];
		int reason;

		w->pool = p;
		w->number = i;
		reason = pthread_create(&w->thread, NULL, serve, w);
		if (reason) {
			errno = reason;
			break;
		}
		p->threads++;
	}
	if (p->threads < threads) {
		pool_free(p);
		return NULL;
	}
	return p;
}

void pool_free(struct pool *p)
{
	if (!p)
		return;
	pthread_mutex_lock(&p->lock);
	p->quit = 1;
	pthread_cond_broadcast(&p->start);
	pthread_mutex_unlock(&p->lock);
	for (int i = 1; i < p->threads; i++)
		pthread_join(p->workers[i - 1].thread, NULL);
	pthread_mutex_destroy(&p->lock);
	pthread_cond_destroy(&p->start);
	pthread_cond_destroy(&p->finish);
	free(p->workers);
	free(p);
}

int pool_threads(const struct pool *p)
{
	return p ? p->threads : 1;
}

void pool_run(struct pool *p, size_t njobs,
	void (*job)(void *context, size_t i, int worker), void *context)
{
	if (pool_threads(p) == 1 || njobs < 2) {
		for (size_t i = 0; i < njobs; i++)
			job(context, i, 0);
		return;
	}
	pthread_mutex_lock(&p->lock);
	p->job = job;
	p->context = context;
	p->njobs = njobs;
	p->next = 0;
	p->running = p->threads - 1;
	p->round++;
	pthread_cond_broadcast(&p->start);
	work(p, 0);
	while (p->running > 0)
		pthread_cond_wait(&p->finish, &p->lock);
	pthread_mutex_unlock(&p->lock);
}
