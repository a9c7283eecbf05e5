/* calibration.h - parameters of an instrument: those that the caller knows and those that
 * are learned from a two-sensor record
 *
 * From the beginning of a record: lag of the second sensor, interfering tones, noise of
 * either channel, shape and duration of the pulses, ratio of the gains, range of the
 * velocities.  Values known by the caller are not changed.
 *
 * The order is: tones from the periodogram; noise from the fourth difference; lag from
 * the cross-correlation; duration from the lag at which the autocorrelation is lowest
 * (which superposition does not change); then joint fits of the clearest sections under
 * each shape, with duration and gain chosen by least chi-square, and a correction of the
 * shape if all pulses have a common residual.
 */
#ifndef SIGNAL_CALIBRATION_H
#define SIGNAL_CALIBRATION_H

#include "signal/fit/joint.h"
#include "signal/noise/tones.h"
#include "signal/noise/whiten.h"
#include "signal/pulse/sensor.h"
#include "signal/pulse/shape.h"
#include <stddef.h>

enum { CALIBRATE_ANY_PULSE = -1, CALIBRATE_FIND_TONES = -1 };

/* Known parameters; NAN or -1: to be found. */
struct calibrate_par {
	double lag;      /* samples */
	double duration; /* of a pulse of the mean velocity, samples */
	double gain;     /* sensor 2 over sensor 1 */
	int pulse;       /* enum pulse_shape or CALIBRATE_ANY_PULSE */
	double spread;   /* delays within lag (1 +- spread); NAN: learned, within 0.1 */
	double false_alarm;      /* expected false particles per sample of noise */
	int tones;               /* number of omega, or CALIBRATE_FIND_TONES */
	double omega[TONES_MAX]; /* rad per sample */
	double *filter; /* symmetric taps of the filter applied to the record, or NULL */
	size_t filter_taps;
	/* Flags of the samples of each channel: 1 is not known; NULL: all are known. */
	const unsigned char *hidden[2];
	int in_order; /* 1: particles are known to pass sensor 1 first */
	double most;  /* samples of pulses that may be computed to learn the rest */
};

/* Share of the transit time within which delays are searched in plug flow, whose
 * velocities differ by a few per cent.  With 0.05, 0.1 and 0.2 the rows that look right
 * are 793, 795 and 786 of 800 in groups in plug flow, all of 800 in turbulent flow and
 * 156, 156 and 158 of 400 in laminar flow, none of them wrong (scenes group,
 * group-turbulent and laminar of tests/matrix/scenes.tsv, seeds 11 to 18). */
#define CALIBRATE_PLUG 0.1

/* Share of the transit time within which the delay of a single event is measured, and to
 * which a range is widened where no pulses within it describe a section.  For events,
 * 0.2, 0.3 and 0.8 find 1643, 1659 and 1658 of 1800 particles, and 1470, 1482 and 1482
 * with rows that are believed (scenes turbulent, turbulent-highpass, group-turbulent,
 * group, reversed and laminar of tests/matrix/scenes.tsv, seeds 81001 to 81104); for
 * sections, 0.2, 0.3 and 0.45 found 147, 189 and 230 of 400 particles in laminar flow,
 * whose records were all doubted. */
#define CALIBRATE_WIDE 0.3

/* Least transit time, in durations of a pulse.  Events that reach both channels together
 * were found at most 0.015 apart in eight records of shocks; coils as near as 5 cm, with
 * pulses of 7.7 ms at 12.7 m/s, are 0.4 apart. */
#define CALIBRATE_APART 0.1

/* Chi-square per degree of freedom of clear pulses below which their shape describes
 * them. */
#define CALIBRATE_DESCRIBES 1.2
/* The same below which it may, once the cause of the rest is found. */
#define CALIBRATE_TOLERABLE 4.0

struct calibration {
	long shift;         /* samples by which channel 2 is moved back */
	double correlation; /* correlation coefficient of the channels at that lag */
	int tones;
	double omega[TONES_MAX];
	size_t tone_hop;              /* samples between two fits of the tones */
	double tone_power[TONES_MAX]; /* on channel 1, units of noise^2 */
	double tone_variance; /* of what interpolation leaves of a coefficient, units of
				 noise^2 */
	int lines_in_noise;   /* 1: what the tones leave is taken for noise, and more than
				 it */
	struct whitening whitening; /* of filtered records; else without taps */
	double mean[2];             /* of the channels, subtracted before whitening */
	double noise[2];            /* standard deviations, before any filter */
	struct shape *shape;
	int pulse;     /* enum pulse_shape */
	int measured;  /* 1: shape taken from the record, pulse the nearest of sensor.h */
	int reversed;  /* 1: that pulse with its sign changed */
	int corrected; /* 1: shape corrected by the residual common to all pulses */
	double duration, gain; /* as above; negative: the sensors differ in polarity */
	double drift; /* change of the logarithm of the gain, which is that at the middle
			 of what is learned from, per sample */
	double width; /* of the pulses of sensor 2, over those of sensor 1 */
	/* Samples by which the delay of a particle of the mean velocity exceeds that of
	 * the fit, see examples.h, and the standard error, which all particles have in
	 * common. */
	double origin, origin_se;
	double crosstalk[2]; /* share of the other channel in either, with the sign of
				sensor 2 as separated */
	double transit;      /* samples between the sensors; INFINITY if unknown */
	double lag;          /* the same of the mean particle, not rounded */
	double delta_min, delta_max;       /* samples around shift */
	double threshold, threshold_near;  /* thresholds of joint.h */
	double misfit, scatter[JOINT_OWN]; /* of joint.h */
	int far;    /* pulses near the limits of the range of delays that was searched */
	int events; /* pulses to which the shape was fitted, and ... */
	int isolated;       /* ... those of them that stand alone, ... */
	int negative;       /* ... and those that are negative */
	int presumed_white; /* 1: treated as white although the spectrum test failed */
	int estimated;      /* 1: whitened by a filter estimated from its noise */
	double work;        /* samples of pulses computed to learn it, or in vain */
	int attempts;       /* number of calibrations tried */
	int dense;          /* 1: pulses overlap throughout the record */
	double chi2;        /* of the fitted pulses, per degree of freedom */
	/* (chi-square + 2 threshold_near per pulse) per degree of freedom; least is best
	 */
	double penalised;
};

