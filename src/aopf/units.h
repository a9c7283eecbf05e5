/* units.h - the units of a stream and what is kept of each between its rows; on disk too
 *
 * The file of a saved state has two places for each unit, which are written in turn, with
 * a checksum: whatever stops the program, one of them is whole.
 */
#ifndef UNITS_H
#define UNITS_H

#include "remaining_life.h"

struct machine;
struct units;

/* bare: without filters. */
struct units *units_new(int bare);
void units_free(struct units *units); /* counts the work done, too */
/* The unit with this number in the input, a new one where it is not known yet. */
struct machine *units_find(struct units *units, int number, const char *name);

int unit_number(const struct machine *u);
/* 0 if the row is not after the last one of a resumed unit.  Dies if it contradicts the
 * last one; from: the table of the row. */
int unit_takes(
	struct machine *u, const struct outlook_row *in, const struct table_in *from);
/* Fills the cells of a row; different units may step at the same time. */
void unit_step(struct machine *u, const struct outlook_row *in, double *cell);
int unit_cells(int bare);
/* After the last row: warns and returns 1 if events or saved states were of no use. */
int units_report(const struct units *units);
int units_alarm(const struct units *units); /* 1: one is active */

/* options: those that shape the state; a file made with others, or with
 * another fleet, is refused. */
void units_resume(struct units *units, const char *path, const char *options);
void units_keep(struct units *units, const char *path, const char *options);
/* Writes the state of a unit where units_keep() said. */
void unit_save(struct units *units, struct machine *u);

#endif
