/* wave_sum.h - stress below a periodic half-space
 *
 * The pressure is the Fourier series through the cell centres; the mean lateral strain is
 * zero.  A wave decays exponentially with wavenumber times depth, so below the surface
 * the short waves are omitted, the sum is computed on as few points as the others need,
 * and the nodes are interpolated from these points (lattice.h).
 */
#ifndef STRESS_WAVE_SUM_H
#define STRESS_WAVE_SUM_H

#include "num/pool.h"
#include "num/status.h"
#include "stress/free_sum.h"

struct wave_sum;

/* full: all waves at every depth.  pool is borrowed.  NULL when out of memory. */
struct wave_sum *wave_sum_new(
	const struct influence_par *par, int nx, int ny, int full, struct pool *pool);
void wave_sum_free(struct wave_sum *s);

/* Sets the pressure, of fft_alloc(), which is borrowed until the next call and serves as
 * scratch memory: a whole field less than a copy would take. */
void wave_sum_load(struct wave_sum *s, double *pressure);
/* Stress at depth z. */
enum num_status wave_sum_at(struct wave_sum *s, double z, const struct stress_want *want);

/* An upper bound of an equivalent stress at depth z, decreasing with z: the sum over the
 * waves. */
double wave_sum_bound(
	const struct wave_sum *s, const struct stress_criterion *criterion, double z);

struct sum_work wave_sum_work(const struct wave_sum *s);

#endif
