/* classes.h - particles of one period sorted into classes of size
 *
 * A detected particle has the weight 1 over its probability of detection; unresolved
 * sections are described by the number and diameter of equal particles with the same
 * sums of d^6 and d^12 (of the second and fourth power of the pulses).  By Markov's
 * inequality no more than N min((d_eq / d)^6, (d_eq / d)^12) particles of the section
 * are larger than d, and their volume is at most that of N (d_eq / d)^6 of size d.
 *
 *	struct classes *c = classes_new(edges, n, &par);
 *	classes_add(c, d, 1);
 *	classes_count(c, k, &count);
 *	classes_clear(c);
 */
#ifndef COUNT_CLASSES_H
#define COUNT_CLASSES_H

#include "count/detection.h"

/* Diameters and edges are those by which the sensor detects a particle; size() gives that
 * of the sphere that it is, where the two differ, as for non-ferrous particles.  Its cube
 * grows no faster than the sixth power of its argument. */
struct classes_par {
	struct detection detection;
	double confidence;
	double (*size)(double diameter); /* or NULL */
};

/* A value and the limits of its interval; the sum of the squared weights of its particles
 * and the largest weight among them, and the largest one possible. */
struct counted {
	double value, low, high;
	double squares, largest, possible;
};

struct class_count {
	double sure, doubtful; /* rows */
	double unresolved;     /* equal particles of stretches, in their class */
	struct counted number; /* of particles, by weight */
	struct counted volume; /* of all of them, m3 */
};

struct classes;

/* n classes from edge[k] to edge[k + 1], the last without an upper limit.  NULL when out
 * of memory. */
struct classes *classes_new(const double *edge, int n, const struct classes_par *par);
void classes_free(struct classes *c);
void classes_clear(struct classes *c);

/* Adds a particle; doubtful ones count only for the upper limit. */
void classes_add(struct classes *c, double diameter, int sure);
/* Adds an unresolved section of equal particles; diameter NAN: unknown. */
void classes_add_stretch(struct classes *c, double number, double diameter);

/* Adds what may belong to c, too, such as particles of unknown material: it counts only
 * for the upper limit.  Both have the same classes. */
void classes_add_possible(struct classes *c, const struct classes *from);

/* Probability that the smallest particles of class k are detected. */
double classes_detection(const struct classes *c, int k);

/* Class k, or all particles of class k and above. */
void classes_count(const struct classes *c, int k, struct class_count *out);
void classes_count_above(const struct classes *c, int k, struct class_count *out);

#endif
