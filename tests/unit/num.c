/* Random bits, the thread pool and Fourier transforms */
#include "num/cholesky.h"
#include "num/dot.h"
#include "num/fft.h"
#include "num/lanes.h"
#include "num/parabola.h"
#include "num/philox.h"
#include "num/pool.h"
#include "num/rng.h"
#include "num/room.h"
#include "num/select.h"
#include "num/standing.h"
#include "tap.h"
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* The three known answers published with Random123 (kat_vectors). */
static void test_philox(void)
{
	static const struct {
		uint32_t counter[4], key[2], want[4];
	} known[] = {
		{ { 0, 0, 0, 0 }, { 0, 0 },
			{ 0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8 } },
		{ { 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff },
			{ 0xffffffff, 0xffffffff },
			{ 0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd } },
		{ { 0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344 },
			{ 0xa4093822, 0x299f31d0 },
			{ 0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1 } },
	};
	uint32_t out[4];

	for (int i = 0; i < 3; i++) {
		philox4x32(known[i].counter, known[i].key, out);
		ok(!memcmp(out, known[i].want, sizeof out),
			"Philox4x32-10 gives the known answer %d", i + 1);
	}
}

/* A row is the blocks of successive counters, also where the low word turns over. */
static void test_philox_row(void)
{
	static const uint32_t low[] = { 0, 0xfffffff8, 0x12345678 }, key[2] = { 3, 9 };
	int differ = 0;

	for (int i = 0; i < 3; i++) {
		uint32_t counter[4] = { low[i], 0xffffffff, 5, 6 };
		uint32_t row[4][PHILOX_ROW], out[4];

		philox4x32_row(counter, key, row);
		for (int k = 0; k < PHILOX_ROW; k++) {
			philox4x32(counter, key, out);
			for (int w = 0; w < 4; w++)
				differ += out[w] != row[w][k];
			counter[1] += ++counter[0] == 0;
		}
	}
	ok(differ == 0, "a row of blocks equals the blocks one by one");
}

static void test_rng(void)
{
	gsl_rng *a = rng_new(1, 2, RNG_NOISE), *b = rng_new(1, 2, RNG_NOISE);
	gsl_rng *c = rng_new(1, 3, RNG_NOISE), *d = rng_new(1, 2, RNG_FILTER);
	gsl_rng *e = rng_new(1ULL << 32 | 1, 2, RNG_NOISE);
	uint32_t counter[4] = { 1, 0, 2, RNG_NOISE }, key[2] = { 1, 0 }, block[4];
	unsigned long x[5], y[5];
	int same = 1, differs = 1;
	double sum = 0, square = 0;
	enum { N = 200000 };

	for (int i = 0; i < 5; i++) {
		x[i] = gsl_rng_get(a);
		y[i] = gsl_rng_get(b);
		same &= x[i] == y[i];
		differs &= x[i] != gsl_rng_get(c) && x[i] != gsl_rng_get(d) &&
			   x[i] != gsl_rng_get(e);
	}
	ok(same, "equal streams give equal numbers");
	ok(differs,
		"realisation, purpose and the high half of the seed each change the stream");
	philox4x32(counter, key, block);
	ok(x[4] == block[0], "the fifth number is the first of the second block");
	for (int i = 0; i < N; i++) {
		double z = gsl_ran_gaussian_ziggurat(a, 1);

		sum += z;
		square += z * z;
	}
	/* Four standard errors: 4 / sqrt(N) and 4 sqrt(2 / N). */
	near(sum / N, 0, 0.009, "the mean of GSL's normal deviates is 0");
	near(square / N, 1, 0.0127, "the variance of GSL's normal deviates is 1");
	gsl_rng_free(a);
	gsl_rng_free(b);
	gsl_rng_free(c);
	gsl_rng_free(d);
	gsl_rng_free(e);
}

static void test_addressed(void)
{
	enum { N = 100000 };
	double sum = 0, square = 0, cross = 0, uniform = 0, z[2];

	for (uint64_t i = 0; i < N; i++) {
		philox_normal2(7, 0, RNG_SURFACE, i, z);
		sum += z[0] + z[1];
		square += z[0] * z[0] + z[1] * z[1];
		cross += z[0] * z[1];
		uniform += philox_uniform(7, 0, RNG_SURFACE, i);
	}
	near(sum / (2 * N), 0, 0.009, "the mean of addressed normal deviates is 0");
	near(square / (2 * N), 1, 0.0127,
		"the variance of addressed normal deviates is 1");
	near(cross / N, 0, 0.0127, "the two deviates of a pair are uncorrelated");
	near(uniform / N, 0.5, 0.00366, "the mean of addressed uniform deviates is 1/2");
}

