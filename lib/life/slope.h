/* slope.h - slope of a straight line by least squares, point by point
 *
 *	struct slope s = { 0 };
 *	slope_add(&s, t, y);
 *	rate = slope_get(&s);
 */
#ifndef LIFE_SLOPE_H
#define LIFE_SLOPE_H

struct slope {
	long n;
	double mean_t, mean_y, tt, ty;
};

void slope_add(struct slope *s, double t, double y);
double slope_get(const struct slope *s); /* not finite without two different t */

#endif
