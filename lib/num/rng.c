#include "num/rng.h"
#include <gsl/gsl_errno.h>
#include <stdint.h>

/* The counter's low words count blocks of four numbers; see philox.h. */
struct state {
	uint32_t counter[4], key[2];
	uint32_t block[4];
	int used; /* of block, 4: draw the next */
};

static void set_stream(
	struct state *s, uint64_t seed, uint32_t realisation, enum rng_purpose purpose)
{
	*s = (struct state){ .counter = { 0, 0, realisation, (uint32_t)purpose },
		.key = { (uint32_t)seed, (uint32_t)(seed >> 32) },
		.used = 4 };
}

static void set(void *state, unsigned long seed)
{
	set_stream(state, seed, 0, 0);
}

static uint32_t next(struct state *s)
{
	if (s->used == 4) {
		philox4x32(s->counter, s->key, s->block);
		if (++s->counter[0] == 0)
			s->counter[1]++;
		s->used = 0;
	}
	return s->block[s->used++];
}

static unsigned long get(void *state)
{
	return next(state);
}

static double get_double(void *state)
{
	uint64_t high = next(state), low = next(state);

	return (double)((high << 32 | low) >> 11) * 0x1p-53;
}

static const gsl_rng_type type = { "philox4x32-10", 0xffffffffUL, 0, sizeof(struct state),
	set, get, get_double };

gsl_rng *rng_new(uint64_t seed, uint32_t realisation, enum rng_purpose purpose)
{
	gsl_error_handler_t *handler = gsl_set_error_handler_off(); /* it aborts */
	gsl_rng *rng = gsl_rng_alloc(&type);

	gsl_set_error_handler(handler);
	if (rng)
		rng_reset(rng, seed, realisation, purpose);
	return rng;
}

void rng_reset(
	gsl_rng *rng, uint64_t seed, uint32_t realisation, enum rng_purpose purpose)
{
	set_stream(gsl_rng_state(rng), seed, realisation, purpose);
}
