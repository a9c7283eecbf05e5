/* calibrate.h - what a two-sensor record says about the instrument
 *
 * From the beginning of a record: lag of the second sensor, interfering tones, noise of
 * either channel, shape and duration of the pulses, ratio of the gains, range of the
 * velocities.  Whatever the caller knows is taken as given.
 *
 * The order is: tones from the periodogram; noise from the fourth difference; lag from
 * the cross-correlation; duration from the lag at which the autocorrelation is lowest
 * (which superposition does not change); then joint fits of the clearest sections under
 * each shape, with duration and gain chosen by least chi-square, and a correction of the
 * shape where all pulses ask for it.
 */
#ifndef SIGNAL_CALIBRATE_H
#define SIGNAL_CALIBRATE_H

#include "signal/joint.h"
#include "signal/sensor.h"
#include "signal/shape.h"
#include "signal/tones.h"
#include "signal/whiten.h"
#include <stddef.h>

enum { CALIBRATE_ANY_PULSE = -1, CALIBRATE_FIND_TONES = -1 };

/* What is known; NAN, -1 where it is to be found. */
struct calibrate_par {
	double lag;      /* samples */
	double duration; /* of a pulse of the mean velocity, samples */
	double gain;     /* sensor 2 over sensor 1 */
	int pulse;       /* enum pulse_shape or CALIBRATE_ANY_PULSE */
	double spread;   /* delays within lag (1 +- spread); NAN: learned, within 0.1 */
	double false_alarm;      /* expected false particles per sample of noise */
	int tones;               /* number in omega, or CALIBRATE_FIND_TONES */
	double omega[TONES_MAX]; /* rad per sample */
	double *filter;          /* symmetric taps the record has been through, or NULL */
	size_t filter_taps;
};

struct calibration {
	long shift;         /* samples channel 2 is moved back by */
	double correlation; /* of the channels at that lag */
	int tones;
	double omega[TONES_MAX];
	size_t tone_hop;              /* samples between two fits of the tones */
	double tone_power[TONES_MAX]; /* on channel 1, units of noise^2 */
	double tone_variance;       /* of a coefficient from one hop to the next, units of
				       noise^2 */
	struct whitening whitening; /* of filtered records; else without taps */
	double mean[2];             /* of the channels, taken off before that */
	double noise[2];            /* standard deviations, before any filter */
	double rest[2]; /* of these, power left by the pulses the shape was fitted to */
	struct shape *shape;
	int pulse;             /* which of enum pulse_shape, ... */
	int corrected;         /* ... 1: with what all pulses had besides */
	double duration, gain; /* as above */
	double transit;        /* samples between the sensors; INFINITY if unknown */
	double delta_min, delta_max; /* samples around shift */
	double drop, drop_near;      /* thresholds of joint.h */
	double misfit;               /* of joint.h: how far the shape can be trusted */
	int events;                  /* pulses the shape was fitted to */
	int suspect;                 /* 1: taken for white, which its noise is not */
	int guessed;                 /* 1: whitened by what its own noise tells */
	int attempts;                /* times all this was learned until it was settled */
	int dense;                   /* 1: pulses throughout, hardly any of them clear */
	double chi2;                 /* of these, per degree of freedom */
	double price; /* the same with so much for each pulse, to choose by */
};

enum calibrate_status {
	CALIBRATE_OK,
	CALIBRATE_MEMORY,
	CALIBRATE_SILENT_1, /* channel 1 is constant */
	CALIBRATE_SILENT_2,
	CALIBRATE_NO_LAG, /* the channels have nothing in common */
	CALIBRATE_SWAPPED, /* particles pass sensor 2 first */
	CALIBRATE_FAR,    /* the lag given is as long as the record */
	CALIBRATE_NARROW, /* the filter has left a band narrower than half the pulse's */
	CALIBRATE_FAST,   /* pulses of fewer than 8 samples */
	CALIBRATE_SLOW,   /* pulses longer than half the record */
	CALIBRATE_TONES /* too many lines, or lines too near each other, for the record */
};

/* x1, x2: n >= 64 finite samples.  On CALIBRATE_OK *c is filled; free it with
 * calibration_clear(). */
enum calibrate_status calibrate(const struct calibrate_par *par, const double *x1,
	const double *x2, size_t n, struct calibration *c);
void calibration_clear(struct calibration *c);

/* The scene of joint.h with all that was learned: max_pulses is left to the caller. Tones
 * where the pulse has no power are left out, once they are known to be steady. */
void calibration_scene(const struct calibration *c, struct joint_scene *scene);

/* Chi-square a lone pulse must take away so that noise gives at most rate false ones
 * per sample: the expected number of maxima above u of the matched-filter field over
 * arrival and delay (Rice's formula in two dimensions; Adler, The Geometry of Random
 * Fields, 1981), u^2 being the threshold.  width: range of delays in samples. */
double calibrate_drop(double rate, const struct shape *shape, double duration,
	double gain, double width);

#endif
