/* rows.c - rows and reports of sections that were separated, or are unresolved */
#include "num/sigmas.h"
#include "signal/separate/separate_state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Fills in what the row of pulse i has from the second component. */
static void tell_phase(
	const struct separate *s, int i, long long from, struct transit *out)
{
	const struct quadrature_pulse *p = &s->both[i];
	double noise = separate_noise_at(s, 0, (double)from + p->t);
	double size = hypot(p->a, p->b);
	double ca = p->a / size, cb = p->b / size, along[4];
	double delay_var = p->cov[0][0] - 2 * p->cov[0][1] + p->cov[1][1];

	for (int k = 0; k < 4; k++)
		along[k] = ca * p->cov[2][k] + cb * p->cov[3][k];
	out->t1 = (double)from + p->t;
	out->t2 = out->t1 + (double)s->cal.shift + p->delta;
	out->t1_se = sqrt(p->cov[0][0]);
	out->t2_se = sqrt(p->cov[1][1]);
	out->delay_se = sqrt(delay_var);
	out->amplitude = size * noise;
	out->amplitude_se = sqrt(ca * along[2] + cb * along[3]) * noise;
	out->correlation =
		(along[1] - along[0]) * noise / (out->amplitude_se * out->delay_se);
	/* the phase of a reversed pulse is opposite to that of the original */
	out->phase = s->cal.reversed ? atan2(-p->b, -p->a) : atan2(p->b, p->a);
	out->phase_se = sqrt(cb * cb * p->cov[2][2] - 2 * ca * cb * p->cov[2][3] +
				ca * ca * p->cov[3][3]) /
			size;
}

/* Adds the origin of the pulses of sensor 2 (examples.h), which goes with the duration.
 */
static void add_origin(const struct calibration *c, double delta, struct transit *out)
{
	double longer = 1 + delta / c->transit, alone = out->delay_se;

	out->t2 += longer * c->origin;
	out->t2_se = hypot(out->t2_se, longer * c->origin_se);
	out->delay_se = hypot(alone, longer * c->origin_se);
	out->correlation *= alone / out->delay_se;
}

static enum separate_status emit_pulse(struct separate *s, const struct joint_pulse *p,
	long long from, int sources, double chi2, enum separate_verdict verdict)
{
	struct entry *entry = separate_queue_entry(s);
	struct transit *out;
	double delay_var = joint_delay_variance(p);
	double noise = separate_noise_at(s, 0, (double)from + p->t);

	if (!entry)
		return SEPARATE_MEMORY;
	out = &entry->row;
	out->sources = sources;
	out->t1 = (double)from + p->t;
	out->t2 = out->t1 + (double)s->cal.shift + p->delta;
	out->amplitude = p->a * noise;
	out->t1_se = sqrt(p->cov[0]);
	out->t2_se = sqrt(p->cov[2]);
	out->delay_se = sqrt(delay_var);
	out->amplitude_se = sqrt(p->cov[5]) * noise;
	out->correlation = (p->cov[4] - p->cov[3]) / sqrt(delay_var * p->cov[5]);
	if (s->with_both)
		tell_phase(s, (int)(p - s->pulse), from, out);
	add_origin(&s->cal, p->delta, out);
	out->chi2 = chi2;
	/* Beside its neighbours it may be none: two such pulses of opposite sign change
	 * the width of one.  In 193 random records eight rows are so small, and three of
	 * them are no particles. */
	if (verdict < SEPARATE_MISFIT &&
		fabs(out->amplitude) < SIGMAS_SELDOM * out->amplitude_se)
		verdict = SEPARATE_MISFIT;
	out->verdict = verdict;
	entry->evidence = (struct evidence){ .group = s->group,
		.fits = verdict != SEPARATE_MISFIT,
		.delay = p->delta,
		.var = isinf(s->cal.transit) || !isfinite(delay_var) ? 0 : delay_var,
		.amplitude = p->a,
		.weaker = p->a * p->a * joint_energy_least(&s->scene),
		.time = ((double)from + p->t) / s->cal.duration,
		.pulse = 1 };
	/* Within its standard error a delay is right either way. */
	if (entry->evidence.var > 0 &&
		fabs(p->other_delta - p->delta) > SIGMAS_SELDOM * sqrt(delay_var))
		entry->evidence.exchange = p->exchange;
	entry->more_square = p->more_square;
	memcpy(entry->evidence.odds, s->pair_odds[p - s->pulse],
		sizeof entry->evidence.odds);
	s->counters.rows++;
	s->counters.negative += p->a < 0;
	return SEPARATE_OK;
}

enum separate_status separate_reserve_sources(struct separate *s, size_t count)
{
	free(s->source);
	s->source = calloc(count ? count : 1, sizeof *s->source);
	return s->source ? SEPARATE_OK : SEPARATE_MEMORY;
}

/* Draws each fitted pulse by itself, as sensor 1 would record it. */
static enum separate_status draw_pulses(
	struct separate *s, long long from, int m, size_t n)
{
	if (separate_reserve_sources(s, (size_t)m * n) != SEPARATE_OK)
		return SEPARATE_MEMORY;
	for (int i = 0; i < m; i++) {
		double *x = s->source + (size_t)i * n;
		double noise = separate_noise_at(s, 0, (double)from + s->pulse[i].t);

		joint_add(&s->scene, &s->pulse[i], 1, x, NULL, n);
		for (size_t k = 0; k < n; k++)
			x[k] *= noise;
	}
	return SEPARATE_OK;
}

