/* origin.c - see examples.h */
#include "num/fft.h"
#include "signal/learn/examples.h"
#include <math.h>
#include <string.h>

/* The mean pulse of a sensor. */
struct mean_pulse {
	double *x; /* 2 half + 1 samples */
	double complex *spectrum;
	double complex *model; /* the same of the shape */
	double energy;         /* sum of the squared amplitudes of its pulses */
};

/* Phases of sensor 2 over those of sensor 1, where both stand above their noise: the
 * delay at which they agree best, and how much single frequencies differ from it beyond
 * their noise.  Each counts by the information that the mean pulses have of it. */
static void compare_phases(
	const struct mean_pulse mean[2], size_t points, struct calibration *c)
{
	double noise[2], square = 0, moment = 0, weight = 0;
	int n = 0;

	for (int k = 0; k < 2; k++)
		noise[k] = (double)points / mean[k].energy;
	for (size_t i = 1; i <= points / 2; i++) {
		double w = 2 * M_PI * (double)i / (double)points, power[2], phase, sure;
		double complex cross;

		for (int k = 0; k < 2; k++) {
			double size = cabs(mean[k].model[i]);

			power[k] = size * size / noise[k];
		}
		if (!(power[0] > 1 && power[1] > 1))
			continue;
		cross = conj(mean[0].spectrum[i]) * mean[1].spectrum[i];
		phase = atan(cimag(cross) / creal(cross)); /* of either sign */
		sure = 2 / (1 / power[0] + 1 / power[1]);
		weight += sure * w * w;
		moment += sure * w * phase;
		square += sure * phase * phase;
		n++;
	}
	if (!(weight > 0))
		return;
	c->origin = -moment / weight;
	square -= moment * moment / weight + n - 1;
	c->origin_se = sqrt(fmax(square, 0) / weight);
}

enum num_status find_origin(struct examples *ex, struct calibration *c)
{
	const struct joint_scene *s = &ex->scene;
	int half =
		(int)((shape_reach(s->shape) * fmax(s->width, 1) + 0.75) * s->duration);
	size_t points = fft_fast_size(2 * (size_t)half + 1);
	size_t stride = (points + 7) / 8 * 8; /* see FFT_ALIGNMENT */
	struct fft *fft = fft_new_forward(points);
	double *x = fft_alloc(3 * stride);
	double complex *spectrum = fft_alloc_complex(4 * stride);
	struct mean_pulse mean[2];
	enum num_status status = fft && x && spectrum ? NUM_OK : NUM_MEMORY;

	for (int k = 0; status == NUM_OK && k < 2; k++)
		mean[k] = (struct mean_pulse){ .x = x + (size_t)k * stride,
			.spectrum = spectrum + (size_t)(2 * k) * stride,
			.model = spectrum + (size_t)(2 * k + 1) * stride };
	for (int i = 0; status == NUM_OK && i < ex->count; i++) {
		struct example *e = &ex->example[i];
		struct joint_result result;

		if (e->outlier || examples_refine(ex, e, e->pulse, &result) != JOINT_OK)
			continue;
		for (int p = 0; p < 2 * e->m; p++) {
			double a = examples_amplitude(ex, e, p);

			mean[p % 2].energy += a * a;
			examples_add_residual(ex, e, p, 1, half, mean[p % 2].x, NULL);
		}
	}
	for (int k = 0; status == NUM_OK && k < 2; k++) {
		double *model = x + 2 * stride;

		shape_sample(s->shape, 0, joint_duration(s, 0, k), -half, points, model,
			NULL, NULL);
		for (size_t i = 0; i < points; i++)
			mean[k].x[i] = model[i] + mean[k].x[i] / mean[k].energy;
		fft_forward(fft, mean[k].x, mean[k].spectrum);
		fft_forward(fft, model, mean[k].model);
	}
	if (status == NUM_OK)
		compare_phases(mean, points, c);
	fft_free(x);
	fft_free(spectrum);
	fft_done(fft);
	return status;
}
