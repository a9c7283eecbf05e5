/* window.h - sums over the loads of a part of the grid, by Fourier transform
 *
 * A window of wx times wy cells holds all loads and all nodes whose stress is wanted.  On
 * a free surface it is padded to twice its size, so that nothing wraps around; on a
 * periodic one it is the whole grid.  Spectra of the influence numbers are stored for
 * half of the wavenumbers along y; the others follow by symmetry.
 */
#ifndef CONTACT_WINDOW_H
#define CONTACT_WINDOW_H

#include "stress/influence.h"

struct window;

/* NULL when out of memory. */
struct window *window_new(const struct stress_par *par, int wx, int wy);
void window_free(struct window *w);

/* Spectra of the first count numbers at depth z: room for window_size(w) coefficients
 * each.  -1 when out of memory. */
size_t window_size(const struct window *w);
int window_spectra(struct window *w, double z, int count, double complex *spectra);

/* Takes the pressures of the window whose first cell is (x0, y0) of the grid. */
void window_load(struct window *w, const double *pressure, int x0, int y0);
/* out[wy][wx]: the sum for one number. */
void window_sum(struct window *w, const double complex *spectra,
	enum influence_number number, double *out);

/* A bound of the von Mises stress at depth z that falls with z: the sum over the waves
 * of the loaded pressure.  Periodic only. */
double window_bound(const struct window *w, double z);

#endif
