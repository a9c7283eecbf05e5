/* cnndata.c - simulated sections to train and score the networks of cnn.h */
#include "net/cnndata.h"
#include "num/grid.h"
#include "num/philox.h"
#include <math.h>
#include <string.h>

/* Places in the stream of one section; network.h and delaydata.h draw elsewhere. */
#define DRAWS ((uint64_t)4 << 40)
#define NOISE ((uint64_t)5 << 40)

enum { ARRIVALS = 16, OF_PULSES = 8 }; /* draws of the scene as a whole come first */

struct cnndata_par cnndata_default(void)
{
	return (struct cnndata_par){
		.sources = { 1, CNN_SOURCES },
		.snr = { 12, 45 },
		.spacing = 0.1,
		.reach = { CNN_REACH_MIN, CNN_REACH_MAX },
		.transit = 1.9635,
		.gain = { 0.8, 1.25 },
		.size = { 0.5, 1.5 },
		.shape = PULSE_SINE,
		.seed = 1,
	};
}

static double draw(
	const struct cnndata_par *par, uint32_t i, unsigned k, double low, double high)
{
	return low + (high - low) * philox_uniform(par->seed, i, RNG_NETWORK, DRAWS + k);
}

/* The first draw of a pulse. */
static unsigned of_pulse(int k)
{
	return ARRIVALS + OF_PULSES * (unsigned)k;
}

/* Ascending arrivals with the least spacing: the spacings are subtracted from the span
 * and added between sorted uniform numbers, which keeps them uniform. */
static void draw_arrivals(const struct cnndata_par *par, uint32_t i, int n, double *t)
{
	double space = par->spacing * CNNDATA_DURATION;
	double span = fmax(0.5 * n * CNNDATA_DURATION - (n - 1) * space, 0);

	for (int k = 0; k < n; k++) {
		double u = draw(par, i, of_pulse(k), 0, span);
		int at = k;

		for (; at > 0 && t[at - 1] > u; at--)
			t[at] = t[at - 1];
		t[at] = u;
	}
	for (int k = 0; k < n; k++)
		t[k] += k * space;
}

static void add_pulse(
	enum pulse_shape shape, double t, double duration, double a, double *y)
{
	double p[CNNDATA_SAMPLES];
	size_t n;
	long first = pulse_support(shape, t, duration, &n), end = first + (long)n;

	if (first < 0)
		first = 0;
	if (end > CNNDATA_SAMPLES)
		end = CNNDATA_SAMPLES;
	if (first >= end)
		return;
	pulse_sample(shape, t, duration, first, (size_t)(end - first), p, NULL, NULL);
	for (long i = first; i < end; i++)
		y[i] += a * p[i - first];
}

void cnndata_section(
	const struct cnndata_par *par, uint32_t i, struct cnndata_section *out)
{
	int n = (int)draw(par, i, 0, par->sources[0], par->sources[1] + 1);
	double reach = CNNDATA_DURATION *
		       exp(draw(par, i, 1, log(par->reach[0]), log(par->reach[1])));
	double gain = draw(par, i, 2, par->gain[0], par->gain[1]);
	double t[CNN_SOURCES], edge = CNNDATA_DURATION / 2.0 + reach;
	/* The margins around the pulses and the phase of the samples are random. */
	double begin = edge + draw(par, i, 4, 0, CNNDATA_DURATION / 2.0);
	double end = edge + draw(par, i, 5, 0, CNNDATA_DURATION / 2.0);

	memset(out, 0, sizeof *out);
	out->sources = n;
	out->noise = pow(10, -draw(par, i, 3, par->snr[0], par->snr[1]) / 20);
	draw_arrivals(par, i, n, t);
	for (int k = 0; k < n; k++) {
		unsigned at = of_pulse(k);
		struct cnn_pulse *p = &out->pulse[k];
		double duration;

		p->t = begin + t[k];
		p->delta = draw(par, i, at + 1, -reach, reach);
		p->a = pow(draw(par, i, at + 2, par->size[0], par->size[1]), 3);
		duration = CNNDATA_DURATION + p->delta / par->transit;
		add_pulse(par->shape, p->t, duration, p->a, out->y1);
		add_pulse(par->shape, p->t + p->delta, duration, p->a * gain, out->y2);
	}
	for (size_t k = 0; k < CNNDATA_SAMPLES; k++) {
		double normal[2];

		philox_normal2(par->seed, i, RNG_NETWORK, NOISE + k, normal);
		out->y1[k] += out->noise * normal[0];
		out->y2[k] += out->noise * normal[1];
	}
	end += out->pulse[n - 1].t;
	out->section = (struct cnn_section){ out->y1, out->y2,
		(size_t)fmin(end, CNNDATA_SAMPLES), CNNDATA_DURATION, gain, 0, reach };
}

