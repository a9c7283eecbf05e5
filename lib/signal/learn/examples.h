/* examples.h - clear short sections of a record to which its pulse is fitted, and the
 * parameters of the instrument that are learned by them; for lib/signal/learn only
 *
 * All is in units of the noise.
 */
#ifndef SIGNAL_EXAMPLES_H
#define SIGNAL_EXAMPLES_H

#include "signal/learn/calibration.h"
#include "signal/learn/template.h"
#include <stddef.h>

enum { EXAMPLES_MAX = 16, EXAMPLE_PULSES = 16 };

/* Share of its energy in which the shape of a pulse may be wrong at first. */
#define EXAMPLES_ROUGH 0.05

/* A section used to learn the pulse: samples of noise 1 and the pulses found in it. */
struct example {
	const double *y1, *y2;
	long long begin; /* index of the first sample */
	size_t n;
	struct joint_pulse pulse[EXAMPLE_PULSES];
	struct joint_pulse trial[EXAMPLE_PULSES]; /* by examples_chi2() */
	int m;
	int either;    /* 1: they may be of either sign */
	double found;  /* misfit with which they were found; 0: they do not describe it */
	int isolated;  /* 1: hardly longer than one pulse */
	double merit;  /* large for the clearest */
	double excess; /* of chi-square over its degrees of freedom */
	int outlier; /* 1: its residual is so much larger than those of the others that it
			contains other events */
};

struct examples {
	const struct calibrate_par *par;
	const double *y1, *y2; /* the record: n samples, aligned */
	size_t n;
	struct joint *joint;
	struct joint_scene scene;   /* present parameters of the instrument, ... */
	struct joint_scene present; /* ... at one example */
	double drift;  /* change of the logarithm of the gain per sample; ... */
	double middle; /* ... the sample where it is that of the scene */
	struct example example[EXAMPLES_MAX];
	const unsigned char *hidden[2]; /* flags of samples that are not known, or NULL */
	long shift;                     /* samples by which channel 2 was moved back */
	int count;
	/* How examples_fit() finds the pulses: anew, from those that described the
	 * examples before, or by the better of both. */
	enum { EXAMPLES_ANEW, EXAMPLES_AGAIN, EXAMPLES_BETTER } by;
	int pieces; /* 1: some may cut pulses through */
	/* Duration by the spectrum of the record, and how far from it those that fit may
	 * be (both 0: it was not used). */
	double spectral, within;
	double misfit; /* of joint.h, at the end */
	double share; /* share of the energy of a pulse that the shape leaves, as found so
			 far */
	double dof;   /* of all examples, ... */
	double excess;    /* ... their chi-square beyond it, and ... */
	double energy;    /* ... that of their pulses */
	int signs;        /* 1: clear pulses of both signs were found */
	int corrected;    /* 1: the shape is one of twenty parameters, else of two */
	double penalised; /* their chi-square and twice the threshold for each pulse, per
			 degree */
	double before;    /* work done before */
	/* SEPARATE_MEMORY after a function was out of memory, SEPARATE_HARD after the
	 * limit of work was exceeded; the results are invalid then. */
	enum separate_status status;
};

/* Selects the clearest short sections of the record, at most most of them; if few are
 * short, also pieces of longer ones. */
void examples_pick(struct examples *ex, int most, const struct calibration *c);

/* Takes the parameters of the instrument from c. */
void examples_set_scene(struct examples *ex, const struct calibration *c);

/* Finds the pulses of all examples again; one that overlaps others must reduce chi-square
 * by this share of their energy.  Returns the median of their chi-square per degree of
 * freedom, which is robust against a few examples with hidden pulses; INFINITY if one
 * cannot be fitted. */
double examples_fit(struct examples *ex, double misfit);

/* Chi-square of all examples that are no outliers, with their pulses refined under the
 * present scene, and its slopes unless NULL; INFINITY if one cannot be. */
