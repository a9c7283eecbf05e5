/* crowd.c - see crowd.h */
#include "signal/learn/crowd.h"
#include "num/periodogram.h"
#include "signal/learn/calibration.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The spectrum of a pulse of STEPS samples at PADDED / 2 frequencies, each 1 / FINE of a
 * cycle per duration after the other. */
enum { STEPS = 256, FINE = 32, PADDED = STEPS * FINE };

struct spectrum {
	double *power;            /* mean of both channels; 1 where there is only noise */
	size_t first, bins, size; /* frequencies used: [first, bins) */
};

/* Cycles per hop below which the record lacks what was taken for its offset, or has what
 * was taken so in vain: straight lines between the errors at hops have 0.7 % of their
 * power beyond one cycle, and 0.03 % beyond four. */
static const double SLOW = 4;

static enum num_status pulse_spectrum(int pulse, double *power)
{
	struct shape *shape = shape_new((enum pulse_shape)pulse);
	struct periodogram *p = periodogram_new(PADDED);

	if (shape && p) {
		shape_sample(shape, 0.5 * PADDED, STEPS, 0, PADDED, p->x, NULL, NULL);
		memset(power, 0, PADDED / 2 * sizeof *power);
		periodogram_add(p, 1, power, PADDED / 2);
	}
	shape_free(shape);
	periodogram_free(p);
	return shape && p ? NUM_OK : NUM_MEMORY;
}

/* Twice the negative logarithm of the likelihood of the periodogram, at the most likely
 * power *amount of all pulses, which Fisher scoring starts from. */
static double unlikelihood(
	const struct spectrum *p, const double *pulse, double duration, double *amount)
{
	enum { ROUNDS = 30 };
	double step = duration * FINE / (double)p->size, sum = 0, a = *amount;

	for (int round = 0; round < ROUNDS; round++) {
		double num = 0, den = 0, before = a;

		sum = 0;
		for (size_t k = p->first; k < p->bins; k++) {
			double x = step * (double)k, s, share;
			size_t i = (size_t)x;

			if (i + 1 >= PADDED / 2)
				break;
			share = pulse[i] + (x - (double)i) * (pulse[i + 1] - pulse[i]);
			s = 1 + a * share;
			share /= s;
			sum += log(s) + p->power[k] / s;
			num += share * (p->power[k] - 1) / s;
			den += share * share;
		}
		a = den > 0 && num > 0 ? num / den : 0;
		if (fabs(a - before) <= 1e-6 * before)
			break;
	}
	*amount = a;
	return 2 * sum;
}

/* Moves *duration to the most likely one: the best of a grid, then steps that shrink. */
static double best_duration(
	const struct spectrum *p, const double *pulse, double guess, double *duration)
{
	enum { GRID = 14 };
	double least = INFINITY, amount = 1, step = log(2) / GRID;

	for (int k = -GRID; k <= GRID; k++) {
		double T = guess * exp(k * step);
		double trial = unlikelihood(p, pulse, T, &amount);

		if (trial < least) {
			least = trial;
			*duration = T;
		}
	}
	while (step > 1e-4) {
		double before = least, at = *duration;

		for (int side = -1; side <= 1; side += 2) {
			double T = at * exp(side * step);
			double trial = unlikelihood(p, pulse, T, &amount);

			if (trial < least) {
				least = trial;
				*duration = T;
			}
		}
		if (least >= before)
			step /= 2;
	}
	return least;
}

/* Standard error of the most likely duration, relative: the curvature there. */
static double duration_error(
	const struct spectrum *p, const double *pulse, double duration)
{
	const double h = 0.01;
	double amount = 1, bend = 0;

	for (int k = -1; k <= 1; k++)
		bend += (k ? 1 : -2) *
			unlikelihood(p, pulse, duration * (1 + k * h), &amount);
	return bend > 0 ? h * sqrt(2 / bend) : INFINITY;
}

static enum num_status choose(const struct spectrum *p, double guess, int *pulse,
	double *duration, double *error)
{
	double least = INFINITY, known = *duration;
	double *spectrum = malloc(PADDED / 2 * sizeof *spectrum);
	enum num_status status = spectrum ? NUM_OK : NUM_MEMORY;
	int only = *pulse;

	for (int k = 0; k < PULSE_SHAPES && status == NUM_OK; k++) {
		double T = known, amount = 1, trial;

		if (only != CALIBRATE_ANY_PULSE && only != k)
			continue;
		status = pulse_spectrum(k, spectrum);
		if (status != NUM_OK)
			break;
		trial = isnan(known) ? best_duration(p, spectrum, guess, &T)
				     : unlikelihood(p, spectrum, T, &amount);
		if (trial < least) {
			least = trial;
			*pulse = k;
			*duration = T;
			*error = duration_error(p, spectrum, T);
		}
	}
	free(spectrum);
	return status;
}

/* Tapered, strong frequencies do not leak into the zeros of the spectrum of a pulse,
 * which tell its duration. */
enum num_status crowd_pulse(const double *y1, const double *y2, size_t n, size_t hop,
	double guess, int *pulse, double *duration, double *error)
{
	size_t size = fft_good_size(n), most = size / 2 + 1;
	double band = SHAPE_BAND * (double)size / guess,
	       scale = 0.5 / (HANN_SQUARE * (double)n);
	struct spectrum p = { .size = size,
		.first = 1 + (size_t)(SLOW * (double)size / (double)hop),
		.bins = band < (double)most ? (size_t)band : most };
	struct periodogram *sum = periodogram_new(size);
	enum num_status status = NUM_MEMORY;

	p.power = calloc(p.bins + 1, sizeof *p.power);
	if (p.power && sum) {
		periodogram_add_hann(sum, y1, n, scale, p.power, p.bins);
		periodogram_add_hann(sum, y2, n, scale, p.power, p.bins);
		status = choose(&p, guess, pulse, duration, error);
	}
	periodogram_free(sum);
	free(p.power);
	return status;
}
