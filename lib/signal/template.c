/* template.c - see template.h */
#include "signal/template.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = TEMPLATE_COUNT, FINER = 10 };

/* Weight of the squares of second differences, as a share of what the record says of a
 * coefficient: it decides only what the record leaves open. */
static const double STIFFNESS = 1e-3;

struct template
{
	double duration;
	struct shape *basis[2]; /* a B-spline, as either channel has it */
	double a[N][N], b[N];
	double *row; /* of one stretch: what each coefficient puts on it */
	size_t room;
};

/* The cubic B-spline of unit knots. */
static double spline(double x)
{
	x = fabs(x);
	return x >= 2  ? 0
	       : x > 1 ? (2 - x) * (2 - x) * (2 - x) / 6
		       : 2.0 / 3 - x * x * (1 - x / 2);
}

struct template *template_new(double duration, const struct whitening whitening[2])
{
	struct template *t = calloc(1, sizeof *t);
	double value[4 * 8 + 1];
	struct shape *plain;

	if (!t)
		return NULL;
	for (int k = 0; k <= 32; k++)
		value[k] = spline((k - 16) / 8.0);
	plain = shape_from_values(value, 16, 2.0 / TEMPLATE_KNOTS);
	t->duration = duration;
	for (int c = 0; plain && c < 2; c++)
		t->basis[c] = shape_filter(plain, duration,
			whitening ? whitening[c].seen : NULL,
			whitening ? whitening[c].seen_half : 0, 2e-4);
	shape_free(plain);
	if (!t->basis[0] || !t->basis[1]) {
		template_free(t);
		return NULL;
	}
	return t;
}

void template_free(struct template *t)
{
	if (!t)
		return;
	shape_free(t->basis[0]);
	shape_free(t->basis[1]);
	free(t->row);
	free(t);
}

void template_clear(struct template *t)
{
	memset(t->a, 0, sizeof t->a);
	memset(t->b, 0, sizeof t->b);
}

static int reserve(struct template *t, size_t n)
{
	if (n > t->room) {
		free(t->row);
		t->row = malloc(n * N * sizeof *t->row);
		t->room = t->row ? n : 0;
	}
	return t->row != NULL;
}

/* What the coefficients put on sample i: those of pulses that reach it. */
static void add_rows(struct template *t, const struct joint_scene *s, int c, size_t n,
	const struct joint_pulse *p)
{
	double T = s->duration * (1 + p->delta / s->transit);
	double a = p->a * (c ? s->gain : 1), t0 = p->t + (c ? p->delta : 0);
	double step = T / TEMPLATE_KNOTS, *part = malloc(n * sizeof *part);

	for (int k = -TEMPLATE_HALF; part && k <= TEMPLATE_HALF; k++) {
		size_t len;
		long first = shape_support(t->basis[c], t0 + k * step, T, &len);
		long last = first + (long)len;

		first = first < 0 ? 0 : first;
		last = last > (long)n ? (long)n : last;
		if (last <= first)
			continue;
		shape_sample(t->basis[c], t0 + k * step, T, first, (size_t)(last - first),
			part, NULL, NULL);
		for (long i = first; i < last; i++)
			t->row[(size_t)i * N + (size_t)(k + TEMPLATE_HALF)] +=
				a * part[i - first];
	}
	free(part);
}

void template_add(struct template *t, const struct joint_scene *s, const double *y1,
	const double *y2, size_t n, const struct joint_pulse *pulses, int m)
{
	if (!reserve(t, n))
		return;
	for (int c = 0; c < 2; c++) {
		const double *y = c ? y2 : y1;

		memset(t->row, 0, n * N * sizeof *t->row);
		for (int i = 0; i < m; i++)
			add_rows(t, s, c, n, &pulses[i]);
		for (size_t i = 0; i < n; i++) {
			const double *row = t->row + i * N;
			int first = 0, last = N;

			if (s->bad[c] && s->bad[c][i])
				continue;
			while (first < N && row[first] == 0)
				first++;
			while (last > first && row[last - 1] == 0)
				last--;
			for (int u = first; u < last; u++) {
				t->b[u] += row[u] * y[i];
				for (int v = first; v <= u; v++)
					t->a[u][v] += row[u] * row[v];
			}
		}
	}
}