static void mark(void *context, size_t i, int worker)
{
	(void)worker;
	((unsigned char *)context)[i]++;
}

static void test_pool(int threads)
{
	enum { N = 3000 };
	struct pool *pool = threads ? pool_new(threads) : NULL;
	unsigned char *marks = calloc(N, 1);
	int once = 1;

	for (int round = 0; round < 20; round++)
		pool_run(pool, N, mark, marks);
	pool_run(pool, 0, mark, marks);
	for (int i = 0; i < N; i++)
		once &= marks[i] == 20;
	ok(once, "%d threads: every job runs exactly once a round", threads);
	free(marks);
	pool_free(pool);
}

/* Rounds of few jobs one after another, and pauses in which the threads fall asleep: a
 * thread that wakes late finds another round. */
static void test_short_rounds(int threads)
{
	enum { ROUNDS = 20000, MOST = 5 };
	const struct timespec pause = { .tv_nsec = 1000000 };
	struct pool *pool = pool_new(threads);
	unsigned char marks[2][MOST];
	int wrong = 0;

	for (int round = 0; round < ROUNDS; round++) {
		size_t jobs = (size_t)(round % (MOST + 1));

		memset(marks[round % 2], 0, MOST);
		pool_run(pool, jobs, mark, marks[round % 2]);
		for (size_t i = 0; i < MOST; i++)
			wrong += marks[round % 2][i] != (i < jobs);
		if (round % 500 == 0)
			nanosleep(&pause, NULL);
	}
	ok(wrong == 0, "%d threads: all jobs of a short round are done when it returns",
		threads);
	pool_free(pool);
}

static void test_fft(size_t nx, size_t ny)
{
	struct fft *fft = fft_new(nx, ny);
	size_t n = nx * ny, modes = (nx / 2 + 1) * ny;
	double *x = fft_alloc(n), *y = fft_alloc(n), worst = 0;
	double complex *s = fft_alloc_complex(modes), direct = 0;
	size_t kx = nx > 2 ? 1 : 0, ky = ny > 2 ? 2 : 0;

	for (size_t i = 0; i < n; i++)
		x[i] = philox_uniform(3, 0, RNG_NOISE, i);
	memcpy(y, x, n * sizeof *x);
	fft_forward(fft, y, s);
	for (size_t i = 0; i < n; i++)
		direct += x[i] * cexp(-2 * M_PI * I *
					 ((double)(kx * (i % nx)) / (double)nx +
						 (double)(ky * (i / nx)) / (double)ny));
	near(cabs(s[ky * (nx / 2 + 1) + kx] - direct), 0, 1e-11,
		"a Fourier coefficient is that of the definition");
	fft_inverse(fft, s, y);
	for (size_t i = 0; i < n; i++)
		worst = tap_max(worst, fabs(y[i] / (double)n - x[i]));
	near(worst, 0, 1e-14, "forward and inverse transform give the data back");
	fft_free(x);
	fft_free(y);
	fft_free(s);
	fft_done(fft);
}

