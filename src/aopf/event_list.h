/* event_list.h - repairs and changes of load that aopf is told of: the table of --events
 */
#ifndef EVENT_LIST_H
#define EVENT_LIST_H

#include "io/reasons.h"
#include "life/trend/bank.h"

/* Reads the file; the column of this name, if there is one, tells the unit of an event,
 * which otherwise is of all.  Reasons for which the table is doubtful are added. */
void event_list_read(const char *file, const char *unit_column, struct reasons *doubts);
/* Number of the events of a unit after one time and up to another; last: time of the last
 * one of each kind, by enum bank_event, -INFINITY if there is none. */
unsigned long event_list_between(
	const char *unit, double after, double until, double last[BANK_LOAD + 1]);
/* At the end of a unit, which has heeded the events up to this time, of which those up to
 * early had no effect: the number of events it should have heeded. */
unsigned long event_list_settle(const char *unit, double heeded, double early);
/* After all units: warns and returns 1 if an event had no effect on any of them. */
int event_list_report(void);
void event_list_free(void);

#endif