enum separate_status {
	SEPARATE_OK,
	SEPARATE_MEMORY,
	SEPARATE_SHORT,      /* fewer samples than SEPARATE_SHORTEST */
	SEPARATE_NOT_FINITE, /* see separate_bad_sample() */
	SEPARATE_SILENT_1,   /* channel 1 is constant */
	SEPARATE_SILENT_2,
	SEPARATE_COLOURED, /* of one attempt: the noise must be whitened first */
	SEPARATE_OPPOSITE, /* ... or channel 2 negated: its pulses have the other sign */
	SEPARATE_NO_LAG,   /* the channels have nothing in common */
	SEPARATE_HARD,     /* what is learned from is described only by too many pulses */
	SEPARATE_AT_ONCE,  /* both channels have the same at once: no particles */
	SEPARATE_SWAPPED,  /* particles pass sensor 2 first */
	SEPARATE_FAR,      /* the lag given is as long as what is learned from */
	SEPARATE_NARROW,   /* a filter has left a band narrower than half the pulse's */
	SEPARATE_FAST,     /* pulses of fewer than 8 samples */
	SEPARATE_SLOW,     /* pulses longer than half of what is learned from */
	SEPARATE_TONES,    /* too many lines, or too near each other, for the record */
	SEPARATE_WINDOW,   /* that of the masks is shorter than half a pulse */
	SEPARATE_WIDE      /* pulses may last too long, or no time, within the spread */
};

/* x1, x2: n >= 64 finite samples.  On SEPARATE_OK *c is filled; free it with
 * calibration_clear().  Otherwise only its work and its attempts are. */
enum separate_status calibrate(const struct calibrate_par *par, const double *x1,
	const double *x2, size_t n, struct calibration *c);
void calibration_clear(struct calibration *c);

/* 1 if the pulse describes its record, by CALIBRATE_DESCRIBES. */
int calibration_describes(const struct calibration *c);
/* 1 if it does, and does not replace several: a shape corrected until no example is one
 * pulse may be another one's half, or a group of them. */
int calibration_stands(const struct calibration *c);

/* *duration: of this pulse of sensor.h if its autocorrelation is lowest at this lag,
 * samples. */
enum num_status known_shape_duration(int pulse, double low, double *duration);
/* Sets the shape of c to this pulse, reversed or not, as filtered by the whitening, at
 * the present duration. */
enum num_status known_shape_set(struct calibration *c, int pulse);

/* Removes what the channels have of each other: x1 = y1 + k1 y2, x2 = y2 + k2 y1. */
void calibration_unmix(const double crosstalk[2], double *x1, double *x2, size_t n);

/* Fills the scene of joint.h; the caller sets max_pulses.  Steady tones at frequencies
 * where the pulse has no power are left out. */
void calibration_scene(const struct calibration *c, struct joint_scene *scene);

/* Least reduction of chi-square by an isolated pulse, so that noise gives at most rate
 * false ones per sample: the expected number of maxima above u of the matched-filter
 * field over arrival and delay (Rice's formula in two dimensions; Adler, The Geometry of
 * Random Fields, 1981), for a threshold of u^2.  width: range of delays in samples. */
double calibrate_threshold(double rate, const struct shape *shape, double duration,
	double gain, double width);

/* Samples on either side of the transit time within which delays are searched: this share
 * of it, and at least SHAPE_FINEST. */
double calibration_reach(double share, double transit, double duration);
/* The same for plug flow. */
double calibration_plug(const struct calibration *c);

/* Most that a delay may be above least so that even beyond the range, as far as a fit may
 * go, a particle takes time to pass. */
double calibration_most(double transit, double least);

/* Widens the range of the delays seen so that it contains later ones: by half of it on
 * either side, and by at least 0.02 of a duration. */
void calibration_widen(double duration, double *least, double *most);

/* Share of the noise removed by the filter and the whitening. */
double calibration_lost(const struct calibration *c);

#endif
