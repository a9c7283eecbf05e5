/* classes.h - particles of one period sorted into classes of size
 *
 * A detected particle has the weight 1 over its probability of detection; unresolved
 * sections are described by the number and diameter of equal particles with the same
 * sums of d^6 and d^12 (of the second and fourth power of the pulses), and by bounds of
 * these: the sum of d^6 is at most most^6, and that of d^12 at most most^6 high^6.  By
 * Markov's inequality no more than (most / d)^6 min(1, (high / d)^6) particles of the
 * section, a whole number, are larger than d.
 *
 *	struct classes *c = classes_new(edges, n, &par);
 *	classes_add(c, d, 1);
 *	classes_count(c, k, &count);
 *	classes_clear(c);
 */
#ifndef COUNT_CLASSES_H
#define COUNT_CLASSES_H

#include "count/detection.h"

/* An unresolved section; NAN: unknown. */
struct stretch {
	double number, diameter; /* of equal particles */
	double most; /* that of one particle with the largest sum of d^6 possible */
	double high; /* upper limit of diameter, or NAN: most */
};

/* Diameters and edges are those by which the sensor detects a particle; size() gives that
 * of the sphere that it is, where the two differ, as for non-ferrous particles.  Its cube
 * is a concave function of the sixth power of its argument. */
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
void classes_add_stretch(struct classes *c, const struct stretch *s);

/* Adds what may belong to c, too, such as particles of unknown material: it counts only
 * for the upper limit.  Both have the same classes. */
void classes_add_possible(struct classes *c, const struct classes *from);

/* Probability that the smallest particles of class k are detected. */
double classes_detection(const struct classes *c, int k);

/* Class k, or all particles of class k and above. */
void classes_count(const struct classes *c, int k, struct class_count *out);
void classes_count_above(const struct classes *c, int k, struct class_count *out);

#endif
