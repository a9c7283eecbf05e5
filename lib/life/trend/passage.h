/* passage.h - times at which the trends of a bank first reach a level
 *
 * Each draw selects a trend or particle by its weight, draws level, rate and noise from
 * their Student-t distribution, and computes the first passage of the level: exact for a
 * straight line, an inverse Gaussian time if the damage is a Wiener process.
 * Beyond the damage that has been reached, the wear may stray from a curved coordinate
 * or a growth of the rate, unless the trends disagree as much already.
 *
 * The regime may change once more: after a time J with P(J > x) = (a / (a + x))^c, where
 * a is its age (an old one lasts long), the rate begins to grow as e^{g (t - J)}, or
 * drops and stays at the lower value; one that grows can only drop.  After k changes, a
 * is no more than the age of the unit over 1 + k, and g is in units of the reciprocal of
 * that: where the rate has often changed, it will do so again, as soon and as fast.
 * Hazard, growth and share of drops depend on whether the rate at present falls, is
 * constant or rises in the coordinate.
 *
 * After k > 1 repairs others will come, on average one in the age of the unit over k - 1,
 * and each takes back as much damage as those so far did.
 *
 * Rows held back as outliers may be the beginning of a new regime, and are the more
 * probably so the more there are: this share of the draws, an eighth for each row (see
 * "Rows held back" in doc/trends.md), is of a copy of the bank that has accepted
 * them.  It falls with the jump j to them, in units of the distance from D = 0 to the
 * threshold, as 1 / (1 + j^2)^2.  From eight on it is n / (n + 1), since none of n rows
 * has ended it (Laplace's rule of succession).  After three rows running on the healthy
 * side, a repair, all are.
 *
 *	struct bank_chances *chances = bank_chances_new(500, seed);
 *	bank_draw(b, chances, now, level, life);
 */
#ifndef LIFE_PASSAGE_H
#define LIFE_PASSAGE_H

#include "life/trend/bank.h"
#include "num/status.h"

struct bank_chances; /* random numbers, shared by all units of a run */

struct bank_chances *bank_chances_new(int draws, uint64_t seed); /* NULL: no memory */
void bank_chances_free(struct bank_chances *chances);
/* Normal deviate k < 8 of a draw. */
double bank_chance_normal(const struct bank_chances *chances, int draw, int k);

/* Makes all draws of the time from now (>= the last t) to the first passage of the
 * level, unsorted; INFINITY: never.  With the same chances at every row the results
 * change smoothly from row to row. */
enum num_status bank_draw(const struct bank *b, const struct bank_chances *chances,
	double now, double level, double *life);

/* 1 if the damage nearly certainly does not grow in trends with 95 % of the weight, after
 * the rows held back if they are probably a new regime. */
int bank_recedes(const struct bank *b);

#endif
