/* state.h - serialises an object to bytes of this machine and back
 *
 * One function of the object lists its members; the state determines whether they are
 * counted, written or read:
 *
 *	void order_pass(struct order *o, struct state *s)
 *	{
 *		state_move(s, &o->rows, sizeof o->rows);
 *		...
 *	}
 *
 *	struct state s = { 0 };              (counts: s.size bytes)
 *	s = (struct state){ .at = bytes };   (writes)
 *	s = (struct state){ .at = bytes, .load = 1 };
 */
#ifndef NUM_STATE_H
#define NUM_STATE_H

#include <stddef.h>
#include <string.h>

struct state {
	unsigned char *at; /* NULL: only count */
	int load;          /* 1: from there into the object */
	size_t size;       /* so far */
};

/* part may be NULL if the size is 0. */
static inline void state_move(struct state *s, void *part, size_t size)
{
	if (size == 0)
		return;
	if (s->at && s->load)
		memcpy(part, s->at + s->size, size);
	else if (s->at)
		memcpy(s->at + s->size, part, size);
	s->size += size;
}

/* Leaves out a stretch, of zeros. */
static inline void state_skip(struct state *s, size_t size)
{
	if (s->at && !s->load)
		memset(s->at + s->size, 0, size);
	s->size += size;
}

#endif
