/* study.h - a study of debrisstat: a table of wear particles, read into an ensemble
 *
 * Anything that is not such a table ends the program with one line that names file and
 * line.
 */
#ifndef STUDY_H
#define STUDY_H

#include "io/reasons.h"
#include "stats/ensemble.h"

struct study_par {
	struct ensemble_par ensemble;
	const char *summary; /* of debrisgen, which lists steps without particles; or NULL
			      */
	long last;           /* step that has to have taken place; 0: any */
	int alike; /* 1: parts of another nominal area or step distance are refused */
	/* Called for each particle; aspect is nan if it has no shape. */
	void (*row)(const struct particle_row *particle, double aspect);
};

struct study {
	struct ensemble *particles; /* closed */
	double area;                /* nominal, m2; nan: not known */
	double distance;            /* slid in a step, m; nan: not known */
	char *cmd;                  /* that made the table */
};

/* Reads the table of this file; adds the reasons for which it is doubtful to doubts. */
struct study study_read(
	const struct study_par *par, const char *path, struct reasons *doubts);
void study_free(struct study *study);

#endif
