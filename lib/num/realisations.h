/* realisations.h - the rows of an ensemble, grouped by realisation
 *
 * Rows may be in any order as long as they fit in memory; in longer tables the rows of a
 * realisation must be contiguous, or at least no further apart than the room.  Memory
 * does not grow with the number of rows.
 *
 *	struct realisations *r = realisations_new(REALISATIONS_ROOM, take, &sums);
 *	realisations_add(r, &cell);
 *	...
 *	realisations_end(r);
 *	realisations_free(r);
 */
#ifndef NUM_REALISATIONS_H
#define NUM_REALISATIONS_H

#include "num/status.h"
#include <stddef.h>

enum { REALISATIONS_ROOM = 1 << 20 }; /* cells: 48 MB */

/* The wear of one realisation in one step; SI units. */
struct realisation_cell {
	long realisation, step;
	long part; /* of the table */
	double volume, count, large;
};

enum realisations_status {
	REALISATIONS_OK,
	REALISATIONS_MEMORY,
	REALISATIONS_AGAIN, /* a realisation occurs again after it was passed on */
	REALISATIONS_STOP   /* take did not return NUM_OK */
};

/* Receives all cells of a realisation by ascending step; a step whose rows were not
 * consecutive has several.  Any status but NUM_OK stops the reading. */
typedef enum num_status realisations_take(
	void *to, const struct realisation_cell *cell, size_t n);

struct realisations;

/* room: cells kept before realisations are passed on; NULL when out of memory. */
struct realisations *realisations_new(size_t room, realisations_take *take, void *to);
void realisations_free(struct realisations *r);

/* Consecutive rows of the same realisation, step and part are summed. */
enum realisations_status realisations_add(
	struct realisations *r, const struct realisation_cell *row);
/* Passes on the remaining realisations; call once, after the last row. */
enum realisations_status realisations_end(struct realisations *r);
/* The realisation that REALISATIONS_AGAIN or REALISATIONS_STOP refers to. */
long realisations_culprit(const struct realisations *r);

#endif
