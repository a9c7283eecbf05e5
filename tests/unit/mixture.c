/* Two and three sources separated in a whole record by their spectra. */
#include "signal/mixture/mixture.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

enum { RATE = 16000, N = 3 * RATE, VOICES = 3 };

/* Harmonics of a pitch that glides, in syllables; delays are exact. */
static double voice(int k, double t)
{
	static const double pitch[] = { 117, 211, 163 }, beat[] = { 2.3, 3.1, 2.7 };
	double glide = 0.08 * sin(2 * M_PI * 0.6 * t + k) / (2 * M_PI * 0.6);
	double turn = 2 * M_PI * pitch[k] * (t + glide), y = 0;
	double loud = fmax(sin(2 * M_PI * beat[k] * t + 2 * k), 0);

	for (int h = 1; h <= 20; h++) {
		double formant = (h * pitch[k] - 500 * (k + 1)) / 600;

		y += sin(h * turn + h * h) / (1 + formant * formant);
	}
	return y * loud * loud;
}

static double sdr(const double *got, const double *want)
{
	double gw = 0, ww = 0, error = 0;

	for (int i = 0; i < N; i++) {
		gw += got[i] * want[i];
		ww += want[i] * want[i];
	}
	for (int i = 0; i < N; i++)
		error += pow(got[i] - gw / ww * want[i], 2);
	return 10 * log10(gw * gw / ww / error);
}

static void try_mixture(int voices, const double *a, const double *delta, double least)
{
	double *x = calloc(2 * N, sizeof *x), *s = calloc((size_t)voices * N, sizeof *s);
	double *y = calloc((size_t)voices * N, sizeof *y), worst = 0, energy = 0,
	       whole = 0;
	struct mixture_par par = { .window = 1024, .hop = 256 };
	struct mixture *m = mixture_new(&par);
	struct mixture_source source[MIXTURE_SOURCES];
	int count;

	for (int k = 0; k < voices; k++)
		for (int i = 0; i < N; i++) {
			s[k * N + i] = voice(k, i / (double)RATE);
			x[2 * i] += s[k * N + i];
			x[2 * i + 1] += a[k] * voice(k, (i - delta[k]) / RATE);
		}
	for (int i = 0; i < N; i += 999)
		mixture_push(m, x + 2 * i, (size_t)(N - i < 999 ? N - i : 999));
	count = mixture_find(m, source);
	ok(count == voices, "%d sources are found", voices);
	mixture_separate(m, y);
	for (int k = 0; k < count && count == voices; k++) {
		int best = 0;

		for (int j = 0; j < voices; j++)
			if (fabs(source[j].delta - delta[k]) <
				fabs(source[best].delta - delta[k]))
				best = j;
		near(source[best].delta, delta[k], 0.1,
			"the delay of each source is right");
		near(source[best].attenuation, a[k], 0.05,
			"the attenuation of each source is right");
		/* one channel throughout: the whole of it against the whole voice */
		ok(sdr(y + best * N, s + k * N) > least,
			"source %d is separated: %.1f dB, mixed %.1f dB", k,
			sdr(y + best * N, s + k * N), -10 * log10(voices - 1));
	}
	for (int i = 0; i < N; i++) {
		double sum = 0;

		for (int k = 0; k < count; k++)
			sum += y[k * N + i];
		worst = tap_max(worst, fabs(sum - x[2 * i]));
		energy += sum * sum;
		whole += x[2 * i] * x[2 * i];
	}
	ok(worst < 1e-12 * sqrt(whole), "the sources add up to channel 1 (%.1g)", worst);
	near(energy / whole, 1, 1e-12, "the sources have all of the energy of channel 1");
	mixture_free(m);
	free(x);
	free(s);
	free(y);
}

static void test_edges(void)
{
	struct mixture_par par = { .window = 64, .hop = 16 };
	struct mixture *m;
	struct mixture_source source[MIXTURE_SOURCES];
	double x[2] = { 0 };

	ok(!mixture_new(&(struct mixture_par){ .window = 63, .hop = 16 }) &&
			!mixture_new(&(struct mixture_par){ .window = 64, .hop = 33 }) &&
			!mixture_new(&(struct mixture_par){
				.window = 64, .hop = 16, .sources = 17 }),
		"impossible sizes are refused");
	m = mixture_new(&par);
	ok(mixture_find(m, source) == 0, "an empty record has no sources");
	mixture_push(m, x, 1);
	ok(mixture_find(m, source) == 0, "a record of zeros has no sources");
	mixture_free(m);
}

int main(void)
{
	try_mixture(2, (double[]){ 1.1, 0.9 }, (double[]){ -0.8, 0.7 }, 9);
	try_mixture(2, (double[]){ 1, 0.9 }, (double[]){ 7.5, -6.5 }, 9);
	try_mixture(3, (double[]){ 1.1, 0.9, 1 }, (double[]){ -1.2, 0.1, 1.4 }, 7);
	test_edges();
	return tap_done();
}
