/* bound.h - the Cramer-Rao bound of a particle measured by a row of coils
 *
 * Coil m at the position x_m along the pipe gives A p((t - t0 - x_m / v) / T) with
 * T = zone / v and p of signal/sensor.h, in white noise of the same rms on every coil.
 * Arrival, velocity v and amplitude A are unknown, the shape is known.  With the energies
 *
 *	E0 = int p^2 ds,  E1 = int p'^2 ds,  E2 = int s^2 p'^2 ds  and  n = rate T
 *
 * the integral of the Fisher matrix over time gives, with S = sum (x_m - mean)^2,
 *
 *	(v / sd(v))^2 = snr^2 n (E1 S / zone^2 + M (E2 - E0 / 4))
 *
 * and for the sine E1 = 2 pi^2, E2 - E0 / 4 = pi^2 / 6 + 1/8.  The duration of a single
 * pulse also determines the velocity.  No unbiased estimate has smaller standard errors.
 *
 *	struct bound_par par = { .shape = PULSE_SINE, .zone = 0.1273, .velocity = 12.73,
 *		.rate = 10e3, .snr = 100 };
 *	const double coil[] = { 0, 0.25 };
 *	struct bound b;
 *	bound_closed(&par, coil, 2, &b);	// b.velocity / par.velocity: 1.55e-4
 */
#ifndef LAYOUT_BOUND_H
#define LAYOUT_BOUND_H

#include "num/status.h"
#include "signal/pulse/sensor.h"

struct bound_par {
	enum pulse_shape shape;
	double zone;     /* of each coil, m */
	double velocity; /* of the particle, m/s */
	double rate;     /* samples per second of each coil, Hz */
	double snr;      /* A over the rms of the noise of a sample */
};

/* Standard errors; INFINITY if the samples do not determine the particle. */
struct bound {
	double time;      /* of the arrival at the first coil of the list, s */
	double velocity;  /* m/s */
	double amplitude; /* over A */
	double diameter;  /* over the diameter, which is (A / (K v))^(1/3) */
};

/* E0, E1 and E2 of a shape. */
void bound_energies(enum pulse_shape shape, double energy[3]);

/* From the integrals over time. */
void bound_closed(
	const struct bound_par *par, const double *coil, int coils, struct bound *b);

/* The same from the sums over the samples, as mean square over so many positions of the
 * arrival between two samples. */
enum num_status bound_sampled(const struct bound_par *par, const double *coil, int coils,
	int phases, struct bound *b);

#endif
