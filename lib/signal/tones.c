/* tones.c - see tones.h */
#include "signal/tones.h"
#include "num/fft.h"
#include "signal/robust.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 64, CLIP = 3, TERMS_MAX = 2 * TONES_MAX + 1 };

struct line {
	double power, omega;
};

static int by_power(const void *x, const void *y)
{
	const struct line *p = x, *q = y;

	return p->power > q->power ? -1 : p->power < q->power;
}

static int by_omega(const void *x, const void *y)
{
	const struct line *p = x, *q = y;

	return p->omega < q->omega ? -1 : p->omega > q->omega;
}

/* Pulses are clipped to a few times the usual sample, lines and all: unclipped their
 * spectrum would bury a line that is as strong as they are rare. */
static void add_periodogram(const struct fft *fft, const double *y, size_t n,
	double *work, double complex *spectrum, double *power)
{
	double mean = 0, limit;

	for (size_t i = 0; i < n; i++)
		mean += y[i] / (double)n;
	for (size_t i = 0; i < n; i++)
		work[i] = fabs(y[i] - mean);
	limit = CLIP * robust_median(work, n);
	if (limit <= 0)
		limit = INFINITY; /* silence but for pulses */
	for (size_t i = 0; i < n; i++)
		work[i] = fmax(fmin(y[i] - mean, limit), -limit) *
			  (0.5 - 0.5 * cos(2 * acos(-1) * (double)i / (double)n));
	fft_forward(fft, work, spectrum);
	for (size_t k = 0; k <= n / 2; k++)
		power[k] += creal(spectrum[k] * conj(spectrum[k]));
}

static int pick_lines(const double *power, size_t n, int max, double *omega)
{
	enum { KEEP = 256 };
	struct line line[KEEP] = { { 0, 0 } };
	double around[2 * SIDE];
	int count = 0;

	for (size_t k = 3; k + 3 <= n / 2; k++) {
		size_t from = k > SIDE ? k - SIDE : 0,
		       to = k + SIDE < n / 2 ? k + SIDE : n / 2;
		double a, b, c, bend;
		int m = 0;

		if (power[k] <= power[k - 1] || power[k] < power[k + 1])
			continue;
		for (size_t i = from; i < to && m < 2 * SIDE; i++)
			if (i + 2 < k || i > k + 2)
				around[m++] = power[i];
		if (power[k] < 40 * robust_median(around, (size_t)m) || count == KEEP)
			continue;
		/* The main lobe of a Hann window is nearly a parabola in the logarithm.
		 */
		a = log(power[k - 1]);
		b = log(power[k]);
		c = log(power[k + 1]);
		bend = a - 2 * b + c;
		line[count].power = power[k];
		line[count++].omega = 2 * acos(-1) / (double)n *
				      ((double)k + (bend < 0 ? 0.5 * (a - c) / bend : 0));
	}
	qsort(line, (size_t)count, sizeof *line, by_power);
	if (count > max)
		count = max;
	qsort(line, (size_t)count, sizeof *line, by_omega);
	for (int i = 0; i < count; i++)
		omega[i] = line[i].omega;
	return count;
}

int tones_find(const double *y1, const double *y2, size_t n, int max, double *omega)
{
	struct fft *fft;
	double *work, *power;
	double complex *spectrum;
	int count = -1;

	if (n < 1024)
		return 0;
	while (fft_good_size(n) != n || n % 2)
		n--;
	fft = fft_new(n, 1);
	work = fft_alloc(n);
	power = fft_alloc(n / 2 + 1);
	spectrum = fft_alloc_complex(n / 2 + 1);
	if (fft && work && power && spectrum) {
		add_periodogram(fft, y1, n, work, spectrum, power);
		add_periodogram(fft, y2, n, work, spectrum, power);
		count = pick_lines(power, n, max > TONES_MAX ? TONES_MAX : max, omega);
	}
	fft_free(work);
	fft_free(power);
	fft_free(spectrum);
	if (fft)
		fft_done(fft);
	return count;
}

/* Constant, then cosine and sine of each tone, at index t. */
static void terms_at(double t, int tones, const double *omega, double *term)
{
	term[0] = 1;
	for (int k = 0; k < tones; k++) {
		term[1 + 2 * k] = cos(omega[k] * t);
		term[2 + 2 * k] = sin(omega[k] * t);
	}
}

/* Cholesky factor of the symmetric matrix a (lower triangle, rows of TERMS_MAX) in
 * place; 0 where it is not positive definite. */
static int factorise(double *a, int n)
{
	for (int i = 0; i < n; i++)
		for (int k = 0; k <= i; k++) {
			double sum = a[i * TERMS_MAX + k];

			for (int l = 0; l < k; l++)
				sum -= a[i * TERMS_MAX + l] * a[k * TERMS_MAX + l];
			if (k < i)
				a[i * TERMS_MAX + k] = sum / a[k * TERMS_MAX + k];
			else if (sum > 1e-10 * a[i * TERMS_MAX + i])
				a[i * TERMS_MAX + i] = sqrt(sum);
			else
				return 0;
		}
	return 1;
}

/* Solves L L^T x = b in place. */
static void substitute(const double *a, double *b, int n)
{
	for (int i = 0; i < n; i++) {
		for (int l = 0; l < i; l++)
			b[i] -= a[i * TERMS_MAX + l] * b[l];
		b[i] /= a[i * TERMS_MAX + i];
	}
	for (int i = n - 1; i >= 0; i--) {
		for (int l = i + 1; l < n; l++)
			b[i] -= a[l * TERMS_MAX + i] * b[l];
		b[i] /= a[i * TERMS_MAX + i];
	}
}

