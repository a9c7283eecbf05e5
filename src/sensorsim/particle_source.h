/* particle_source.h - the particles that come along: options of sensorsim
 *
 *	struct source *s = source_open(path, seed, realisation);
 *	while (source_next(s, &passage))
 *		...
 *	source_close(s);
 */
#ifndef PARTICLE_SOURCE_H
#define PARTICLE_SOURCE_H

#include "cli/opt.h"
#include "signal/simulate/passage.h"

/* Of the record, s; nan: until the last pulse is over. */
extern double source_duration;

extern struct opt source_rows[]; /* for OPT_TABLE */

/* Dies where options contradict one another, or a file was named (operands) but the
 * particles are to be drawn. */
void source_check(int operands);

struct source;

/* A table, NULL or "-": standard input; or random numbers. */
struct source *source_open(const char *path, uint64_t seed, uint32_t realisation);
/* The next particle in order of arrival whose pulse at sensor 1 begins before the record
 * ends; 0 if there is none. */
int source_next(struct source *s, struct passage *p);
uint64_t source_count(const struct source *s); /* particles so far, unseen ones too */
const char *source_material(const struct source *s); /* of the last one */
/* Velocity that none of them is below, m/s. */
double source_slowest(const struct source *s);
const char *source_cmd(const struct source *s); /* that made the table, or NULL */
/* Why its table is doubtful, or NULL: as far as it is read by now; and at the end, with a
 * warning. */
const char *source_doubt(struct source *s);
const char *source_doubted(struct source *s);
void source_close(struct source *s);

#endif
