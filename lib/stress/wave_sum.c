#include "stress/wave_sum.h"
#include "num/fft.h"
#include "num/status.h"
#include "stress/lattice.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Depth over the distance of points: 5, 6, 7 and 8 leave 2e-5, 3e-6, 1e-6 and 4e-7 of the
 * largest pressure (256 x 256 cells, 22 % loaded). */
static const double SMOOTH = 7;
enum { FEWEST = 16 };

struct wave_sum {
	struct influence_par par;
	int nx, ny, full;
	struct pool *pool;
	double ux, uy;         /* wave numbers of the longest waves */
	double complex *image; /* of the pressure, over the number of cells */
	double *plane;         /* the pressure, then scratch memory; borrowed */
	struct fft *fft;
	struct sum_work work;
};

struct wave_sum *wave_sum_new(
	const struct influence_par *par, int nx, int ny, int full, struct pool *pool)
{
	struct wave_sum *s = calloc(1, sizeof *s);

	if (!s)
		return NULL;
	*s = (struct wave_sum){
		.par = *par, .nx = nx, .ny = ny, .full = full, .pool = pool
	};
	s->ux = 2 * M_PI / (nx * par->dx);
	s->uy = 2 * M_PI / (ny * par->dy);
	s->image = fft_alloc_complex(((size_t)nx / 2 + 1) * (size_t)ny);
	s->fft = fft_new((size_t)nx, (size_t)ny);
	if (!s->image || !s->fft) {
		wave_sum_free(s);
		return NULL;
	}
	return s;
}

void wave_sum_free(struct wave_sum *s)
{
	if (!s)
		return;
	fft_free(s->image);
	if (s->fft)
		fft_done(s->fft);
	free(s);
}

struct sum_work wave_sum_work(const struct wave_sum *s)
{
	return s->work;
}

void wave_sum_load(struct wave_sum *s, double *pressure)
{
	size_t n = (size_t)s->nx * (size_t)s->ny,
	       k = ((size_t)s->nx / 2 + 1) * (size_t)s->ny;

	s->plane = pressure;
	fft_forward(s->fft, pressure, s->image);
	for (size_t i = 0; i < k; i++)
		s->image[i] /= (double)n;
	s->work.transforms++;
}

/* Stress on a grid of points from the waves that it can represent. */
struct carry {
	const struct wave_sum *s;
	int mx, my; /* points */
	double ox, oy, z;
	int numbers;
	double complex *const *spectrum;
};

/* Influence of wave (i, j).  The shortest wave along an axis of even size represents both
 * directions: the mean of the two. */
static void grid_wave(
	const struct carry *g, int i, int j, double complex number[STRESS_NUMBERS])
{
	const struct wave_sum *s = g->s;
	int both_x = 2 * i == s->nx, both_y = 2 * j == s->ny, n = 0;
	double complex v[STRESS_NUMBERS];

	if (!both_x && !both_y) {
		influence_wave(&s->par, i * s->ux, j * s->uy, g->z, number);
		return;
	}
	memset(number, 0, STRESS_NUMBERS * sizeof *number);
	for (int sx = 1; sx >= (both_x ? -1 : 1); sx -= 2)
		for (int sy = 1; sy >= (both_y ? -1 : 1); sy -= 2, n++) {
			influence_wave(&s->par, sx * i * s->ux, sy * j * s->uy, g->z, v);
			for (int c = 0; c < STRESS_NUMBERS; c++)
				number[c] += v[c];
		}
	for (int c = 0; c < STRESS_NUMBERS; c++)
		number[c] /= n;
}

/* Waves +-j along y.  The influence of -j follows from that of j: shear along x leaves
 * the parity in y, shear along y that in x, and the influence is that of a real function.
 */
static void carry_row(void *context, size_t row, int worker)
{
	const struct carry *g = context;
	const struct wave_sum *s = g->s;
	int j = (int)row, columns = g->mx / 2 + 1, all_x = g->mx == s->nx,
	    all_y = g->my == s->ny;
	int twin = j > 0 && 2 * j != g->my;

	(void)worker;
	for (int i = 0; i < columns; i++) {
		size_t stride = (size_t)s->nx / 2 + 1;
		size_t from = (size_t)j * stride + (size_t)i,
		       mirror = (size_t)(s->ny - j) * stride + (size_t)i;
		size_t to = (size_t)j * (size_t)columns + (size_t)i,
		       other = (size_t)(g->my - j) * (size_t)columns + (size_t)i;
		double complex v[STRESS_NUMBERS], x, y;

		/* The shortest waves of a coarser grid represent both directions. */
		if ((!all_x && 2 * i == g->mx) || (!all_y && 2 * j == g->my)) {
			for (int c = 0; c < g->numbers; c++) {
				g->spectrum[c][to] = 0;
				if (twin)
					g->spectrum[c][other] = 0;
			}
			continue;
		}
		grid_wave(g, i, j, v);
		x = cexp(I * (2 * M_PI * i * g->ox / s->nx));
		y = cexp(I * (2 * M_PI * j * g->oy / s->ny));
		for (int c = 0; c < g->numbers; c++) {
			double sign =
				influence_odd((enum stress_number)c, s->par.axis ? 0 : 1)
					? -1
					: 1;
			double complex back = sign * (s->par.axis ? conj(v[c]) : v[c]);

			g->spectrum[c][to] = s->image[from] * v[c] * x * y;
			if (twin)
				g->spectrum[c][other] =
					s->image[mirror] * back * x * conj(y);
		}
	}
}

