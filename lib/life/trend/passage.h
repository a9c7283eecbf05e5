/* passage.h - times at which the trends of a bank first reach a level
 *
 * Each draw selects a trend or particle by its weight, draws level, rate and noise from
 * their Student-t distribution, and computes the first passage of the level: exact for a
 * straight line, an inverse Gaussian time if the damage is a Wiener process.
 * Beyond the damage that has been reached, the wear may stray from a curved coordinate
 * or a growth of the rate, unless the trends disagree as much already, and its rate may
 * swing as it has so far (unrest.h).
 *
 * Of the changes of regime and the repairs to come, and of the share of the draws that
 * take rows held back for a new regime, see aopf(1), Long-term models.
 *
 *	struct bank_chances *chances = bank_chances_new(500, seed);
 *	bank_draw(b, chances, now, level, life);
 */
#ifndef LIFE_PASSAGE_H
#define LIFE_PASSAGE_H

#include "life/trend/bank.h"
#include "num/status.h"
#include <stdint.h>

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
/* 1 if the damage has ceased to grow, or has fallen back, after these rows, see
 * plateau.h. */
int bank_ceased(const struct bank *b);

/* The probability that the damage is beyond the threshold, by the trends, which know
 * nothing of rows held back. */
double bank_beyond(const struct bank *b);

#endif
