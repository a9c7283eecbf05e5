/* outputs.h - what duet found, and the tables and signals it goes to */
#ifndef OUTPUTS_H
#define OUTPUTS_H

#include "io/signals.h"
#include "io/tables.h"
#include "signal/detect/count.h"
#include "signal/separate/separate.h"

struct found {
	/* files, NULL: not wanted */
	const char *separated, *histogram, *sections, *detectable;
	double spacing, kappa; /* m, V s/m4 */
	double rate;
	int components;       /* 1: the record has two of either sensor (components.h) */
	long count;           /* particles so far */
	double largest;       /* amplitude of one that was resolved, V */
	long phases, strange; /* resolved ones with a phase, and with one of no material
			       */
	struct table_out *particles, *section_rows, *weights, *limits;
	struct signal_out *sources;
	long long drawn; /* frames of separated signals written */
	double *frames;  /* of the separated signals, from frame drawn on */
	size_t held;
};

/* Opens what is wanted; the fields down to kappa are the caller's. */
void found_open(struct found *out, const struct signal_format *format, const char *cmd);
void found_particle(struct found *out, const struct transit *p);
/* A peak of one sensor, 1 or 2; delay: of the mean particle, s, nan if unknown. */
void found_peak(struct found *out, const struct peak *p, int sensor, double delay);
/* separate_par.on_section, with a struct found for its context. */
void found_section(void *context, const struct separate_section *s);
/* The table of what can be detected; NULL: nothing was learned. */
/* ratio: see separate.h */
void found_detectable(struct found *out, const struct calibration *c, int ratio);
/* Every table says that it is doubtful, since the exit status is lost in a pipe. */
void found_doubt(struct found *out, const char *why);
void found_close(struct found *out);

#endif
