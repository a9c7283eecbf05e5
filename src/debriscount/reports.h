/* reports.h - the tables that debriscount prints */
#ifndef REPORTS_H
#define REPORTS_H

#include "cli/opt.h"
#include "count/classes.h"
#include "count/codes.h"
#include <stddef.h>

extern struct opt oil_rows[], report_rows[]; /* for OPT_TABLE */

enum report_kind { REPORT_CLASSES, REPORT_CODES, REPORT_TREND };

struct report_par {
	enum report_kind output;
	struct classes_par classes;
	double edge[OPT_LIST_MAX];
	int edges;
	/* Of class non-ferrous: to the sensor, and of the sphere; or NULL. */
	double (*equivalent)(double size), (*size)(double equivalent);
	double period;       /* s; nan: the whole record */
	double duration;     /* s; nan: not known */
	double density;      /* of the particles, kg/m3; nan: no masses */
	double alarm, clear; /* levels, per hour */
	int alarm_mass;      /* of kg */
	const char *by;      /* column that identifies groups, or NULL */
	char *cmd;
};

/* Columns of a history: middle of each period, h; particles and kg per hour; the sums of
 * the squares of what each particle adds to them, and the largest of these; 1 if the
 * number has no upper limit. */
enum {
	TIME,
	RATE,
	SQUARES = RATE + 2,
	LARGEST = SQUARES + 2,
	UNKNOWN = LARGEST + 2,
	HISTORY
};

/* What is remembered of the periods of one group. */
struct rate_history {
	double *column[HISTORY];
	size_t n, room[HISTORY];
	int alarm;
};

struct report;

/* Dies where options contradict one another. */
void report_check(enum report_kind output, int periods);
struct report *report_open(const struct report_par *par);
/* Rows of one period of a group. */
void report_period(struct report *r, struct rate_history *h, const char *group,
	const struct classes *c, double begin, double end, int whole);
void report_doubt(struct report *r, const char *why);
void report_flush(struct report *r);
void report_close(struct report *r);
void rate_history_free(struct rate_history *h);

#endif
