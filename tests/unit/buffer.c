/* Means of the samples of a channel: values, indices, and samples that were not measured
 */
#include "signal/separate/buffer.h"
#include "num/philox.h"
#include "signal/separate/converter.h"
#include "tap.h"
#include <math.h>

enum { N = 4000, RATIO = 16, DROPPED = 37, STILL = 1000, STANDS = 70 };

static double x[N];
static size_t lost[N];

/* Noise, which stands still for STANDS samples from STILL on. */
static void draw(void)
{
	struct converter converter = { .samples = 0 };
	double z[2];

	for (uint64_t i = 0; i < N; i++) {
		philox_normal2(3, 0, RNG_NOISE, i, z);
		x[i] = 5 + (i < STILL || i >= STILL + STANDS ? z[0] : 0);
		lost[i] = converter_next(&converter, &x[i]);
	}
}

static int are_equal(const struct buffer *a, const struct buffer *b)
{
	for (size_t i = 0; i < a->n && i < b->n; i++)
		if (a->x[i] != b->x[i] || a->hidden[i] != b->hidden[i])
			return 0;
	return a->n == b->n && a->begin == b->begin;
}

/* Whitening starts before there is a mean, as with an instrument that is kept, or with
 * all of them: a level, which the taps remove, leaves nothing at either end. */
static void test_start(void)
{
	double tap[] = { -0.5, 1, -0.5 };
	const struct calibration c = { .whitening = { .half = 1, .tap = tap } };
	struct buffer early = { .ratio = RATIO }, late = { .ratio = RATIO };
	double ends;

	for (size_t i = 0; i < N; i++)
		x[i] = 1e3 + (i < N / 2 ? 0 : x[i]);
	if (buffer_append(&early, x, lost, 1) != NUM_OK ||
		buffer_start(&early, &c, 0, 1) != NUM_OK ||
		buffer_append(&early, x + 1, lost + 1, N - 1) != NUM_OK ||
		buffer_append(&late, x, lost, N) != NUM_OK ||
		buffer_start(&late, &c, 0, 1) != NUM_OK)
		return;
	ends = 0.5 * (late.x[late.n - 1] - late.x[late.n - 2]);
	if (buffer_prepare(&early, &c, 1) != NUM_OK ||
		buffer_prepare(&late, &c, 1) != NUM_OK)
		return;
	ok(are_equal(&early, &late), "whitening may start before the first mean");
	near(late.x[0], 0, 1e-9, "a level before the record is that of its first sample");
	near(late.x[late.n - 1], ends, 1e-9, "a level after it is that of its last one");
	buffer_clear(&early);
	buffer_clear(&late);
}

int main(void)
{
	struct buffer fine = { .n = 0 }, mean = { .n = 0 }, direct = { .ratio = RATIO };
	double largest = 0, sum = 0;
	int hidden = 0;

	draw();
	if (buffer_append(&fine, x, lost, N) != NUM_OK ||
		buffer_average(&fine, N, RATIO, &mean) != NUM_OK)
		return 1;
	ok(mean.n == N / RATIO && mean.begin == 0, "there is one mean of 16 samples");
	for (size_t k = 0; k < mean.n; k++) {
		double m = 0;

		for (size_t i = 0; i < RATIO; i++)
			m += x[RATIO * k + i] / RATIO;
		largest = fmax(largest, fabs(mean.x[k] - m));
		if (!mean.hidden[k])
			sum += (mean.x[k] - 5) * (mean.x[k] - 5) * RATIO;
		hidden += mean.hidden[k];
	}
	ok(largest < 1e-14, "means are those of the samples given");
	/* 245 means: a standard error of 9 %. */
	ok(fabs(sum / (double)mean.n - 1) < 0.3,
		"noise falls as the root of their number");
	ok(hidden == 5 && mean.hidden[STILL / RATIO] &&
			mean.hidden[(STILL + STANDS - 1) / RATIO],
		"a mean with a sample that was not measured is hidden, and no other");

	/* Piece by piece; the run is found only after some of its means are there. */
	for (size_t at = 0; at < N; at += 7)
		if (buffer_append(&direct, x + at, lost + at, at + 7 < N ? 7 : N - at) !=
			NUM_OK)
			return 1;
	ok(are_equal(&mean, &direct), "samples averaged as they arrive give the same");

	buffer_discard(&fine, DROPPED);
	buffer_clear(&mean);
	if (buffer_average(&fine, fine.n, RATIO, &mean) != NUM_OK)
		return 1;
	ok(mean.begin == DROPPED / RATIO + 1, "the first mean has a whole index");
	ok(mean.x[0] == direct.x[mean.begin],
		"the first mean is that of the same samples");
	buffer_clear(&fine);
	buffer_clear(&mean);
	buffer_clear(&direct);
	test_start();
	return tap_done();
}
