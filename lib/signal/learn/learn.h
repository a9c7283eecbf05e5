/* learn.h - the pulse of a record, learned from the clearest stretches of it
 *
 * What calibration.h does once lag, tones and noise are known: the clearest short
 * sections are fitted jointly under each shape (examples.h), duration and gain are chosen
 * by least chi-square, and the shape is given what the residuals of all pulses have in
 * common where that is more than noise (correct.c).
 */
#ifndef SIGNAL_LEARN_H
#define SIGNAL_LEARN_H

#include "num/status.h"
#include "signal/learn/calibration.h"
#include "signal/learn/template.h"
#include <stddef.h>

/* Flags of the samples, aligned, that are not known; NULL if the record was whitened,
 * which spreads them. */
void learn_hidden(const struct calibrate_par *par, const struct calibration *c,
	const unsigned char *hidden[2]);
/* Fills shape, duration, gain, range of delays, chi2, penalised and events of c
 * from y1, y2[0 .. n), aligned and in units of the noise; low: lag as above, of these;
 * found: the pulse taken from these, which is tried first, its shape NULL where there is
 * none.
 */
enum separate_status learn_pulse(const struct calibrate_par *par, const double *y1,
	const double *y2, size_t n, double low, struct template *found,
	struct calibration *c);

#endif
