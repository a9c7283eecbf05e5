/* scene.h - simulation of the signal of two sensors, piece by piece
 *
 * Adds the pulses of particles, disturbances, white or coloured noise, slow drift
 * and the lines of mains and pump, and limits the sum.  A demodulator gives each sensor a
 * channel in phase with the pulses of ferrous particles and, if asked for, one in
 * quadrature with noise, drift and phases of lines of its own.  Each pulse touches its
 * own samples only, and memory holds only the particles now between the sensors; a stream
 * may last for days.
 */
#ifndef SIGNAL_SCENE_H
#define SIGNAL_SCENE_H

#include "num/status.h"
#include "signal/simulate/disturbance.h"
#include "signal/simulate/passage.h"
#include <stdint.h>

enum { SCENE_LINES_MAX = 16 };

struct scene_par {
	double rate; /* frames per second, Hz */
	enum pulse_shape shape;
	double length; /* of the sensing zone, m: a pulse lasts length / velocity */
	double kappa;  /* V s/m4, see sensor.h */
	double gain;   /* of sensor 2 over sensor 1 */

	uint64_t seed;
	uint32_t realisation;
	double noise;      /* rms, V */
	double corner;     /* of the noise's one-pole low-pass, Hz; 0: white */
	double common;     /* correlation of the noise of both sensors, -1 .. 1 */
	double drift;      /* rms of the slow drift of each base line, V */
	double drift_time; /* its correlation time, s */
	int nlines;
	double line[SCENE_LINES_MAX];       /* frequencies, Hz; phases are drawn */
	double line_level[SCENE_LINES_MAX]; /* amplitudes, V */
	double multiple[SCENE_LINES_MAX];   /* share in the wandering of the mains: 1 for
					       the line itself, 3 for its third harmonic */

	double wander;      /* rms of the frequency of the mains, Hz */
	double gain_drift;  /* rms of the relative change of gain */
	double phase_drift; /* rms of the demodulator's phase, rad */
	double phase;       /* its mean: turns responses by exp(i phase), rad */
	double saturation;  /* limit of |x|, V; 0: none */
	int quadrature;     /* 1: four channels, I1 Q1 I2 Q2, in place of two */
};

struct scene;

/* NULL when out of memory. */
struct scene *scene_new(const struct scene_par *par);
void scene_free(struct scene *scene);

/* Adds a particle.  Parts of its pulses that lie before the present frame are lost. */
enum num_status scene_pass(struct scene *scene, const struct passage *p);
/* Adds an event, likewise. */
enum num_status scene_disturb(struct scene *scene, const struct disturbance *event);
/* Response of the sensors to a particle, without adding it: peaks at
 * sensor 1 in phase and in quadrature, V.  Returns 1 if its pulse alone reaches the
 * saturation at either sensor.  Particles must come in order of time[0]. */
int scene_receive(struct scene *scene, const struct passage *p, double peak[2]);
/* The next frames of both sensors, or of four channels, interleaved, V. */
void scene_next(struct scene *scene, double *x, size_t nframes);

/* Time after which the particles added so far have no effect, s. */
double scene_end(const struct scene *scene);
/* Samples that were touched by pulses so far, both sensors. */
double scene_touched(const struct scene *scene);
size_t scene_pending(const struct scene *scene); /* particles in memory */

#endif
