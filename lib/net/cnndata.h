/* cnndata.h - simulated sections to train and score the networks of cnn.h
 *
 * 1 to CNN_SOURCES pulses of sensor.h, amplitudes a and arrivals t at random, in white
 * noise on both channels; times in samples, CNNDATA_DURATION to the duration of a pulse.
 * The velocity of each particle determines both its delay and its duration,
 * T_i = T (1 + delta_i / transit).  Arrivals are uniform in a span of half a duration per
 * pulse, at least a spacing apart.  The labels are in order of arrival, which gives each
 * output a unique meaning.
 */
#ifndef NET_CNNDATA_H
#define NET_CNNDATA_H

#include "net/cnn.h"
#include "signal/pulse/sensor.h"

enum {
	CNNDATA_DURATION = 100,
	CNNDATA_SAMPLES = 512,
	CNNDATA_TARGETS = 1 + 6 * CNN_SOURCES
};

struct cnndata_par {
	int sources[2];  /* at least, at most */
	double snr[2];   /* dB, uniform: (1 / standard deviation of the noise)^2 */
	double spacing;  /* least distance of arrivals, durations */
	double reach[2]; /* of the delays, durations, log-uniform: delta in +- reach */
	double transit;  /* from sensor to sensor, durations */
	double gain[2];  /* uniform */
	double size[2];  /* cube root of the amplitude, uniform */
	enum pulse_shape shape;
	uint64_t seed;
};

/* The sections with which the installed network is trained. */
struct cnndata_par cnndata_default(void);

/* A section with its truth. */
struct cnndata_section {
	double y1[CNNDATA_SAMPLES], y2[CNNDATA_SAMPLES];
	struct cnn_section section; /* pointing into it, up to half a duration wider than
				       its pulses */
	int sources;
	double noise; /* standard deviation */
	struct cnn_pulse pulse[CNN_SOURCES];
};

/* Section i, stream (seed, i, RNG_NETWORK). */
void cnndata_section(
	const struct cnndata_par *par, uint32_t i, struct cnndata_section *out);

/* Inputs and target of a section: its count, then for each pulse three outputs as in
 * cnn.h, then their variances: the posterior variance of an isolated pulse (Cramer-Rao
 * bound and prior), by which squared errors are divided. */
void cnndata_target(
	const struct cnndata_section *s, network_real *x, network_real *target);

/* Loss for CNNDATA_TARGETS targets: mean over pulses and their three outputs of
 * error^2 / variance, plus CNNDATA_COUNT times the cross-entropy of the count. */
#define CNNDATA_COUNT 3.0
network_loss cnndata_loss;

/* Scores of a network on sections first, first + 1, ...: share of correct counts and,
 * with the count given, root mean square errors of arrival and delay, in durations, and
 * of the diameter, relative; alone is the Cramer-Rao bound of the delay for isolated sine
 * pulses. */
struct cnndata_score {
	double count_right, arrival, delay, alone, size;
};

struct cnndata_score cnndata_score(struct network *net, const struct cnndata_par *par,
	uint32_t first, long sections);

#endif
