/* moments.h - the states of surfaces that records or rows are of: two of one realisation
 * and step would count as one surface
 */
#ifndef COMMON_MOMENTS_H
#define COMMON_MOMENTS_H

#include <stddef.h>

struct moment {
	long realisation;
	double step; /* INFINITY: not known */
};

/* Of all records so far, ascending; at first { 0 }. */
struct moments {
	struct moment *of;
	size_t n, room;
};

/* Takes in a moment; 1 if it is there already.  Dies when out of memory. */
int moments_again(struct moments *m, struct moment next);

#endif
