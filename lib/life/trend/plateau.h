/* plateau.h - wear that has stopped, or a sensor at the end of its range
 *
 * The damage D of a series, from its beginning to its threshold, is kept as means over
 * equal numbers of rows.  It has stopped where the last of these means lie on a line
 * whose slope does not differ from 0 by two standard errors and, with three of them
 * added, is less than a tenth of the mean rate before.  A ceiling with noise behind it
 * and wear that rests are the same readings, and neither tells when failure will come.
 * Damage does not heal either: values that fall, or stay low after a fall, have stopped
 * where those before were on the way.  Outliers look like a fall, for a while.
 */
#ifndef LIFE_PLATEAU_H
#define LIFE_PLATEAU_H

enum { PLATEAU_BLOCKS = 48 }; /* means at most; then pairs are joined */

/* All zero at first. */
struct plateau {
	struct block {
		double t, y;
	} block[PLATEAU_BLOCKS], next; /* next: the sums of the next one so far */
	long each, rows;               /* rows of a block, of the next one so far */
	int n;
};

void plateau_add(struct plateau *p, double t, double y);
/* 1 if the values have approached the threshold, and have stopped short of it, on a line
 * that does not begin before since; clean: there are no outliers among them, so that a
 * fall counts. */
int plateau_reached(const struct plateau *p, double threshold, double since, int clean);

#endif
