/* groups.h - the counts of one period, separately for each value of a column, and their
 * reports
 */
#ifndef GROUPS_H
#define GROUPS_H

#include "reports.h"

struct groups;

struct groups *groups_new(const struct report_par *par);
/* Adds a particle or an unresolved section to the group of this name, see classes.h. */
void groups_add(struct groups *g, const char *name, double diameter, int sure);
void groups_add_stretch(struct groups *g, const char *name, const struct stretch *s);
/* Prints the rows of a period of all groups, and begins the next. */
void groups_report(struct groups *g, double begin, double end, int whole);
/* End of the period that begins now; infinite without --period. */
double groups_next(const struct groups *g);
/* The periods that are left, up to the end of the record, which is duration, the last
 * whole period, or the last particle. */
void groups_finish(struct groups *g, double last);
/* The table says it too, since the exit status is lost in a pipe. */
void groups_doubtful(struct groups *g, const char *why);
int groups_status(const struct groups *g); /* 0, or 3 where something was doubtful */
int groups_alarm(const struct groups *g);  /* 1 if an alarm is active */
void groups_free(struct groups *g);

#endif