/* Upper limit of the sum of the squared amplitudes in n samples, in units of the noise,
 * of particles of the mean velocity; NAN where neither sensor has measured all samples.
 * Slower ones have longer pulses and less amplitude: for their size they have less
 * energy, in proportion to velocity. */
static double most_square(
	const struct separate *s, long long from, size_t n, const struct campbell *dense)
{
	double slowest = 1 + s->scene.delta_max / (double)s->cal.shift, sum = 0;
	double high = (double)n * (dense->square + SIGMAS_SELDOM * dense->square_se);

	for (int k = 0; k < s->channels; k += 2) {
		double part = NAN; /* of the sensor with more */

		for (int c = k; c < k + 2; c++) {
			const struct buffer *b = &s->buffer[c];
			long long at = from + (c > k ? s->cal.shift : 0) - b->begin;
			double unit = (k ? s->quadrature.noise[c - k] : 1) /
				      (c > k ? s->scene.gain : 1);

			if (!memchr(b->hidden + at, 1, n))
				part = fmax(part,
					unit * unit *
						campbell_most(b->x + at, n, s->cal.shape,
							s->cal.duration));
		}
		sum += k == 0 && part > high ? high : part;
	}
	return sum * slowest;
}

enum separate_status separate_dense_section(
	struct separate *s, long long from, long long to)
{
	struct entry *entry = separate_queue_entry(s);
	struct transit *p;
	struct separate_section out = { .number = s->number,
		.begin = from,
		.end = to,
		.chi2 = NAN,
		.verdict = SEPARATE_UNRESOLVED };
	double length = (double)(to - from);
	double noise = separate_noise_at(s, 0, (double)from + length / 2);
	struct channels y = channels_at(s, from);
	struct campbell c;
	int known;

	if (!entry)
		return SEPARATE_MEMORY;
	p = &entry->row;
	campbell_estimate(y.at[0], y.at[1], (size_t)(to - from), s->cal.shape,
		s->cal.duration, s->scene.gain, &c);
	campbell_compare(y.at[0], y.at[1], (size_t)(to - from), s->cal.shape,
		s->cal.duration, s->scene.gain, &c);
	p->most = noise * sqrt(most_square(s, from, (size_t)(to - from), &c));
	campbell_scale(&c, noise, 1);
	known = c.rate_se < c.rate && c.rate * length < 1e9;
	p->sources = known ? (int)(c.rate * length + 0.5) : 1;
	p->t1 = (double)from + length / 2;
	p->t2 = p->t1 + (double)s->cal.shift;
	p->amplitude = known ? c.amplitude : sqrt(c.square * length);
	/* Events that are no particles have no volume. */
	if (s->strange && !known)
		p->amplitude = NAN;
	p->amplitude_se = known ? c.amplitude_se : NAN;
	p->t1_se = p->t2_se = length / sqrt(12);
	p->verdict = SEPARATE_UNRESOLVED;
	s->counters.unresolved++;
	s->counters.dense += length;
	s->counters.countless += known ? 0 : length;
	if (isfinite(c.unlike)) {
		s->counters.compared += length;
		s->counters.unlike += length * c.unlike * c.unlike;
	}
	entry->evidence.group = ++s->group;
	entry->evidence.fits = !s->strange;
	s->counters.covered += s->strange ? length : 0;
	s->strange = 0;
	out.sources = p->sources;
	out.dense = &c;
	return separate_queue_report(s, &out, 1);
}

enum separate_status separate_give_event(
	struct separate *s, long long from, long long to, const struct foreign *event)
{
	struct entry *entry = separate_queue_entry(s);
	struct transit *p;
	struct separate_section out = { .number = s->number, .begin = from, .end = to };

	if (!entry)
		return SEPARATE_MEMORY;
	p = &entry->row;
	p->t1 = (double)from + event->t[0];
	p->t2 = (double)(from + s->cal.shift) + event->t[1];
	p->amplitude = event->amplitude * separate_noise_at(s, isnan(event->t[0]),
						  isnan(event->t[0]) ? p->t2 : p->t1);
	p->chi2 = out.chi2 = event->chi2;
	p->verdict = out.verdict = event->verdict;
	entry->evidence.group = ++s->group;
	entry->evidence.fits = p->verdict != SEPARATE_TRANSIENT;
	s->counters.events[p->verdict]++;
	if (p->verdict != SEPARATE_IMPULSE)
		s->counters.covered += (double)(to - from);
	return separate_queue_report(s, &out, 1);
}

enum separate_status separate_give_pulses(struct separate *s, long long from,
	long long to, int m, int done, const struct goodness *j)
{
	struct separate_section out = { .number = s->number,
		.begin = from,
		.end = to,
		.sources = done,
		.chi2 = j->chi2,
		.verdict = j->stretch };

	s->group++;
	for (int i = 0; i < done; i++)
		if (emit_pulse(s, &s->pulse[i], from, m, j->chi2, j->pulse[i]) !=
			SEPARATE_OK)
			return SEPARATE_MEMORY;
	if (s->par.want_sources &&
		draw_pulses(s, from, done, (size_t)(to - from)) != SEPARATE_OK)
		return SEPARATE_MEMORY;
	return separate_queue_report(s, &out, (size_t)done);
}
