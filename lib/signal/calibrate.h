/* calibrate.h - what a two-sensor record says about the instrument
 *
 * From the beginning of a record: gaps, interfering tones, spectrum of the noise, lag of
 * the second sensor, duration and form of the pulses, ratio of the gains, range of the
 * velocities.  Whatever the caller knows is taken as given.
 *
 * All of it is one model, estimated by turns: a record is pulses of one form plus noise
 * of a spectrum.  Where nothing happens gives a first spectrum; what is whitened by it
 * shows clear pulses (start.h), whose common form is learned (learn.h); what they leave
 * gives the spectrum anew, and that their form.  In the end half of the clear pulses tell
 * how well the form learned from the others describes them.
 */
#ifndef SIGNAL_CALIBRATE_H
#define SIGNAL_CALIBRATE_H

#include "signal/gaps.h"
#include "signal/joint.h"
#include "signal/sensor.h"
#include "signal/shape.h"
#include "signal/tones.h"
#include "signal/whiten.h"
#include <stddef.h>

/* Error of the pulses' form, over the form, beyond which nothing is told apart by it:
 * groups of three with an echo, taken for pulses without, leave 0.034. */
#define CALIBRATE_ERROR 0.03

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
	struct gaps gaps[2];
	long shift; /* samples channel 2 is moved back by */
	int tones;
	double omega[TONES_MAX];
	size_t tone_hop;      /* samples between two fits of the tones */
	double tone_variance; /* of a coefficient from one hop to the next, units of
				 noise^2 */
	struct whitening whitening[2]; /* of filtered or coloured records; else no taps */
	double mean[2];                /* of the channels, taken off before that */
	double noise[2];               /* standard deviations of what is white then */
	struct shape *plain;           /* the pulse in the record, max |p| = 1, ... */
	struct shape *shape[2];        /* ... and as either whitened channel has it */
	int pulse;             /* which of enum pulse_shape, or CALIBRATE_ANY_PULSE: a
				* form of its own */
	int through;           /* 1: the pulse has passed what has coloured the noise */
	double duration, gain; /* as above; gain < 0 where one sensor is reversed */
	double transit;        /* samples between the sensors; INFINITY if unknown */
	double delta_min, delta_max; /* samples around shift */
	double delta_var;            /* of the delays of what was learned from */
	double drop, drop_near;      /* thresholds of joint.h */
	double level;                /* noise power over what was thought, and ... */
	double error; /* ... error of the form over the form, from pulses that it was not
		       * learned from */
	double error_least; /* its standard error, ... */
	double error_floor; /* ... and what the noise in the form makes of it */
	int events;         /* pulses the form was learned from */
	int negatives;      /* 1: pulses of both signs among them */
	int reversed;       /* 1: most begin with their negative lobe */
	int attempts;       /* times the form was learned */
	int dense;          /* 1: pulses throughout, hardly any of them clear */
	double chi2;        /* of these, per degree of freedom: the median */
};

enum calibrate_status {
	CALIBRATE_OK,
	CALIBRATE_MEMORY,
	CALIBRATE_SILENT_1, /* channel 1 is constant */
	CALIBRATE_SILENT_2,
	CALIBRATE_NO_LAG,  /* the channels have nothing in common */
	CALIBRATE_FAR,     /* the lag given is as long as the record */
	CALIBRATE_NARROW,  /* the filter has left a band narrower than half the pulse's */
	CALIBRATE_FAST,    /* pulses of fewer than 8 samples */
	CALIBRATE_SLOW,    /* pulses longer than half the record */
	CALIBRATE_SWAPPED, /* pulses come to channel 2 first */
	CALIBRATE_TOGETHER, /* pulses come to both channels at once */
	CALIBRATE_HOPELESS  /* no form of pulses was found by the work allowed for that */
};

/* x1, x2: n >= 64 finite samples.  On CALIBRATE_OK *c is filled; free it with
 * calibration_clear(). */
enum calibrate_status calibrate(const struct calibrate_par *par, const double *x1,
	const double *x2, size_t n, struct calibration *c);
void calibration_clear(struct calibration *c);

/* Gives c the whitened shapes of its plain pulse.  Returns 0 when out of memory. */
int calibration_set_shapes(struct calibration *c);

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
