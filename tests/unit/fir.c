/* Taps against scipy's firwin, the response, and streaming against plain convolution. */
#include "signal/filter/fir.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

static const char *const windows[] = { "hamming", "hann", "blackman", "kaiser" };

static enum fir_window window_of(const char *name)
{
	int w = 0;

	while (strcmp(name, windows[w]) != 0)
		w++;
	return (enum fir_window)w;
}

/* tests/data/firwin.tsv: order low high window beta scale k tap */
static void test_taps(void)
{
	FILE *in = fopen("tests/data/firwin.tsv", "r");
	char line[256], name[16];
	double low, high, beta, tap, worst = 0;
	int order, scale, k, rows = 0;

	if (!ok(in != NULL, "the reference table tests/data/firwin.tsv can be read"))
		return;
	while (fgets(line, sizeof line, in)) {
		double *h;

		if (sscanf(line, "%d %lf %lf %15s %lf %d %d %lf", &order, &low, &high,
			    name, &beta, &scale, &k, &tap) != 8)
			continue;
		h = malloc(((size_t)order + 1) * sizeof *h);
		fir_design(&(struct fir_band){ order, low / 1e4, high / 1e4,
				   window_of(name), beta, scale },
			h);
		worst = tap_max(worst, fabs(h[k] - tap));
		if (fabs(h[k] - tap) > 1e-14)
			printf("# %s# got %.17g\n", line, h[k]);
		rows++;
		free(h);
	}
	fclose(in);
	ok(rows > 90 && worst <= 1e-14, "%d taps equal scipy's to 1e-14 (%.1g)", rows,
		worst);
}

static void test_edges(void)
{
	struct fir_band all = { 40, 0, 0.5, FIR_HAMMING, 0, 0 };
	struct fir_band odd = { 41, 0.3, 0.5, FIR_HAMMING, 0, 1 };
	double h[42], sum = 0;

	fir_design(&all, h);
	for (int k = 0; k <= 40; k++)
		sum += fabs(h[k]);
	ok(fabs(h[20] - 1) < 1e-15 && fabs(sum - 1) < 1e-14,
		"the whole band gives the identity filter");
	ok(fir_design(&odd, h) == NUM_DOMAIN,
		"an odd order cannot be scaled at half the rate");
	/* kaiser_beta() of scipy 1.10 */
	near(fir_kaiser_beta(80), 7.857259999999999, 1e-13,
		"Kaiser's beta at 80 dB is right");
	near(fir_kaiser_beta(40), 3.3953210522614574, 1e-13,
		"Kaiser's beta at 40 dB is right");
	near(fir_kaiser_beta(10), 0, 0, "Kaiser's beta at 10 dB is right");
}

static double level(const double *h, double f)
{
	double re, im;

	fir_response(h, 201, f / 1e4, 0, &re, &im);
	return 20 * log10(hypot(re, im));
}

/* Li's filter: 200 taps at 10 kHz are too few for 70-130 Hz. */
static void test_response(void)
{
	static const double want[][2] = { { 0, -24.5 }, { 20, -17.4 }, { 50, -6.3 },
		{ 70, -2.2 }, { 100, 0 }, { 130, -2.1 }, { 150, -6.2 }, { 200, -30.5 },
		{ 250, -50.6 }, { 2000, -61.9 }, { 4000, -61.8 } };
	struct fir_band band = { 200, 0.007, 0.013, FIR_HAMMING, 0, 1 };
	double h[201], re, im, worst = 0;

	fir_design(&band, h);
	for (size_t i = 0; i < sizeof want / sizeof *want; i++)
		worst = tap_max(worst, fabs(level(h, want[i][0]) - want[i][1]));
	ok(worst <= 0.0501,
		"the levels of the Hamming band 70-130 Hz of order 200 are right (%.3f dB)",
		worst);
	fir_response(h, 201, 0.01, 100, &re, &im);
	ok(fabs(re - 1) < 1e-13 && fabs(im) < 1e-13,
		"the middle of the band has gain 1 and phase 0");
	fir_response(h, 201, 0.0123, 0, &re, &im);
	near(remainder(atan2(im, re) + 2 * M_PI * 1.23, 2 * M_PI), 0, 1e-12,
		"the delay of the filter is half its order");
	band.scale = 0;
	fir_design(&band, h);
	near(level(h, 100), -4.57, 0.005,
		"without scaling the middle of the band is at -4.57 dB");
}

/* Two channels through any split, against the sum itself.  Samples are below 1; rounding
 * grows with the logarithm of the transform. */
