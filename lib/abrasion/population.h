/* population.h - the particles of an oil of known cleanliness code
 *
 * The number of particles larger than d per volume, N(d), is known at three diameters;
 * between them and beyond the last ln N is linear in ln d.  Particles smaller than the
 * first size are not specified and are left out; there are none larger than largest.
 *
 *	struct population p = { { 4e-6, 6e-6, 14e-6 }, { 2.5e9, 6.4e8, 8e7 }, 70e-6 };
 *	population_draw(&p, volume, 1e-6, seed, 0, &list, &n);
 */
#ifndef ABRASION_POPULATION_H
#define ABRASION_POPULATION_H

#include "abrasion/particle.h"
#include "num/status.h"
#include <stddef.h>
#include <stdint.h>

struct population {
	double diameter[3]; /* ascending, m */
	double number[3];   /* per m3, descending, above 0 */
	double largest;     /* m */
};

/* N(d), for d at or above the first diameter; 0 from largest on. */
double population_larger(const struct population *p, double d);

/* Diameter at which N is n, for n in (0, number[0] - N of the particles left out]. */
double population_diameter(const struct population *p, double n);

/* Particles above least in a volume at random, the largest first: a Poisson process
 * in N.  Fresh memory in *list.  NUM_DOMAIN beyond most particles. */
enum num_status population_draw(const struct population *p, double volume, double least,
	uint64_t seed, uint32_t realisation, size_t most, double **list, size_t *n);

/* Mean effect of the particles in the gap: spheres with the concentration of the oil. */
struct population_mean {
	double pressure;   /* that they carry, Pa */
	double section[2]; /* of their grooves, per area: depth grooved per length slid */
	double undescribed; /* particles per area that yield or are buried, 1/m2 */
};

/* From n classes of equal width in ln d. */
void population_mean(const struct population *p, const struct abrasion_par *par, size_t n,
	struct population_mean *m);

/* The widest gap at which they carry a pressure, as abrasion_widest() finds it.  The gap
 * of par is not used. */
double population_gap(const struct population *p, const struct abrasion_par *par,
	double pressure, size_t n, double *carried);

#endif