double examples_chi2(struct examples *ex, struct joint_slopes *slopes);
/* Keeps the pulses so refined, of the last chi-square, which was finite. */
void examples_keep(struct examples *ex);

/* Refines pulse[0 .. e->m) of one example under the present scene. */
enum joint_status examples_refine(struct examples *ex, const struct example *e,
	struct joint_pulse *pulse, struct joint_result *result);

/* Amplitude of pulse p / 2 of an example at sensor 1 + p % 2. */
double examples_amplitude(const struct examples *ex, const struct example *e, int p);
/* Adds to sum[0 .. 2 half] the residual of this channel around this pulse, as last
 * refined, times its amplitude, at the samples of one of the mean velocity and 1 / width
 * as long; to weight, unless NULL, the square of the amplitude where there is a residual.
 */
void examples_add_residual(const struct examples *ex, const struct example *e, int p,
	double width, int half, double *sum, double *weight);

/* Share of the other channel in either one of the record; 0 where it is not certain.  The
 * pulses of an example are looked for in the other channel at the same time: in that one
 * they are a transit time earlier or later. */
void examples_crosstalk(struct examples *ex, double share[2]);

int examples_pulses(const struct examples *ex); /* number of them in all */
/* 1 if the largest number of pulses was found: there may be more. */
int examples_full(const struct examples *ex);

/* --- find_shape.c: the shape that describes some clear examples best */

/* Uses the pulse found in the record, whose shape c then owns. */
void find_shape_take(struct calibration *c, struct template *found);
/* Kinds of shapes: those of sensor.h, reversed or not, and those of the clearest single
 * events. */
enum { SHAPES_KNOWN = 1, SHAPES_SINGLE = 2 };
/* The best of these kinds, with an approximate duration; single events, which have noise,
 * are taken only if known shapes cost several times as much.  low: lag of the lowest
 * autocorrelation; hint: the pulse taken from the record, which is tried first, or NULL.
 * HARD if none may describe the record better than what does so at the price of c, which
 * is INFINITY where nothing does. */
enum separate_status find_shape(struct examples *ex, unsigned kinds, double low,
	const struct template *hint, struct calibration *c);

/* --- tune.c: duration, gain, width and drift of the gain of least chi-square */

/* Adjusts duration and gain of the scene, unless they are known, in so many steps, of at
 * most so much of their logarithms. */
void tune(struct examples *ex, double most, int steps);
/* The same in turn with the pulses of the examples, for the scene and c. */
enum separate_status tune_pulse(struct examples *ex, struct calibration *c);
/* The same with all parameters. */
enum separate_status tune_all(struct examples *ex, struct calibration *c);

/* --- learn_scatter.c: what pulses have of their own */

/* Sets the scatter of widths and ratios of the scene and of c (joint.h); 1 if there is
 * some. */
int learn_scatter(struct examples *ex, struct calibration *c);

/* --- correct.c: correction of a pulse that differs from those of sensor.h
 *
 * The mean residual around all pulses of the examples is not noise but an error of the
 * shape. */

/* 1 if the shape may be wrong: when only large pulses may overlap others, a significant
 * chi-square remains or pulses vanish.  On return the examples are fitted as before. */
int correct_doubtful(struct examples *ex, struct calibration *c);
/* Adds the mean residual to the shape of c if that describes the examples better. */
enum num_status correct_shape(struct examples *ex, struct calibration *c);

/* --- origin.c: arrival at sensor 2 where its pulses have another width
 *
 * A shape taken from the record has no origin of its own: the arrival is where the shape
 * puts it.  At both sensors that is the same, unless their pulses differ in width: what
 * leads the arrival by a share of a pulse leads it by more in a longer pulse.  Whatever
 * filter both channels have passed, the cross-correlation of their pulses is symmetric
 * about the delay if the pulse before the filter is symmetric, or antisymmetric, about
 * its arrival. */

/* Fills origin and origin_se of c from the pulses of the examples, as last fitted.
 * NUM_MEMORY. */
enum num_status find_origin(struct examples *ex, struct calibration *c);

#endif
