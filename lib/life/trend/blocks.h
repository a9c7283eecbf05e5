/* blocks.h - means over equal numbers of rows, a bounded number of them
 *
 * Once there are as many as fit, pairs are joined, and each has twice as many rows.
 *
 *	struct blocks b = { 0 };
 *	blocks_add(&b, 18, t, y);      (9 to 17 means from the ninth row on)
 */
#ifndef LIFE_BLOCKS_H
#define LIFE_BLOCKS_H

enum { BLOCKS = 48 }; /* at most */

/* All zero at first. */
struct blocks {
	struct block {
		double t, y;
	} mean[BLOCKS], next; /* next: the sums of the next one so far */
	long each, rows;      /* rows of a block, of the next one so far */
	int n;
};

/* most: at which pairs are joined, even and the same in all calls. */
void blocks_add(struct blocks *b, int most, double t, double y);

#endif
