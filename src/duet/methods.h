/* methods.h - the ways of duet from a record to the particles found in it */
#ifndef METHODS_H
#define METHODS_H

#include "outputs.h"

/* Sections, each taken apart by fit or masks; with the instrument kept in a file (NULL:
 * none), which is written if it is not there. */
int separate_record(struct signal_in *in, struct found *out,
	const struct separate_par *par, const char *file);

struct count_par {
	int sensor;   /* 1 or 2 */
	double floor; /* lowest peak, V; nan: from the first samples */
	double delay; /* of the mean particle, s; nan: unknown */
	size_t learn; /* samples the floor is made of */
};

/* Peaks of one channel. */
void count_record(struct signal_in *in, struct found *out, const struct count_par *par);

#endif
