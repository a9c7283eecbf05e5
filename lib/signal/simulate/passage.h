/* passage.h - random particles and the times at which they pass the sensors
 *
 * Arrivals come in bursts of a given number of particles, burst b within
 * [start + b period, start + b period + span], at random but never closer than gap; a
 * span of (burst - 1) gap leaves no freedom and puts them exactly gap apart.  Without
 * bursts all particles share one window.  Or they come as a Poisson process of a given
 * rate with gap as dead time, until the window is over.
 *
 * The numbers of particle i depend only on (seed, realisation, i) and on the arrival
 * before it.  SI units.
 */
#ifndef SIGNAL_PASSAGE_H
#define SIGNAL_PASSAGE_H

#include "signal/pulse/sensor.h"
#include <stdint.h>

struct arrivals_par {
	uint64_t seed;
	uint32_t realisation;
	double rate;     /* mean particles per second; 0: number of them is given */
	uint64_t number; /* particles in all; UINT64_MAX: no end */
	uint64_t burst;  /* particles of a burst; 0: all are one */
	double start;    /* s */
	double period;   /* from burst to burst, s */
	double span;     /* s */
	double gap;      /* least time between neighbours, s */
};

struct arrivals;

/* NULL when out of memory. */
struct arrivals *arrivals_new(const struct arrivals_par *par);
/* The next time, never before the last one; 0 when there are no more. */
int arrivals_next(struct arrivals *arrivals, double *time);
void arrivals_free(struct arrivals *arrivals);

/* One particle on its way past both sensors. */
struct passage {
	double time[2];  /* at the centre of each sensor, s */
	double diameter; /* m */
	double radius;   /* distance from the axis of the pipe, m; NAN unknown */
	double velocity; /* m/s */
	/* Of its pulse over kappa v d^3, in phase with that of a ferrous particle and a
	 * quarter of a turn ahead; see material.h.  passage_carry() makes them 1,
	 * 0. */
	double response[2];
};

/* Distribution of the particles. */
struct stream {
	uint64_t seed;
	uint32_t realisation;
	struct pipe pipe;
	double spacing;     /* between the sensors, m */
	double lag[2];      /* range of the transit time beyond that of the oil, s */
	double diameter[2]; /* range, m */
	int by_volume;      /* 1: uniform in volume, 0: in diameter */
};

/* Smallest distance of a centre from the wall: its radius, but at least 1 % of the
 * pipe's.
 */
double passage_clearance(const struct stream *stream, double diameter);
/* Slowest velocity that passage_draw() and passage_carry() can give. */
double passage_slowest(const struct stream *stream);

/* Draws diameter, radius and velocity of particle index; time[0] is given, time[1]
 * follows. */
void passage_draw(const struct stream *stream, uint64_t index, struct passage *p);
/* The same for a given diameter. */
void passage_carry(const struct stream *stream, uint64_t index, struct passage *p);

#endif
