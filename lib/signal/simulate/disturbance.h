/* disturbance.h - events in the record of two sensors that are no particles
 *
 * Each kind is a Poisson process.  In units of T, the duration of a pulse at mean
 * velocity, and of the given level:
 *
 *	bubble     (1 + cos(2 pi s)) / 2, |s| < 1/2, 1.5 to 3 T long, at sensor 2 later by
 *	           the transit time of the oil: a single lobe of either sign
 *	shock      a sine of 1 to 3 periods in T that decays with T, at both sensors at
 *	           once, weaker by up to 30 % at one of them
 *
 *	impulse    a spike of one sample at one sensor or both, up to five times the level
 *
 *	transient  a step that decays with T/2 to 3 T, at one sensor
 *
 *	dropout    both channels read 0 for 0.5 to 4 T
 *
 * Levels are uniform from 0.4 to 1.6 of the one given; event k of a kind depends on seed,
 * realisation, kind and k alone.
 */
#ifndef SIGNAL_DISTURBANCE_H
#define SIGNAL_DISTURBANCE_H

#include <stdint.h>

enum disturbance_kind {
	DISTURBANCE_BUBBLE,
	DISTURBANCE_SHOCK,
	DISTURBANCE_IMPULSE,
	DISTURBANCE_TRANSIENT,
	DISTURBANCE_DROPOUT,
	DISTURBANCES
};

/* "bubble", "shock", ... */
extern const char *const disturbance_names[DISTURBANCES];

struct disturbance {
	enum disturbance_kind kind;
	double time[2]; /* middle of a bubble, else the beginning, at either sensor, s */
	double begin, end; /* of its trace at either sensor, s */
	double level[2];   /* V */
	double duration;   /* of the bubble, impulse or dropout; time constant, s */
	double frequency;  /* of the shock, Hz */
};

struct disturbances_par {
	uint64_t seed;
	uint32_t realisation;
	double rate[DISTURBANCES]; /* events per second; 0: none */
	double level;              /* V */
	double duration;           /* T, s */
	double transit;            /* from sensor to sensor with the oil, s */
	double sample;             /* s */
};

struct disturbances;

/* NULL when out of memory. */
struct disturbances *disturbances_new(const struct disturbances_par *par);
void disturbances_free(struct disturbances *d);
/* The next event by time[0]; 0 if there is none of any kind. */
int disturbances_next(struct disturbances *d, struct disturbance *event);

/* What it adds to a channel (0, 1) at time t; 0 for a dropout. */
double disturbance_value(const struct disturbance *event, int sensor, double t);

#endif