/* Points along an axis at depth z. */
static int points_for(int cells, double size, double z, int full)
{
	double spacing = z / (SMOOTH * size);
	size_t points;

	/* With fewer points interpolation takes longer than the transforms it saves. */
	if (full || spacing < 2)
		return cells;
	points = fft_good_size((size_t)fmax(FEWEST, ceil(cells / spacing)));
	return points < (size_t)cells ? (int)points : cells;
}

struct hand_over {
	const struct wave_sum *s;
	double *const *field;
	const struct stress_want *want;
};

static void hand_span(void *context, size_t job, int worker)
{
	const struct hand_over *h = context;
	const struct stress_span *span = &h->want->span[job];
	const double *number[STRESS_NUMBERS] = { NULL };

	(void)worker;
	for (int c = 0; c < h->want->numbers; c++)
		number[c] =
			h->field[c] + (size_t)span->y * (size_t)h->s->nx + span->begin;
	h->want->put(h->want->context, span, number);
}

static enum num_status hand_over(struct wave_sum *s, double *const *field,
	const struct lattice_axis *x, const struct lattice_axis *y,
	const struct stress_want *want)
{
	struct hand_over h = { s, field, want };
	struct lattice *l;
	enum num_status status;

	if (x->points == s->nx && y->points == s->ny) {
		pool_run(s->pool, want->count, hand_span, &h);
		s->work.full_layers++;
		return NUM_OK;
	}
	l = lattice_new(x, y, s->pool);
	status = l ? lattice_gather(l, field, 0, 0, want) : NUM_MEMORY;
	lattice_done(l);
	s->work.coarse_layers++;
	return status;
}

enum num_status wave_sum_at(struct wave_sum *s, double z, const struct stress_want *want)
{
	struct lattice_axis x = lattice_periodic(
				    s->nx, points_for(s->nx, s->par.dx, z, s->full)),
			    y = lattice_periodic(
				    s->ny, points_for(s->ny, s->par.dy, z, s->full));
	size_t columns = (size_t)x.points / 2 + 1, rows = (size_t)y.points / 2 + 1;
	int all = x.points == s->nx && y.points == s->ny;
	double complex *spectrum[STRESS_NUMBERS] = { NULL };
	struct carry carry = { s, x.points, y.points, lattice_origin(&x),
		lattice_origin(&y), z, want->numbers, spectrum };
	double *field[STRESS_NUMBERS] = { NULL }, *plane = s->plane;
	struct fft *own = all ? NULL : fft_new((size_t)x.points, (size_t)y.points);
	struct fft *fft = all ? s->fft : own;
	enum num_status status = fft ? NUM_OK : NUM_MEMORY;

	for (int c = 0; c < want->numbers; c++) {
		spectrum[c] = fft_alloc_complex(columns * (size_t)y.points);
		status = spectrum[c] ? status : NUM_MEMORY;
	}
	if (!status)
		pool_run(s->pool, rows, carry_row, &carry);
	for (int c = 0; !status && c < want->numbers; c++) {
		fft_inverse(fft, spectrum[c], plane);
		field[c] = plane;
		/* The spectrum is of no more use, and large enough for the next field. */
		plane = (double *)spectrum[c];
	}
	s->work.transforms += want->numbers;
	s->work.kernel_cells += (double)columns * (double)rows;
	if (!status)
		status = hand_over(s, field, &x, &y, want);
	for (int c = 0; c < want->numbers; c++)
		fft_free(spectrum[c]);
	fft_done(own);
	return status;
}

double wave_sum_bound(
	const struct wave_sum *s, const struct stress_criterion *criterion, double z)
{
	double complex mean[STRESS_NUMBERS];
	double v[STRESS_DEVIATOR], sum;
	int columns = s->nx / 2 + 1;

	influence_wave(&s->par, 0, 0, z, mean);
	for (int c = 0; c < STRESS_DEVIATOR; c++)
		v[c] = creal(mean[c] * s->image[0]);
	sum = criterion->value(v);
	for (int j = 0; j < s->ny; j++)
		for (int i = j == 0; i < columns; i++) {
			double ky = (2 * j <= s->ny ? j : s->ny - j) * s->uy;
			int twice = i > 0 && 2 * i < s->nx;

			sum += (twice + 1) *
			       cabs(s->image[(size_t)j * (size_t)columns + (size_t)i]) *
			       criterion->norm *
			       influence_wave_bound(&s->par, hypot(i * s->ux, ky) * z);
		}
	return sum;
}
