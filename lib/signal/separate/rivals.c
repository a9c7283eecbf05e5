/* rivals.c - other explanations of a window than pulses of one sign */
#include "num/room.h"
#include "signal/detect/spikes.h"
#include "signal/separate/separate_state.h"
#include <math.h>
#include <string.h>

/* Excludes impulses from the fit as well, by s->spikes; 0 if there are none. */
static int hide_spikes(struct separate *s, long long from, size_t n)
{
	size_t found = 0;

	for (int c = 0; c < 2; c++) {
		const double *y = channels_at(s, from).at[c];
		const unsigned char *known = s->scene.hidden[c];
		unsigned char *flags = s->spikes + (size_t)c * n;

		found += spikes_find(y, n, s->cal.duration, flags);
		for (size_t i = 0; known && i < n; i++)
			flags[i] |= known[i];
		s->scene.hidden[c] = flags;
	}
	return found > 0;
}

/* Largest number of pulses of another explanation per duration T of a pulse.  A channel
 * has three independent values per T in the band of a pulse, up to 1.5 / T; with three
 * parameters each, two pulses per T describe the values of both channels whatever they
 * are.  Half of that is accepted.  0.5, 0.7, 1, 1.5 and 2 find 2768, 2809, 2851, 2855 and
 * 2855 of 2860 particles (38 records of tests/matrix/scenes.tsv with negative pulses,
 * impulses, dropouts, bubbles, shocks, clipping, other shapes and flow drift, seeds 11
 * and 12), none of them wrong; 1.5 and 2 take 12 and 24 % more time. */
static const double MOST = 1;

/* Chi-square and, for each pulse, the threshold at which it is accepted: the least is the
 * likeliest of explanations that leave no more than noise.  Two or more positive pulses
 * beside a negative one describe it as well as it does. */
static double penalised(const struct joint_scene *s, const struct account *a)
{
	return a->r.chi2 + s->threshold_near * a->m;
}

enum separate_status separate_try_rivals(struct separate *s, struct account *a)
{
	enum { IMPULSES, VELOCITIES, SIGNS, RIVALS };
	const int described = separate_is_described(a);
	const struct joint_scene plain = s->scene;
	const struct channels y = channels_at(s, a->from);
	enum separate_status status = SEPARATE_OK;
	int found = 0, most, tried;

	most = (int)ceil(MOST * (double)a->n / s->cal.duration);
	most = described && a->m < most ? a->m : most;
	/* Many positive pulses may stand for a few negative ones. */
	if (a->cut && !described && a->m > 2 * most &&
		!(a->r.negative && s->counters.negative + s->cal.negative > 0))
		return SEPARATE_OK; /* too many pulses for the time */
	tried = 2 * most < plain.max_pulses ? 2 * most : plain.max_pulses;
	if (room_for(&s->spikes, &s->spike_room, 2 * a->n, sizeof *s->spikes))
		return SEPARATE_MEMORY;
	for (int k = described ? SIGNS : 0; k < RIVALS && status == SEPARATE_OK && !found;
		k++) {
		struct account rival = {
			.from = a->from, .n = a->n, .cut = a->cut, .whole = a->whole
		};

		s->scene = plain;
		s->scene.max_pulses = tried;
		s->scene.give_up = 1;
		if (k == VELOCITIES && !separate_is_range_free(s))
			continue;
		if (k == VELOCITIES)
			separate_widen(s);
		s->scene.signs = k == SIGNS;
		if (k == IMPULSES &&
			(s->cal.whitening.tap || !hide_spikes(s, a->from, a->n)))
			continue;
		status = separate_fit_window(s, y.at, &rival);
		found = status == SEPARATE_OK && separate_is_described(&rival) &&
			rival.m <= most &&
			(!described || penalised(&plain, &rival) < penalised(&plain, a));
		if (found) {
			*a = rival;
			a->impulses = k == IMPULSES;
		}
	}
	s->scene = plain;
	if (found && !a->impulses)
		status = separate_fit_without_common(s, a);
	if (found && status == SEPARATE_OK) {
		separate_keep_fit(s, a);
		separate_follow(s, a);
	}
	memcpy(s->pulse, a->pulse, sizeof s->pulse);
	return status;
}