static void test_room(void)
{
	int *x = NULL, kept = 1, *before;
	size_t room = 0, had;

	for (int i = 0; i < 1000; i++)
		if (room_for(&x, &room, (size_t)i + 1, sizeof *x) == 0)
			x[i] = i;
	for (int i = 0; i < 1000; i++)
		kept &= x[i] == i;
	ok(kept && room >= 1000, "an array grows and keeps what is in it");
	before = x;
	had = room;
	ok(room_for(&x, &room, SIZE_MAX / 4, sizeof *x) == NUM_MEMORY && x == before &&
			room == had,
		"a size beyond all memory is refused and the array is kept");
	free(x);
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/* Against qsort(), with ties and infinities. */
static void test_select(void)
{
	gsl_rng *rng = rng_new(8, 0, RNG_NOISE);
	int good = 1;

	for (int run = 0; run < 2000; run++) {
		int n = 1 + (int)(200 * gsl_rng_uniform(rng));
		size_t rank[3] = { (size_t)n / 20, (size_t)n / 2, (size_t)n - 1 };
		double v[201], sorted[201];

		for (int i = 0; i < n; i++) {
			v[i] = run % 3 ? gsl_ran_ugaussian(rng)
				       : floor(5 * gsl_rng_uniform(rng));
			if (run % 5 == 0 && gsl_rng_uniform(rng) < 0.3)
				v[i] = INFINITY;
			sorted[i] = v[i];
		}
		qsort(sorted, (size_t)n, sizeof *sorted, ascending);
		select_ranks(v, (size_t)n, rank, 3);
		for (int k = 0; k < 3; k++)
			good &= v[rank[k]] == sorted[rank[k]];
		qsort(v, (size_t)n, sizeof *v, ascending);
		for (int i = 0; i < n; i++)
			good &= v[i] == sorted[i];
	}
	ok(good, "selected ranks are those of a sorted list, and no value is lost");
	gsl_rng_free(rng);
}

/* 1 + 2 cos x + 4 cos 2 x at x = 0, pi / 2 and pi; a matrix by its factor, and one that
 * is not positive definite; a pulse over both ends of a record; a parabola. */
static void test_small(void)
{
	double even[] = { 1, 1, 2 };
	double a[] = { 4, NAN, 7, 2, 10, 7 }, x[] = { 8, 24 }, bad[] = { 1, 0, 2, 1 };
	const double p[] = { 1, 10, 100 }, y[] = { 2, 3 };

	fft_even(even, 3);
	ok(even[0] == 5 && even[1] == -1 && even[2] == 1,
		"the transform of an even sequence is that of its first half");
	fft_even(even, 3);
	ok(even[0] == 4 && even[1] == 4 && even[2] == 8,
		"twice gives it back, times its length");
	ok(cholesky_factor(a, 2, 3, 0) == NUM_OK && a[0] == 2 && a[3] == 1 && a[4] == 3,
		"a matrix has its Cholesky factor");
	cholesky_solve(a, 2, 3, x);
	near(x[0], 8.0 / 9, 1e-14, "the first of two unknowns");
	near(x[1], 20.0 / 9, 1e-14, "the second");
	ok(cholesky_factor(bad, 2, 2, 0) == NUM_DOMAIN, "another has none");
	ok(dot_within(p, 3, y, 2, -2) == 200 && dot_within(p, 3, y, 2, -1) == 320 &&
			dot_within(p, 3, y, 2, 1) == 3 &&
			dot_within(p, 3, y, 2, 2) == 0 && dot_within(p, 3, y, 2, -3) == 0,
		"an inner product counts what lies within the record");
	near(parabola_top(5 - 1.25 * 1.25, 5 - 0.0625, 5 - 0.75 * 0.75), 0.25, 1e-14,
		"the top of a parabola");
	ok(parabola_top(1, 0, 1) == 0, "one that opens upwards has none");
}

/* Products of several arrays have the bits of those of two, whatever the length. */
static void test_dots(void)
{
	enum { MOST = 11 };
	double a[3][MOST], b[3][MOST];
	const double *x[3] = { a[0], a[1], a[2] }, *y[3] = { b[0], b[1], b[2] };
	int right = 1;

	for (int u = 0; u < 3; u++)
		for (int i = 0; i < MOST; i++) {
			a[u][i] = sin(1 + 5 * u + 7 * i);
			b[u][i] = exp(cos(2 + 3 * u + 11 * i));
		}
	for (size_t n = 0; n <= MOST; n++) {
		double nine[3][3], three[3], sum[MOST], plain = 0;

		dot9(x, y, n, nine);
		for (int u = 0; u < 3; u++) {
			dot3(x[u], y, n, three);
			for (int v = 0; v < 3; v++)
				right &= nine[u][v] == dot(x[u], y[v], n) &&
					 three[v] == nine[u][v];
		}
		memcpy(sum, b[0], sizeof sum);
		add_scaled(sum, 0.3, a[0], n);
		for (size_t i = 0; i < MOST; i++)
			right &= sum[i] == (i < n ? b[0][i] + 0.3 * a[0][i] : b[0][i]);
		for (size_t i = 0; i < n; i++)
			plain += a[1][i] * b[2][i];
		right &= fabs(nine[1][2] - plain) <= 1e-14;
	}
	ok(right, "inner products of several arrays have the bits of those of two");
}

/* Values that stand out of noise of variance 1, in a lobe of width w beside nothing. */
static double standing_of_lobe(double w)
{
	static const double nothing[1000];
	double y[1000], count;

	for (int i = 0; i < 1000; i++)
		y[i] = 300 * exp(-0.5 * pow((i - 500) / w, 2));
	return standing_count((const double *[]){ nothing, y }, 1000, &count) == NUM_OK
		       ? count
		       : NAN;
}

/* The transform of a lobe of width w falls to ten times the noise where (w omega)^2 is
 * log(300^2 2 pi w^2 / 1e4): 2 * 1000 omega / (2 pi) values are below. */
static void test_standing(void)
{
	enum { N = 4096 };
	gsl_rng *rng = rng_new(5, 0, RNG_NOISE);
	double x[N], y[N], noise, tone, lobe = standing_of_lobe(25);
	const double *both[] = { x, y };

	for (int i = 0; i < N; i++) {
		x[i] = gsl_ran_gaussian_ziggurat(rng, 1);
		y[i] = gsl_ran_gaussian_ziggurat(rng, 1);
	}
	ok(standing_count(both, N, &noise) == NUM_OK && noise <= 4,
		"of noise hardly a value stands out");
	for (int i = 0; i < N; i++)
		x[i] = y[i] = sin(2 * M_PI * 25 * i / N);
	ok(standing_count(both, N, &tone) == NUM_OK && fabs(tone - 4) < 1e-9,
		"of a tone two values of either signal do");
	near(lobe, 1000 / (25 * M_PI) * sqrt(log(9 * 2 * M_PI * 625)), 2,
		"of a lobe as many as its band has");
	near(standing_of_lobe(12.5),
		1000 / (12.5 * M_PI) * sqrt(log(9 * 2 * M_PI * 156.25)), 2,
		"of half a lobe nearly twice as many");
	gsl_rng_free(rng);
}

/* Every place of one element other than zero, every start and every length: blocks of all
 * sizes begin and end anywhere.  A negative zero is a zero, nan is not. */
static void test_next(void)
{
	enum { N = 80 };
	static const double marks[] = { 1e-310, -1, NAN };
	size_t wrong = 0;

	for (size_t at = 0; at <= N; at++)
		for (size_t start = 0; start <= N; start++) {
			double x[N + 1] = { 0 };
			size_t n = N - (at + start) % 7, want = n;

			x[at / 2] = -0.0;
			x[at] = marks[at % 3];
			if (at >= start && at < n)
				want = at;
			wrong += start <= n && lanes_next(x, start, n) != want;
		}
	ok(wrong == 0, "the next element other than zero is found at any place");
}

/* A plane of which some rows are zero, and some are not wanted, there and back. */
static void test_plane(void)
{
	enum { NX = 12, NY = 10 };
	struct fft_plane *p = fft_plane_new(NX, NY);
	size_t stride = fft_plane_stride(p), size = fft_plane_size(p);
	double *x = fft_alloc(stride * NY), *y = fft_alloc(stride * NY), off = 0,
	       kept = 0;
	double complex *spectrum = fft_alloc_complex(size),
		       *work = fft_alloc_complex(size);
	unsigned char wanted[NY] = { [1] = 1, [4] = 1, [9] = 1 };

	for (size_t i = 0; i < NX; i++) {
		x[2 * stride + i] = (double)(i * i % 7);
		x[4 * stride + i] = (double)(i % 5) - 2;
	}
	for (size_t i = 0; i < stride * NY; i++)
		y[i] = 1000;
	fft_plane_forward(p, x, 1, 6, spectrum, work);
	fft_plane_inverse(p, spectrum, y, wanted, work);
	for (size_t row = 0; row < NY; row++)
		for (size_t i = 0; i < NX; i++) {
			double *at = &y[row * stride + i];

			if (wanted[row])
				off = fmax(
					off, fabs(*at / (NX * NY) - x[row * stride + i]));
			else
				kept += *at == 1000;
		}
	ok(off < 1e-14, "wanted rows of a plane come back, with rows of zeros (%g)", off);
	ok(kept == (NY - 3) * NX, "other rows are left alone");
	fft_plane_done(p);
	fft_free(x);
	fft_free(y);
	fft_free(spectrum);
	fft_free(work);
}

int main(void)
{
	test_room();
	test_next();
	test_plane();
	test_philox();
	test_philox_row();
	test_rng();
	test_addressed();
	test_pool(0);
	test_pool(1);
	test_pool(3);
	test_short_rounds(2);
	test_short_rounds(5);
	test_fft(16, 1);
	test_fft(15, 7);
	test_fft(1, 9);
	ok(fft_good_size(1) == 1 && fft_good_size(11) == 12 &&
			fft_good_size(121) == 125 && fft_good_size(2047) == 2048,
		"good sizes have only the factors 2, 3, 5 and 7");
	ok(fft_fast_size(1) == 1 && fft_fast_size(127) == 128 &&
			fft_fast_size(513) == 560 && fft_fast_size(1018) == 1024 &&
			fft_fast_size(2049) == 2240,
		"fast sizes are powers of two times at most two of 3, 5 and 7, 3 once");
	test_select();
	test_small();
	test_dots();
	test_standing();
	return tap_done();
}
