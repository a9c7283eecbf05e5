/* match.h - probability that the pulses of a particle at successive coils are matched
 *
 * A pulse is matched from each position to the next, within the range of the traffic: at
 * the second coil also within the prediction by the duration of the first pulse if that
 * is used, and at later coils within that by the coils so far.  Range and prediction
 * extend three standard errors to either side: two particles of equal velocity whose
 * arrivals differ by less cannot be told apart.
 *
 * The match is unambiguous if no other particle is in any window.  With arrivals as a
 * Poisson process, and A the time at the first coil during which another particle would
 * get into one of the windows, the mean over the other particles,
 *
 *	p = E exp(-arrivals A),
 *
 * the mean over the particle's own velocity and errors.  A is the width of the window
 * where there is one.  Several windows move against each other with the velocity
 * and the errors of the other particle; both means are then taken over points that fill
 * the unit cube evenly.
 */
#ifndef LAYOUT_MATCH_H
#define LAYOUT_MATCH_H

#include "layout/bound.h"
#include "layout/traffic.h"

struct layout_par {
	struct bound_par bound;
	struct traffic traffic;
};

/* Particles: for 100 random layouts of 2 to 6 coils (1 to 1000 particles per second, 0 to
 * 40 dB, all profiles) the probabilities by widths with 256 and 512, and with 512 and
 * 1024, differ by .0005 and .0002 rms, .003 and .001 at most from those with 2048 and
 * 8192. */
enum { LAYOUT_COILS = 16, MATCH_OWN = 256, MATCH_OTHERS = 512 };

struct match {
	const struct layout_par *par; /* borrowed */
	int coils;
	/* Standard errors at one coil, of the arrival, s, and of the slowness, s/m. */
	double time_error, width_error;
	double fastest, slowest; /* slowness of the window of the traffic */
	/* Slowness of particles, s/m; errors in standard errors, at each coil. */
	double own[MATCH_OWN], own_time[MATCH_OWN][LAYOUT_COILS],
		own_width[MATCH_OWN][LAYOUT_COILS];
	double other[MATCH_OTHERS], other_time[MATCH_OTHERS][LAYOUT_COILS];
};

void match_begin(struct match *m, const struct layout_par *par, int coils);

/* Of coils in ascending order; by_width: the width of the first pulse is used. */
double match_unique(const struct match *m, const double *coil, int by_width);

/* Whether the probability by widths is not below this. */
int match_reaches(const struct match *m, const double *coil, double least);

#endif
