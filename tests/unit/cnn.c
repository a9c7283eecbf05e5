/* Resampling of sections to the grid of the networks, and its inverse */
#include "net/cnndata.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

enum { N = 1024 };

/* Two pulses of duration T: amplitudes 1 and 0.6, delays 0.02 and -0.01 durations. */
static void draw_scene(
	double T, double gain, double scale, double later, double *y1, double *y2)
{
	static const double at[] = { 0.8, 1.3 }, delay[] = { 0.02, -0.01 },
			    a[] = { 1, 0.6 };

	for (int i = 0; i < N; i++) {
		y1[i] = y2[i] = 0;
		for (int k = 0; k < 2; k++) {
			double s = i / T - at[k];

			y1[i] += scale * a[k] * pulse_value(PULSE_GAUSS, s);
			y2[i] += scale * gain * a[k] *
				 pulse_value(PULSE_GAUSS, s - delay[k] - later / T);
		}
	}
}

static double difference(const network_real *a, const network_real *b)
{
	double worst = 0;

	for (int i = 0; i < 2 * CNN_POINTS; i++)
		worst = tap_max(worst, fabs((double)a[i] - b[i]));
	return worst;
}

/* The same scene by other instruments gives the same grid. */
static void check_invariance(void)
{
	static double y1[N], y2[N];
	network_real want[2 * CNN_POINTS], got[2 * CNN_POINTS];
	struct cnn_section s = { y1, y2, 500, 100, 1, 0, 3 };
	struct cnn_frame f;

	draw_scene(100, 1, 1, 0, y1, y2);
	ok(cnn_lay(&s, want, &f), "a section is put on the grid");
	near(f.scale, 0.99, 0.02, "the scale is the peak of the section");
	draw_scene(100, 1, 7, 0, y1, y2);
	cnn_lay(&s, got, &f);
	ok(difference(got, want) < 1e-5, "seven times the voltage gives the same grid");
	draw_scene(100, 0.5, 1, 0, y1, y2);
	s.gain = 0.5;
	cnn_lay(&s, got, &f);
	ok(difference(got, want) < 2e-2,
		"half the gain on a channel gives the same grid within %.2g",
		difference(got, want));
	s.gain = 1;
	draw_scene(200, 1, 1, 0, y1, y2);
	s = (struct cnn_section){ y1, y2, 1000, 200, 1, 0, 6 };
	cnn_lay(&s, got, &f);
	ok(difference(got, want) < 3e-2,
		"twice the sampling rate gives the same grid within %.2g",
		difference(got, want));
	/* A common delay is subtracted; the centre of energy moves by half of it. */
	draw_scene(100, 1, 1, 8, y1, y2);
	s = (struct cnn_section){ y1, y2, 500, 100, 1, 8, 3 };
	cnn_lay(&s, got, &f);
	s.y1 = y1 + 4;
	s.y2 = y2 + 4;
	s.n = 496;
	cnn_lay(&s, want, &f);
	ok(difference(got, want) < 1e-3,
		"the grid does not depend on where the section is cut, within %.2g",
		difference(got, want));
}

static void check_refusals(void)
{
	static double y1[N], y2[N];
	network_real x[2 * CNN_POINTS];
	struct cnn_frame f;
	struct cnn_section s = { y1, y2, 500, 100, 1, 0, 3 };

	ok(!cnn_lay(&s, x, &f), "a section of zeros is refused");
	draw_scene(100, 1, 1, 0, y1, y2);
	s.n = 513;
	ok(!cnn_lay(&s, x, &f), "a section longer than 5.12 durations is refused");
	s.n = 500;
	s.reach = 26;
	ok(!cnn_lay(&s, x, &f), "delays beyond the trained reach are refused");
	s.reach = 3;
	s.duration = 10;
	ok(!cnn_lay(&s, x, &f), "a sampling that is too coarse is refused");
	s.duration = NAN;
	ok(!cnn_lay(&s, x, &f), "a pulse duration of zero is refused");
}

/* Sections have the stated pulses, order, spacing and noise. */
static void check_sections(void)
{
	struct cnndata_par par = cnndata_default();
	struct cnndata_section *s = malloc(sizeof *s);
	double worst = 0, squares = 0, count = 0;
	int ordered = 1, counts[CNN_SOURCES + 1] = { 0 };

	for (uint32_t i = 0; i < 200; i++) {
		par.snr[0] = par.snr[1] = i % 2 ? 300 : 20;
		cnndata_section(&par, i, s);
		counts[s->sources]++;
		for (int k = 1; k < s->sources; k++)
			ordered = ordered && s->pulse[k].t - s->pulse[k - 1].t >= 9.999;
		for (size_t n = 0; n < CNNDATA_SAMPLES; n++) {
			double y1 = 0, y2 = 0;

			for (int k = 0; k < s->sources; k++) {
				const struct cnn_pulse *p = &s->pulse[k];
				double T = 100 + p->delta / 1.9635, t = (double)n - p->t;

				y1 += p->a * pulse_value(PULSE_SINE, t / T);
				y2 += s->section.gain * p->a *
				      pulse_value(PULSE_SINE, (t - p->delta) / T);
			}
			if (i % 2) {
				worst = tap_max(worst, fabs(s->y1[n] - y1));
				worst = tap_max(worst, fabs(s->y2[n] - y2));
			} else {
				squares += pow(s->y1[n] - y1, 2) + pow(s->y2[n] - y2, 2);
				count += 2;
			}
		}
	}
	ok(worst < 1e-11, "sections are the sums of their pulses to %.1g", worst);
	ok(ordered, "arrivals ascend and are a tenth of a duration apart");
	near(sqrt(squares / count), 0.1, 4 * 0.1 / sqrt(2 * count),
		"the noise is that of 20 dB");
	ok(counts[1] > 25 && counts[2] > 25 && counts[3] > 25 && counts[4] > 25,
		"sections have one to four pulses");
	free(s);
}

/* Targets used as outputs give the pulses back. */
static void check_way_back(void)
{
	struct cnndata_par par = cnndata_default();
	struct cnndata_section *s = malloc(sizeof *s);
	double worst = 0;
	int right = 1;

	for (uint32_t i = 0; i < 100; i++) {
		network_real x[2 * CNN_POINTS], target[CNNDATA_TARGETS],
			out[CNN_OUTPUTS] = { 0 };
		struct cnn_pulse p[CNN_SOURCES];
		struct cnn_frame f;

		cnndata_section(&par, i, s);
		cnndata_target(s, x, target);
		cnn_lay(&s->section, x, &f);
		out[s->sources - 1] = 1;
		memcpy(out + cnn_head(s->sources), target + 1,
			3 * (size_t)s->sources * sizeof *target);
		right = right && cnn_pulses(out, &f, 0, p) == s->sources;
		for (int k = 0; k < s->sources; k++) {
			worst = tap_max(worst, fabs(p[k].t - s->pulse[k].t));
			worst = tap_max(worst, fabs(p[k].delta - s->pulse[k].delta));
			worst = tap_max(worst, fabs(p[k].a - s->pulse[k].a));
		}
	}
	ok(right && worst < 1e-4, "targets give back the pulses to %.1g", worst);
	free(s);
}

int main(void)
{
	check_invariance();
	check_refusals();
	check_sections();
	check_way_back();
	return tap_done();
}