/* Least squares over the samples whose mask is set; on request the variance of each
 * coefficient in units of that of a sample. */
static int fit_masked(const double *x, const unsigned char *mask, size_t n, int terms,
	const double *basis, double *coefficient, double *variance)
{
	double a[TERMS_MAX * TERMS_MAX] = { 0 }, b[TERMS_MAX] = { 0 };

	for (size_t i = 0; i < n; i++) {
		const double *term = basis + i * (size_t)terms;

		if (!mask[i])
			continue;
		for (int k = 0; k < terms; k++) {
			b[k] += term[k] * x[i];
			for (int l = 0; l <= k; l++)
				a[k * TERMS_MAX + l] += term[k] * term[l];
		}
	}
	if (!factorise(a, terms))
		return 0;
	substitute(a, b, terms);
	memcpy(coefficient, b, sizeof(double) * (size_t)terms);
	for (int k = 0; variance && k < terms; k++) {
		double unit[TERMS_MAX] = { 0 };

		unit[k] = 1;
		substitute(a, unit, terms);
		variance[k] = unit[k];
	}
	return 1;
}

/* Marks where the mean square of rest over some neighbours is at most twice its median:
 * where nothing happens.  Returns that median; work and sorted hold n. */
static double mark_quiet(
	const double *rest, size_t n, double *work, double *sorted, unsigned char *mask)
{
	size_t half = n / 1024 > 8 ? n / 1024 : 8, count = 0;
	double sum = 0, median;

	for (size_t i = 0; i < n + half; i++) {
		if (i < n) {
			sum += rest[i] * rest[i];
			count++;
		}
		if (i > 2 * half) {
			sum -= rest[i - 2 * half - 1] * rest[i - 2 * half - 1];
			count--;
		}
		if (i >= half)
			work[i - half] = sum > 0 ? sum / (double)count : 0;
	}
	memcpy(sorted, work, n * sizeof *work);
	median = robust_median(sorted, n);
	for (size_t i = 0; i < n; i++)
		mask[i] = work[i] <= 2 * median;
	return median;
}

int tones_fit(const double *x, size_t n, double start, int tones, const double *omega,
	double *coefficient, double *deviation, double *variance)
{
	enum { PASSES = 4 };
	int terms = 1 + 2 * tones, good;
	double *basis = malloc((size_t)terms * n * sizeof *basis);
	double *rest = malloc(3 * n * sizeof *rest), level = 0;
	unsigned char *mask = malloc(n);

	good = basis && rest && mask && n > 4 * (size_t)terms;
	for (size_t i = 0; good && i < n; i++)
		terms_at(start + (double)i, tones, omega, basis + i * (size_t)terms);
	memset(coefficient, 0, sizeof(double) * (size_t)terms);
	if (good) {
		memcpy(rest, x, n * sizeof *x);
		coefficient[0] = robust_median(rest, n);
	}
	/* At first the rest is the record itself: where tones prevail it is quiet all
	 * along, where they do not it is quiet between the pulses. */
	for (int pass = 0; good && pass < PASSES; pass++) {
		for (size_t i = 0; i < n; i++) {
			const double *term = basis + i * (size_t)terms;

			rest[i] = x[i];
			for (int k = 0; k < terms; k++)
				rest[i] -= coefficient[k] * term[k];
		}
		level = mark_quiet(rest, n, rest + n, rest + 2 * n, mask);
		if (!fit_masked(x, mask, n, terms, basis, coefficient, variance)) {
			memset(mask, 1, n);
			good = fit_masked(
				x, mask, n, terms, basis, coefficient, variance);
		}
	}
	if (deviation)
		*deviation = sqrt(level);
	free(basis);
	free(rest);
	free(mask);
	return good;
}

/* Power of tone k over what noise gives it: chi-square with two degrees of freedom. */
static double significance(
	const double *coefficient, const double *variance, double deviation, int k)
{
	double sum = 0;

	for (int i = 1 + 2 * k; i <= 2 + 2 * k; i++)
		sum += coefficient[i] * coefficient[i] / variance[i];
	return sum / (deviation * deviation);
}

int tones_confirm(const double *y1, const double *y2, size_t n, int tones, double *omega)
{
	double c[2][TERMS_MAX], v[2][TERMS_MAX], d[2];
	int kept = 0;

	if (tones == 0 || !tones_fit(y1, n, 0, tones, omega, c[0], &d[0], v[0]) ||
		!tones_fit(y2, n, 0, tones, omega, c[1], &d[1], v[1]))
		return tones;
	for (int k = 0; k < tones; k++)
		if (significance(c[0], v[0], d[0], k) > 40 ||
			significance(c[1], v[1], d[1], k) > 40)
			omega[kept++] = omega[k];
	return kept;
}

void tones_remove(double *x, size_t n, double start, int tones, const double *omega,
	double at_a, const double *from, double at_b, const double *to)
{
	double term[TERMS_MAX] = { 0 };

	for (size_t i = 0; i < n; i++) {
		double t = start + (double)i,
		       part = at_b > at_a ? (t - at_a) / (at_b - at_a) : 0;

		part = part < 0 ? 0 : part > 1 ? 1 : part;
		terms_at(t, tones, omega, term);
		for (int k = 0; k < 1 + 2 * tones; k++)
			x[i] -= term[k] * (from[k] + part * (to[k] - from[k]));
	}
}