static void test_stream(int order, size_t block, size_t nframes)
{
	struct fir_band band = { order, 0.05, 0.2, FIR_HAMMING, 0, 1 };
	size_t taps = (size_t)order + 1;
	double *h = malloc(taps * sizeof *h), *x = malloc(2 * nframes * sizeof *x);
	double *y = malloc(2 * nframes * sizeof *y), worst = 0;
	struct fir *fir;
	unsigned state = 1;

	fir_design(&band, h);
	for (size_t i = 0; i < 2 * nframes; i++)
		y[i] = x[i] =
			(double)(state = state * 1664525u + 1013904223u) / 4294967296.0;
	fir = fir_new(h, taps, 2, block);
	for (size_t i = 0, step = 1; i < nframes; i += step) {
		step = (i * 7919 + 13) % fir_block(fir) + 1;
		if (step > nframes - i)
			step = nframes - i;
		fir_run(fir, y + 2 * i, step);
	}
	for (size_t i = 0; i < nframes; i++)
		for (size_t c = 0; c < 2; c++) {
			double sum = 0;

			for (size_t k = 0; k < taps && k <= i; k++)
				sum += h[k] * x[2 * (i - k) + c];
			worst = tap_max(worst, fabs(sum - y[2 * i + c]));
		}
	ok(worst < 5e-15,
		"order %d, %zu frames in blocks of at most %zu (%s): the convolution is right to %.1g",
		order, nframes, fir_block(fir),
		fir_transform(fir) ? "transform" : "direct", worst);
	fir_free(fir);
	free(h);
	free(x);
	free(y);
}

static int same_band(const struct fir_band *a, const struct fir_band *b)
{
	/* Edges pass a multiplication by the rate and a division: two roundings each. */
	return a->order == b->order && a->window == b->window && a->beta == b->beta &&
	       a->scale == b->scale && fabs(a->low / b->low - 1) < 3e-16 &&
	       fabs(a->high / b->high - 1) < 3e-16;
}

/* Bands to text and back. */
static void test_words(void)
{
	char text[FIR_TEXT], chain[2 * FIR_TEXT + 3] = "";
	struct fir_band got, all = { 1000000, 0, 0.5, FIR_KAISER, 7.857259999999999, 1 };
	const char *rest;

	for (int w = 0; w < 4; w++) {
		struct fir_band band = { 200 + w, 0.1 / 3, 0.2 + 0.07 * w,
			window_of(windows[w]), w == 3 ? 100 / 7.0 : 0, w % 2 };

		fir_print(&band, 44100.0 / 7, text);
		rest = fir_parse(text, 44100.0 / 7, &got);
		ok(rest && !*rest && same_band(&got, &band),
			"the description '%s' is read back", text);
		if (w >= 2)
			strcat(strcat(chain, w == 3 ? " | " : ""), text);
	}
	rest = fir_parse(chain, 44100.0 / 7, &got);
	ok(rest && strcmp(rest, text) == 0 && got.window == FIR_BLACKMAN,
		"the first filter of a chain is read");
	rest = rest ? fir_parse(rest, 44100.0 / 7, &got) : NULL;
	ok(rest && !*rest && got.window == FIR_KAISER,
		"the second filter of a chain is read");
	fir_print(&all, 48000, text);
	rest = fir_parse(text, 48000, &got);
	ok(rest && !*rest && got.low == 0 && got.high == 0.5 && got.order == 1000000,
		"the longest description of a band is complete: %s", text);
	fir_print(&(struct fir_band){ 1000000, 1.0 / 3e9, 0.4 / 3, FIR_BLACKMAN,
			  -1.0 / 3e-290, 0 },
		1.0 / 3, text);
	ok(strlen(text) + 1 < FIR_TEXT && strstr(text, " plain"),
		"there is room for the longest description: %s", text);
}

static void test_nonsense(void)
{
	static const char *const bad[] = { "", "hamming", "70:130 200 hamming 0",
		"70:130 200 welch 0 scaled", "70:130 200 Hamming 0 scaled",
		"130:70 200 hamming 0 scaled", "70:70 200 hamming 0 scaled",
		"-1:130 200 hamming 0 scaled", "70:5001 200 hamming 0 scaled",
		"nan:130 200 hamming 0 scaled", "70:nan 200 hamming 0 scaled",
		"70:inf 200 hamming 0 scaled", "70:130 0 hamming 0 scaled",
		"70:130 -2 hamming 0 scaled", "70:130 1000001 hamming 0 scaled",
		"70:130 4294967496 hamming 0 scaled",           /* 2^32 + 200 */
		"70:130 18446744073709551816 hamming 0 scaled", /* 2^64 + 200 */
		"70:130 200.5 hamming 0 scaled", "70:130 200 kaiser nan scaled",
		"70:130 200 kaiser 1e9 scaled", "70:130 200 hamming 0 scale",
		"70:130 200 hamming 0 scaledandmore", "70:130 200 hamming 0 scaled more",
		"70:130 200 hamming 0 scaled|80:90 200 hamming 0 scaled",
		"70:130 200 hamming 0 scaled 80:90 200 hamming 0 scaled",
		"70:130 200 hamming 0 scaled | " };
	struct fir_band band;

	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		ok(!fir_parse(bad[i], 1e4, &band), "the description '%s' is refused",
			bad[i]);
}

int main(void)
{
	test_taps();
	test_edges();
	test_response();
	test_words();
	test_nonsense();
	test_stream(2, 0, 1000);
	test_stream(7, 0, 9000);
	test_stream(200, 0, 6000);
	test_stream(200, 100, 3000);
	test_stream(200, 1, 300);
	test_stream(200, 0, 50);
	test_stream(3000, 0, 9000);
	return tap_done();
}