/* Adds the squares of second differences, of zeros beyond the ends, too. */
static void stiffen(struct template *t)
{
	static const double d[3] = { 1, -2, 1 };
	double weight = 0;

	for (int k = 0; k < N; k++)
		weight += STIFFNESS * t->a[k][k] / N;
	for (int k = -1; k <= N; k++)
		for (int u = 0; u < 3; u++)
			for (int v = 0; v <= u; v++) {
				int i = k - 1 + u, j = k - 1 + v;

				if (j >= 0 && i < N)
					t->a[i][j] += weight * d[u] * d[v];
			}
}

/* Cholesky in place; 0 where the matrix is not positive definite. */
static int solve(struct template *t)
{
	for (int i = 0; i < N; i++)
		for (int k = 0; k <= i; k++) {
			double sum = t->a[i][k];

			for (int l = 0; l < k; l++)
				sum -= t->a[i][l] * t->a[k][l];
			if (k < i)
				t->a[i][k] = sum / t->a[k][k];
			else if (sum > 0)
				t->a[i][i] = sqrt(sum);
			else
				return 0;
		}
	for (int i = 0; i < N; i++) {
		for (int l = 0; l < i; l++)
			t->b[i] -= t->a[i][l] * t->b[l];
		t->b[i] /= t->a[i][i];
	}
	for (int i = N - 1; i >= 0; i--) {
		for (int l = i + 1; l < N; l++)
			t->b[i] -= t->a[l][i] * t->b[l];
		t->b[i] /= t->a[i][i];
	}
	return 1;
}

/* The pulse at x knots from the middle. */
static double value_at(const struct template *t, double x)
{
	int at = (int)floor(x);
	double sum = 0;

	for (int k = at - 1; k <= at + 2; k++)
		if (k >= -TEMPLATE_HALF && k <= TEMPLATE_HALF)
			sum += t->b[k + TEMPLATE_HALF] * spline(x - k);
	return sum;
}

struct shape *template_solve(struct template *t, double *scale, double *shift)
{
	enum { REACH = TEMPLATE_HALF + 2, ALL = 2 * REACH * FINER };
	double value[ALL + 1], high = 0, low = 0, zero;
	int top = 0, bottom = 0, at;

	stiffen(t);
	if (!solve(t))
		return NULL;
	for (int i = 0; i <= ALL; i++) {
		double v = value_at(t, (double)i / FINER - REACH);

		if (v > high) {
			high = v;
			top = i;
		}
		if (v < low) {
			low = v;
			bottom = i;
		}
	}
	if (high <= 0 || low >= 0)
		return NULL;
	*scale = (top < bottom ? 1 : -1) * fmax(high, -low);
	/* The crossing between the lobes, by the straight line between samples. */
	at = top < bottom ? top : bottom;
	while (at < ALL && (value_at(t, (double)at / FINER - REACH) > 0) ==
				   (value_at(t, (double)(at + 1) / FINER - REACH) > 0))
		at++;
	{
		double v0 = value_at(t, (double)at / FINER - REACH);
		double v1 = value_at(t, (double)(at + 1) / FINER - REACH);

		zero = (at + (v0 != v1 ? v0 / (v0 - v1) : 0)) / FINER - REACH;
	}
	*shift = zero / TEMPLATE_KNOTS;
	for (int i = 0; i <= ALL; i++)
		value[i] = value_at(t, (double)i / FINER - REACH + zero) / *scale;
	return shape_from_values(value, ALL / 2, (double)REACH / TEMPLATE_KNOTS);
}
