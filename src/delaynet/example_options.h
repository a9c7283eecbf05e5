/* example_options.h - what the networks of delaynet are trained and scored with: its
 * options */
#ifndef EXAMPLE_OPTIONS_H
#define EXAMPLE_OPTIONS_H

#include "cli/opt.h"
#include "net/lesson.h"
#include "net/netfile.h"

enum model { SINES, PULSES };
enum loss { ORDERED, SUMS, UNORDERED };
enum { FORWARD = 50 }; /* samples a network is given at a time */

/* Values of the options. */
extern struct lessons {
	int model, loss, penalty;
	double lambda;
	long seed, first, count, points, sources;
	/* sines */
	double span, unit, noise;
	int section, order, endless, scaled;
	struct opt_list length, amplitude, gain;
	/* pulses */
	int shape;
	double separation;
	struct opt_list snr, reach;
} lessons;

extern struct opt lessons_rows[]; /* for OPT_TABLE: those of the samples */

/* Dies where ranges make no sense. */
void lessons_check(void);
struct delaydata_par lessons_sines(void);
struct cnndata_par lessons_pulses(void);
struct delayloss_par lessons_loss(void);
struct lesson lessons_make(void);
/* lesson_keep() of all samples; dies where they are too many. */
void lessons_keep(struct lesson *l);
/* Reads a network that suits the lessons, NULL or "-": from standard input. */
struct network *lessons_network(const char *path, struct netfile *file);

#endif
