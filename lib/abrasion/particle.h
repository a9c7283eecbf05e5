/* particle.h - a hard particle between two sliding surfaces
 *
 * A rigid sphere of diameter d in a gap h < d indents the two bodies by d - h, x into
 * body 1 and y into body 2, so that the loads on both sides are equal:
 *
 *	H1 c(x) = H2 c(y) = F / pi,   c(x) = d x - x^2 below d / 2, d^2 / 4 above,
 *
 * because pi c(x) is the area of the impression and the hardness of a body is the
 * pressure in it. On a body on which the particle slides, only its front half carries
 * load, and half of the hardness is used.  It is held by the softer body and slides on
 * the harder one, where the groove offers less resistance (H times its section; this
 * holds if no groove is deeper than the radius); if both are equally hard, it slides
 * half the distance on each.
 *
 * Its shape, a spheroid of aspect ratio k, determines whether it slides or rolls: when
 * it turns, the lines of action of the two normal forces are up to (k - 1/k) / 2 gaps
 * apart, and friction turns it only if this is below the coefficient.
 *
 * Fluid forces, elastic deflection, heat and fracture of the particle are left out.
 *
 *	struct abrasion_par par = { .gap = 9e-6, .hardness = { 2e9, 6e9 },
 *		.abrasive = INFINITY, .friction = 0.1, .inlet = INFINITY };
 *	struct abrasion a;
 *	abrasion_particle(&par, 10e-6, 1, &a);
 */
#ifndef ABRASION_PARTICLE_H
#define ABRASION_PARTICLE_H

enum abrasion_motion { ABRASION_BY_SHAPE, ABRASION_ALL_GROOVE, ABRASION_ALL_ROLL };

struct abrasion_par {
	double gap;         /* m */
	double hardness[2]; /* of the bodies, Pa */
	double abrasive;    /* hardness of the particle, Pa; INFINITY: rigid */
	double friction;    /* between particle and bodies */
	double inlet;       /* radius of the ball whose gap to a flat it is, m; INFINITY:
			       particles of any size enter */
	enum abrasion_motion motion;
};

enum abrasion_mode {
	ABRASION_FREE,     /* smaller than the gap */
	ABRASION_REJECTED, /* too large to be drawn into the inlet */
	ABRASION_ROLLS,
	ABRASION_GROOVES,
	ABRASION_EMBEDS, /* sinks into one body, too soft to mark the other */
	ABRASION_YIELDS, /* too soft to mark either: not described */
	ABRASION_BURIED, /* its groove is deeper than its radius: not described */
	ABRASION_MODES
};

struct abrasion {
	enum abrasion_mode mode;
	double load;       /* N; nan if the particle yields */
	double depth[2];   /* in either body, m; nan if the particle yields */
	double share[2];   /* of the distance slid over which it grooves either body */
	double groove[2];  /* depth of the grooves, m; of bodies of equal hardness it
			    * exceeds depth, the mean over the whole distance */
	double section[2]; /* volume of the grooves per length slid, m2; nan if not
			    * described */
};

/* A particle marks a body if it is this many times as hard (J. Tribol. 132, 034502). */
extern const double abrasion_harder;

void abrasion_particle(const struct abrasion_par *par, double diameter, double aspect,
	struct abrasion *a);

/* Depth in body 1 of a sphere of diameter d that two bodies of these hardnesses share
 * the depth d - gap of, 0 < gap < d; *load, unless NULL, is pi H1 c(x). */
double abrasion_squeeze(
	double d, double gap, double hardness1, double hardness2, double *load);

/* Section of the groove of a sphere of diameter d at a depth of at most d / 2, m2. */
double abrasion_section(double d, double depth);

/* The largest sphere that friction draws between a ball of radius R and a flat a gap h
 * apart: tan of half the angle between the surfaces equals the coefficient. */
double abrasion_largest(double friction, double radius, double gap);

/* The widest gap below the largest diameter at which they carry a load: in a narrower
 * one a particle that is not drawn in or no longer rolls carries less, and an oil has
 * fewer particles.  It is bracketed from above in steps, which end at the gaps that
 * admits, unless NULL, names below a given one, and then bisected; for 27 random
 * oils and pairs, steps of 0.9 to 0.99 lead to the gap of steps of 0.998.  *carried is
 * the load at this gap, which differs from the given one if the load jumps there.  NAN if
 * no gap carries it; *carried is the most they carry. */
double abrasion_widest(double (*carry)(void *all, double gap),
	double (*admits)(void *all, double high), void *all, double largest, double load,
	double *carried);

/* The same for n particles; aspect is NULL for spheres.  The gap of par is not used.
 * *evaluations counts particles. */
double abrasion_gap(const struct abrasion_par *par, const double *diameter,
	const double *aspect, long n, double load, double *carried, double *evaluations);

#endif
