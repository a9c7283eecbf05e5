/* cnn.h - a convolutional network that estimates the pulses of a section
 *
 * Input is a section of the two-sensor record as joint.h describes it,
 *
 *	y1(n) = sum_i a_i p((n - t_i) / T_i) + noise
 *	y2(n) = sum_i g a_i p((n - t_i - delta_i) / T_i) + noise,
 *
 * with 1 to CNN_SOURCES pulses and delta_i within reach of middle; the output is the
 * number of pulses and t_i, delta_i, a_i of each in order of arrival. The section is
 * resampled to a grid of CNN_PER_PULSE points per duration about its centre of energy,
 * so that one network serves any sampling rate, amplitude and gain.  The two channels of
 * the grid are
 *
 *	y1 / scale   and   (y2(n + middle) / g - y1) / scale / (2 pi reach / T),
 *
 * where scale is the largest |y1|. The delays are thus not a small difference of large
 * numbers, and the noise of the second channel shows the network how much information
 * the section adds to the prior.
 *
 * The outputs are one number per count (the largest selects it), then for a count of one,
 * two, ... in turn the pulses' (t - centre) / T, (delta - middle) / reach and
 * cbrt(a / scale).
 *
 *	struct cnn_section s = { y1, y2, n, .duration = 100, .gain = 0.9, .reach = 1.5 };
 *	struct cnn_pulse p[CNN_SOURCES];
 *	if (cnn_suits(net))
 *		for (int i = 0, m = cnn_apply(net, &s, 0, p); i < m; i++)
 *			print(p[i]);
 */
#ifndef NET_CNN_H
#define NET_CNN_H

#include "net/network.h"
#include <stddef.h>

enum {
	CNN_SOURCES = 4,
	CNN_POINTS = 128,
	CNN_PER_PULSE = 25,
	CNN_OUTPUTS = CNN_SOURCES + 3 * CNN_SOURCES * (CNN_SOURCES + 1) / 2
};

/* reach over duration that the networks are trained for. */
#define CNN_REACH_MIN 0.01
#define CNN_REACH_MAX 0.25

struct cnn_section {
	const double *y1, *y2; /* n samples each, finite */
	size_t n;
	double duration;      /* T, samples, at least CNN_PER_PULSE / 2 */
	double gain;          /* g > 0 */
	double middle, reach; /* delta lies in middle +- reach, samples */
};

struct cnn_pulse {
	double t, delta, a; /* samples from y1[0], samples, units of y1 */
};

/* How a section was resampled to the grid. */
struct cnn_frame {
	double centre, duration, scale, middle, reach;
};

/* 1 if the network has the inputs and outputs described above. */
int cnn_suits(const struct network *net);

/* Fills x[2 * CNN_POINTS]; 0 if the section does not suit: it is longer than the grid
 * (CNN_POINTS / CNN_PER_PULSE = 5.12 durations), empty, all zero, sampled too coarsely,
 * or reach is above CNN_REACH_MAX durations.  A smaller reach than CNN_REACH_MIN is taken
 * as that. */
int cnn_lay(const struct cnn_section *section, network_real *x, struct cnn_frame *frame);

/* Number of pulses and the pulses of one row of outputs; sources = 0: the number
 * estimated by the network. */
int cnn_pulses(const network_real *output, const struct cnn_frame *frame, int sources,
	struct cnn_pulse *pulse);

/* Both with the network in between; 0 if the section does not suit. */
int cnn_apply(struct network *net, const struct cnn_section *section, int sources,
	struct cnn_pulse *pulse);

/* Where the outputs for this count begin in a row of outputs. */
int cnn_head(int sources);

#endif
