/* parabola.h - the top of a parabola through three values */
#ifndef NUM_PARABOLA_H
#define NUM_PARABOLA_H

/* Place of the maximum of the parabola through three values at -1, 0 and 1; 0 where it
 * has none. */
static inline double parabola_top(double before, double at, double after)
{
	double bend = before - 2 * at + after;

	return bend < 0 ? 0.5 * (before - after) / bend : 0;
}

#endif
