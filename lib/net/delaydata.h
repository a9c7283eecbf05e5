/* delaydata.h - the simulated sections with which the thesis trains its delay networks
 *
 * "Each of the particles is described as a sine section with period from pi/2 to 3pi/2.
 * The sine sections with random amplitude and phase are superimposed to be the first
 * aliasing signal.  Modify the amplitude and phase of each sine sections and add them
 * together to get the second" (3.3.1), 500 points each, three sources.  This leaves much
 * open; each choice is a member of the struct, and the defaults of delaynet(1) are one
 * interpretation. Only that the delays are uniform in (0, 1) follows from the levels of
 * the printed scores.
 *
 * A source is s(x) = A w((x - x0)), with x running over [0, span); the second channel is
 * g s(x - unit * delay), delay uniform in (0, 1).  The labels are the delays.
 */
#ifndef NET_DELAYDATA_H
#define NET_DELAYDATA_H

#include "net/network.h"

/* The interpretation of "sine section with period from pi/2 to 3pi/2". */
enum delaydata_section {
	DELAYDATA_LENGTH, /* sin(u) for 0 <= u < a length drawn from the range */
	DELAYDATA_PERIOD, /* one whole period, of a length drawn from the range */
	DELAYDATA_RANGE   /* sin(u) for u from the lower to the upper end of the range */
};

enum delaydata_order {
	DELAYDATA_DRAWN,   /* as the sources were drawn: exchangeable */
	DELAYDATA_ARRIVAL, /* by the beginning of the source in the first channel */
	DELAYDATA_SORTED   /* by size of the delay */
};

struct delaydata_par {
	int points;  /* per channel */
	int sources; /* at most DELAYS_MAX */
	double span; /* of x, rad */
	enum delaydata_section section;
	double length[2];    /* rad */
	int endless;         /* 1: the sine continues outside its section */
	double amplitude[2]; /* A, uniform */
	double gain[2];      /* g, uniform, per source */
	double unit;         /* of the delays, rad */
	enum delaydata_order order;
	int scaled;   /* 1: both channels over the largest |x| of the first */
	double noise; /* standard deviation of white noise on both channels */
	uint64_t seed;
};

/* Sample i of the set: x[2 * points] (first channel, then second) and delay[sources].
 * Stream (seed, i, RNG_NETWORK); the noise uses separate random numbers, so that a noisy
 * set is the clean one plus noise. */
void delaydata_sample(const struct delaydata_par *par, uint32_t i, network_real *x,
	network_real *delay);

#endif