void cnndata_target(
	const struct cnndata_section *s, network_real *x, network_real *target)
{
	network_real *value = target + 1, *variance = target + 1 + 3 * CNN_SOURCES;
	struct cnn_frame f;

	memset(target, 0, CNNDATA_TARGETS * sizeof *target);
	target[0] = (network_real)s->sources;
	if (!cnn_lay(&s->section, x, &f))
		return;
	for (int k = 0; k < s->sources; k++, value += 3, variance += 3) {
		const struct cnn_pulse *p = &s->pulse[k];
		double noise = s->noise / p->a, samples = f.duration;
		/* Variances of a sine pulse alone in two channels of equal noise. */
		double t = noise * noise / (2 * M_PI * M_PI) / samples;
		double delta = 2 * t * pow(f.duration / f.reach, 2);
		double size = noise * noise / samples / 9;

		value[0] = (network_real)((p->t - f.centre) / f.duration);
		value[1] = (network_real)((p->delta - f.middle) / f.reach);
		value[2] = (network_real)cbrt(p->a / f.scale);
		/* The floors lie between the errors that the installed network leaves of
		 * one pulse and of two at 60 dB: .0012 and .0068 durations of arrival,
		 * .0016 and .019 of size.  After a fiftieth of the training, 0, 1/4, 1
		 * and 4 times these floors leave errors of size of .25, .099, .091 and
		 * .099 for pairs at 30 dB. */
		variance[0] = (network_real)(t + 5e-3 * 5e-3);
		variance[1] = (network_real)(1 / (1 / delta + 3) + 0.02 * 0.02);
		variance[2] = (network_real)(value[2] * value[2] * (size + 0.01 * 0.01));
	}
}

/* Cross-entropy of the count: outputs are logarithms of odds. */
static double count_loss(
	int count, const network_real *output, double scale, network_real *gradient)
{
	double top = output[0], sum = 0;

	for (int k = 1; k < CNN_SOURCES; k++)
		top = fmax(top, output[k]);
	for (int k = 0; k < CNN_SOURCES; k++)
		sum += exp(output[k] - top);
	for (int k = 0; k < CNN_SOURCES; k++)
		gradient[k] = (network_real)(scale * (exp(output[k] - top) / sum -
							     (k == count - 1)));
	return log(sum) - (output[count - 1] - top);
}

double cnndata_loss(const void *context, int n, int width, const network_real *output,
	const network_real *target, network_real *gradient)
{
	double sum = 0;

	(void)context;
	memset(gradient, 0, grid_size(n, width) * sizeof *gradient);
	for (int s = 0; s < n; s++) {
		int count = (int)target[0], head = cnn_head(count);
		double each = 1.0 / (3 * count);

		sum += CNNDATA_COUNT *
		       count_loss(count, output, CNNDATA_COUNT / n, gradient);
		for (int k = 0; k < 3 * count; k++) {
			double error = output[head + k] - target[1 + k];
			double variance = target[1 + 3 * CNN_SOURCES + k];

			sum += each * error * error / variance;
			gradient[head + k] =
				(network_real)(2 * each * error / variance / n);
		}
		output += width;
		gradient += width;
		target += CNNDATA_TARGETS;
	}
	return sum / n;
}

static void add_errors(struct cnndata_score *score, const struct cnndata_section *s,
	const struct cnn_pulse *pulse)
{
	for (int k = 0; k < s->sources; k++) {
		const struct cnn_pulse *want = &s->pulse[k];
		double noise = s->noise / want->a, g = s->section.gain;

		score->arrival += pow(pulse[k].t - want->t, 2);
		score->delay += pow(pulse[k].delta - want->delta, 2);
		score->size += pow(cbrt(pulse[k].a / want->a) - 1, 2);
		/* sigma^2 T / (2 pi^2) at either sensor, in samples. */
		score->alone += noise * noise * (1 + 1 / (g * g)) * CNNDATA_DURATION /
				(2 * M_PI * M_PI);
	}
}

struct cnndata_score cnndata_score(
	struct network *net, const struct cnndata_par *par, uint32_t first, long sections)
{
	struct cnndata_score score = { 0 };
	struct cnndata_section s;
	double pulses = 0;

	for (long i = 0; i < sections; i++) {
		struct cnn_pulse pulse[CNN_SOURCES];

		cnndata_section(par, first + (uint32_t)i, &s);
		score.count_right += cnn_apply(net, &s.section, 0, pulse) == s.sources;
		cnn_apply(net, &s.section, s.sources, pulse);
		add_errors(&score, &s, pulse);
		pulses += s.sources;
	}
	score.count_right /= (double)sections;
	score.arrival = sqrt(score.arrival / pulses) / CNNDATA_DURATION;
	score.delay = sqrt(score.delay / pulses) / CNNDATA_DURATION;
	score.alone = sqrt(score.alone / pulses) / CNNDATA_DURATION;
	score.size = sqrt(score.size / pulses);
	return score;
}
