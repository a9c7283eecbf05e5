/* states.c - the states of the trends, see bank_state.h */
#include "life/trend/bank_state.h"

size_t size_of_state(const struct bank_par *par)
{
	size_t n = 2 + (size_t)par->n_loads;

	return (n + n * n + (size_t)par->n_loads) * sizeof(double);
}

double *state_of(const struct bank *b, const struct trend *tr)
{
	return (double *)(b->trend + b->capacity) +
	       (size_t)(tr - b->trend) * (size_of_state(&b->par) / sizeof(double));
}

void line_at(const struct bank *b, const struct trend *tr, const double *f, double *line)
{
	int n = 2 + b->par.n_loads;
	const double *x = state_of(b, tr), *p = x + n;

	line[LINE_H] = x[0];
	line[LINE_HH] = p[0];
	line[LINE_V] = line[LINE_HV] = line[LINE_VV] = 0;
	for (int i = 1; i < n; i++) {
		line[LINE_V] += f[i - 1] * x[i];
		line[LINE_HV] += f[i - 1] * p[i];
		for (int j = 1; j < n; j++)
			line[LINE_VV] += f[i - 1] * f[j - 1] * p[n * i + j];
	}
	/* v and w may nearly cancel */
	line[LINE_VV] = fmax(line[LINE_VV], 1e-9 * p[n + 1]);
	line[LINE_VH] = line[LINE_HV];
}

void advance_state(int n, double *x, const double *f, double along, double keep)
{
	double *p = x + n;

	for (int k = 1; k < n; k++) {
		x[0] += along * f[k - 1] * x[k];
		for (int j = 0; j < n; j++)
			p[j] += along * f[k - 1] * p[n * k + j];
	}
	for (int k = 1; k < n; k++)
		p[0] += along * f[k - 1] * p[k];
	for (int k = 1; k < n; k++)
		p[n * k] = p[k];
	for (int i = 0; keep != 1 && i < n * n; i++)
		p[i] /= keep;
}

void observe_state(int n, double *x, int k, double f, double e, double noise)
{
	double *p = x + n, column[1 + RATES];

	for (int i = 0; i < n; i++)
		column[i] = p[n * i + k];
	for (int i = 0; i < n; i++) {
		x[i] += column[i] / f * e;
		for (int j = 0; j < n; j++)
			p[n * i + j] -= column[i] / f * column[j];
	}
	for (int i = 0; i < n; i++) /* without cancellation */
		p[n * i + k] = p[n * k + i] = column[i] * (noise / f);
}

void scale_rates(int n, double *x, double times)
{
	double *p = x + n;

	for (int i = 1; i < n; i++) {
		x[i] *= times;
		for (int j = 0; j < n; j++) {
			p[n * i + j] *= times;
			p[n * j + i] *= times;
		}
	}
}
