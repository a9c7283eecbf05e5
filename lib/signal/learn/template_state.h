/* template_state.h - the search for the pulse of a record: its events are found, and the
 * pulse made of their mean, in template.c; which of them are alike, and their mean, in
 * template_alike.c
 */
#ifndef SIGNAL_TEMPLATE_STATE_H
#define SIGNAL_TEMPLATE_STATE_H

#include "signal/learn/template.h"

/* Power of an event, over that of the noise, from which on it is not alike because of its
 * noise.  With 1 a drifting baseline is taken for a pulse in a group of turbulent flow, 6
 * gives the same rows (nine records that differ in shape, noise and rate). */
static const double CLEAR = 3;

struct event {
	double centre, energy, length;
	double t[2], a[2]; /* arrival and amplitude, by channel */
	double merit;      /* large for the clearest */
	int like;          /* 1: of the kind that is averaged */
};

struct search {
	const double *y[2];
	const unsigned char *hidden[2]; /* flags of samples that are not known, or NULL */
	size_t n;
	double T, transit, reach, width;
	int q;             /* samples per point of the coarse grid */
	double *z[2];      /* coarse records, noise 1 */
	size_t points;     /* of them */
	int half;          /* of the template, samples */
	double *p;         /* 2 half + 1: the template */
	double *wide;      /* the same as sensor 2 has it, width times as long */
	double *coarse[2]; /* either on the coarse grid */
	int coarse_half;
	double scatter; /* standard error of a point of the template */
	struct event event[TEMPLATE_EVENTS];
	int count;
};

static inline int is_clear(const struct event *e)
{
	return e->energy > CLEAR * 2 * e->length;
}

/* --- template_alike.c --- */

/* Takes the template from one clear event, in the order of merit, by both channels; 0 if
 * there are not so many. */
int take_single(struct search *s, int number);
/* Takes it from the clear events that are alike; *one: 1 if there are any.  white: the
 * noise is, above the band of the pulses.  NUM_MEMORY. */
enum num_status take_common(struct search *s, int white, int *one);
/* x at t, by the cubic through the four samples around it. */
double value_between(const double *x, size_t n, double t);

#endif
