/* blocks.c - see blocks.h */
#include "life/trend/blocks.h"

void blocks_add(struct blocks *b, int most, double t, double y)
{
	b->each = b->each > 0 ? b->each : 1;
	b->next.t += t / (double)b->each;
	b->next.y += y / (double)b->each;
	if (++b->rows < b->each)
		return;
	b->mean[b->n++] = b->next;
	b->next = (struct block){ 0, 0 };
	b->rows = 0;
	if (b->n < most)
		return;
	for (int k = 0; 2 * k < most; k++) {
		const struct block *pair = &b->mean[2 * k];

		b->mean[k] = (struct block){ 0.5 * pair[0].t + 0.5 * pair[1].t,
			0.5 * pair[0].y + 0.5 * pair[1].y };
	}
	b->n /= 2;
	b->each *= 2;
}
