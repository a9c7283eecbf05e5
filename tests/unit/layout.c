/* layout - the Cramer-Rao bound of coils, against matrices by finite differences */
#include "layout/search.h"
#include "num/philox.h"
#include "tap.h"
#include <stdlib.h>

static double voltage(
	const struct bound_par *p, double t, double t1, double v, double a, double x)
{
	double s = ((t - t1) * v - x) / p->zone;

	return fabs(s) < pulse_reach(p->shape) ? a * pulse_value(p->shape, s) : 0;
}

/* Variances of arrival at the first coil, velocity and amplitude by Gauss-Jordan from
 * derivatives by central differences, samples at (k + phase) / rate. */
static void brute(const struct bound_par *p, const double *coil, int coils, double phase,
	double variance[3])
{
	double f[3][6] = { { 0 } }, theta[3] = { 0, p->velocity, p->snr };
	double span = p->zone / p->velocity * pulse_reach(p->shape);
	double step[3] = { 1e-6 * p->zone / p->velocity, 1e-6 * p->velocity,
		1e-6 * p->snr };

	for (int m = 0; m < coils; m++) {
		double x = coil[m] - coil[0], at = x / p->velocity;
		long low = (long)floor((at - span) * p->rate) - 1;
		long high = (long)ceil((at + span) * p->rate) + 1;

		for (long k = low; k <= high; k++) {
			double t = ((double)k + phase) / p->rate, g[3];

			for (int i = 0; i < 3; i++) {
				double up[3] = { theta[0], theta[1], theta[2] },
				       down[3] = { theta[0], theta[1], theta[2] };

				up[i] += step[i];
				down[i] -= step[i];
				g[i] = (voltage(p, t, up[0], up[1], up[2], x) -
					       voltage(p, t, down[0], down[1], down[2],
						       x)) /
				       (2 * step[i]) * theta[i == 0 ? 1 : i];
			}
			g[0] *= p->zone / p->velocity / p->velocity;
			for (int i = 0; i < 3; i++)
				for (int j = 0; j < 3; j++)
					f[i][j] += g[i] * g[j];
		}
	}
	for (int i = 0; i < 3; i++)
		f[i][3 + i] = 1;
	for (int i = 0; i < 3; i++) {
		double pivot = f[i][i];

		for (int j = 0; j < 6; j++)
			f[i][j] /= pivot;
		for (int k = 0; k < 3; k++) {
			double c = f[k][i];

			for (int j = 0; k != i && j < 6; j++)
				f[k][j] -= c * f[i][j];
		}
	}
	for (int i = 0; i < 3; i++)
		variance[i] = f[i][3 + i];
}

static void compare_with_differences(enum pulse_shape shape, const char *name)
{
	struct bound_par p = { shape, 0.1273, 12.73, 40e3, 100 };
	const double coil[] = { 0.1, 0.15, 0.35 };
	double variance[3], mean[3] = { 0 }, unit = p.zone / p.velocity;
	struct bound b, c;

	for (int k = 0; k < 4; k++) {
		brute(&p, coil, 3, (k + 0.5) / 4, variance);
		for (int i = 0; i < 3; i++)
			mean[i] += variance[i] / 4;
	}
	bound_sampled(&p, coil, 3, 16, &b);
	bound_closed(&p, coil, 3, &c);
	/* 400 samples a pulse; a sample at the jump of the slope of the sine counts 1/400
	 */
	ok(fabs(b.time / unit / sqrt(mean[0]) - 1) < 1e-3,
		"%s: the standard error of the arrival agrees with finite differences",
		name);
	ok(fabs(b.velocity / p.velocity / sqrt(mean[1]) - 1) < 1e-3,
		"%s: the standard error of the velocity agrees with finite differences",
		name);
	ok(fabs(b.amplitude / sqrt(mean[2]) - 1) < 1e-3,
		"%s: the standard error of the amplitude agrees with finite differences",
		name);
	ok(fabs(c.time / b.time - 1) < 1e-4 && fabs(c.velocity / b.velocity - 1) < 1e-4 &&
			fabs(c.diameter / b.diameter - 1) < 1e-4,
		"%s: integrals and sums agree to 1e-4 (%.1e)", name,
		c.velocity / b.velocity - 1);
}

/* The closed form in the literature's notation, for the sine. */
static void compare_with_formula(void)
{
	static const struct {
		int coils;
		double coil[4], want; /* sd(v) / v at 40 dB */
	} row[] = { { 1, { 0 }, 7.52e-4 }, { 2, { 0, .05 }, 4.44e-4 },
		{ 2, { 0, .25 }, 1.55e-4 }, { 3, { 0, .05, .25 }, 1.44e-4 },
		{ 4, { 0, 0, .25, .25 }, 1.10e-4 }, { 3, { 0, .25, .5 }, .797e-4 } };
	struct bound_par p = { PULSE_SINE, 0.1273, 12.73, 10e3, 100 };

	for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
		double n = row[i].coils, mean = 0, s = 0, formula;
		struct bound b;

		for (int k = 0; k < row[i].coils; k++)
			mean += row[i].coil[k] / n;
		for (int k = 0; k < row[i].coils; k++)
			s += pow(row[i].coil[k] - mean, 2);
		formula = sqrt(
			1e-4 * p.velocity * p.zone /
			(p.rate * (2 * M_PI * M_PI * s + (M_PI * M_PI / 6 + 0.125) * n *
								 p.zone * p.zone)));
		bound_closed(&p, row[i].coil, row[i].coils, &b);
		ok(fabs(b.velocity / p.velocity / formula - 1) < 1e-12,
			"the closed form is that of the page, %d coils over %g m",
			row[i].coils, row[i].coil[row[i].coils - 1]);
		ok(fabs(formula / row[i].want - 1) < 5e-3,
			"the closed form has the reference value %.3g", row[i].want);
	}
}

/* The probability of an isolated pulse in laminar flow, by a sum over radii. */
static double alone_in_laminar(const struct traffic *t, double zone)
{
	enum { RADII = 100000 };
	double mean = 0, flow = 0, sum = 0, v = 2 * pipe_mean_velocity(&t->pipe);

	for (int pass = 0; pass < 2; pass++)
		for (int i = 0; i < RADII; i++) {
			double r = 0.99 * (i + 0.5) / RADII, here = v * (1 - r * r);

			if (pass == 0) {
				flow += r * here;
				mean += r * zone;
			} else {
				sum += r * here *
				       exp(-t->arrivals * (zone / here + mean / flow));
			}
		}
	return sum / flow;
}

static void check_traffic(void)
{
	struct traffic t = { { 0.01, 1e-3, PIPE_PLUG, 7 }, 100, 0.025 };
	double v = pipe_mean_velocity(&t.pipe), plug = traffic_alone(&t, 0.1273);

	near(plug, exp(-200 * 0.1273 / v), 1e-15,
		"equal particles stand alone with exp(-2 arrivals zone / v)");
	near(traffic_slowness(&t, 1, 1) - traffic_slowness(&t, 0, -1), 0.05 / v, 1e-15,
		"transit times of equal particles differ by up to twice the spread");
	near(traffic_unique(&t, 0.25 * 0.05 / v), exp(-100 * 0.25 * 0.05 / v), 1e-15,
		"equal particles are matched with exp(-2 arrivals spacing spread / v)");
	t.pipe.profile = PIPE_LAMINAR;
	t.spread = 0;
	/* the wall is at 0.99 R, where the velocity is 2 U (1 - 0.99^2) */
	near((traffic_slowness(&t, 1, 1) - traffic_slowness(&t, 0, -1)) * v * 2,
		1 / (1 - 0.99 * 0.99) - 1, 1e-9,
		"a laminar profile spreads transit times from the axis to the wall");
	for (t.arrivals = 1; t.arrivals < 200; t.arrivals *= 10)
		ok(fabs(traffic_alone(&t, 0.1273) - alone_in_laminar(&t, 0.1273)) < 1e-5,
			"pulses in laminar flow are alone as a sum over radii tells, %g per second",
			t.arrivals);
	t.arrivals = 100;
	/* The mean of 1/v over the flow is area / flow whatever the profile, so that
	 * exp(-x), being convex, can only gain. */
	ok(traffic_alone(&t, 0.1273) > plug,
		"with the same mean transit time the fast ones are alone more often");
}

/* Without differences of velocity only the errors of the two arrivals confuse particles.
 * sd(t) = T / (snr sqrt(2 n) pi) for a sine of n samples. */
static void check_equal_velocities(const struct layout_par *given)
{
	struct layout_par par = *given;
	const double coil[] = { 0, 0.25, 0.5 };
	double T = par.bound.zone / par.bound.velocity;
	double sd = T / (par.bound.snr * sqrt(2 * par.bound.rate * T) * M_PI);
	struct layout of, two;

	par.traffic.spread = 0;
	layout_evaluate(&par, coil, 2, &of);
	near(of.unique, exp(-100 * 6 * sqrt(2) * sd), 1e-12,
		"equal velocities: the window of a match is six standard errors of the delay");
	near(of.by_width / of.unique, 1, 1e-12,
		"equal velocities: the width of the pulse narrows nothing");
	par.traffic.arrivals = 1e6;
	layout_evaluate(&par, coil, 2, &of);
	ok(of.unique < 1e-10, "equal velocities: crowds are not matched (%.1e)",
		of.unique);
	par = *given;
	layout_evaluate(&par, coil, 2, &two);
	layout_evaluate(&par, coil, 3, &of);
	/* Delay and widths of two pulses: the mean position is D/2 and sd(t) / sqrt(2).
	 */
	{
		double D = 0.25, s, w;
		struct bound b;

		bound_closed(&par.bound, coil, 2, &b);
		s = b.velocity / (par.bound.velocity * par.bound.velocity);
		w = 6 * sqrt(sd * sd / 2 + pow(1.5 * D * s, 2) + sd * sd);
		/* A particle in both windows confuses once. */
		ok(of.by_width < exp(-100 * w) && of.by_width < two.by_width &&
				of.by_width > two.by_width * exp(-100 * w),
			"the third coil is searched within the prediction of the first two");
	}
}

static void check_search(void)
{
	struct layout_par par = { { PULSE_SINE, 0.1273, 12.73, 10e3, 31.6 },
		{ { 0.01, 1e-3, PIPE_PLUG, 7 }, 100, 0.025 } };
	double coil[LAYOUT_COILS], far;
	struct layout of;

	ok(layout_search(&par, 4, 0.1, 0, 32, coil, &of) == 0 && coil[1] == 0 &&
			coil[2] == 0.1 && coil[3] == 0.1,
		"without a bound on pairing half the coils stand at either end");
	par.traffic.spread = 0.5;
	ok(layout_search(&par, 2, 10, 0.95, 64, coil, &of) == 0, "two coils are placed");
	par.traffic.spread = 0.025;
	/* p = exp(-arrivals w), w = 6 sqrt(2 sd(t)^2 + (D sd(1/v))^2), both errors from
	 * the first pulse.  Half of it lies beyond the range of the traffic for a
	 * particle at an end of the range, which is wide, none for most. */
	{
		double w = -log(0.95) / 100 / 6, sd;
		struct bound b;

		bound_closed(&par.bound, coil, 1, &b);
		sd = b.velocity / (12.73 * 12.73);
		far = sqrt(w * w - 2 * b.time * b.time) / sd;
	}
	near(coil[1] / far, 1, 0.01,
		"the coils are as far apart as pairing by width allows");
	check_equal_velocities(&par);
	ok(layout_search(&par, 2, 10, 1, 64, coil, &of) == 0 && coil[1] == 0,
		"where pairing must be certain the coils stand in one place");
}

/* Matching of drawn particles. */

enum { MATCHED_COILS = 6 };

/* What is measured of a particle: arrivals, and its slowness by the widths of pulses. */
struct passing {
	double arrival[MATCHED_COILS], slowness[MATCHED_COILS];
};

/* A layout, the standard errors at a coil, and the slownesses of the window. */
struct matching {
	const struct layout_par *par;
	const double *coil;
	int coils;
	double se_time, se_slowness, fastest, slowest;
};

static double uniform(void)
{
	static uint64_t drawn;

	return philox_uniform(3, 0, RNG_PARTICLE, drawn++);
}

static double normal(void)
{
	static uint64_t drawn;
	double two[2];

	philox_normal2(3, 0, RNG_NOISE, drawn++, two);
	return two[0];
}

/* Of particles inside whose radius this share of the flow passes. */
static double slowness_at(const struct pipe *pipe, double share)
{
	return 1 / pipe_velocity(pipe, pipe_position(pipe, 0.99 * pipe->bore / 2, share));
}

/* Of a particle at the first coil at this time, anywhere in the pipe and the spread. */
static struct passing pass(const struct matching *m, double time)
{
	const struct traffic *t = &m->par->traffic;
	double slowness =
		slowness_at(&t->pipe, uniform()) * (1 + t->spread * (2 * uniform() - 1));
	struct passing p;

	for (int k = 0; k < m->coils; k++) {
		p.arrival[k] = time + slowness * m->coil[k] + m->se_time * normal();
		p.slowness[k] = slowness + m->se_slowness * normal();
	}
	return p;
}

/* Arrival at coil k by what is measured at those before: the weighted mean of the
 * slownesses by widths and by the line through the arrivals; its standard error, with
 * that of the arrival itself, in *se. */
static double predicted(
	const struct matching *m, const struct passing *p, int k, double *se)
{
	double mean = 0, time = 0, weight = 0, sum = 0;

	for (int i = 0; i < k; i++) {
		mean += m->coil[i] / k;
		time += p->arrival[i] / k;
	}
	for (int i = 0; i < k; i++) {
		double x = m->coil[i] - mean, w = 1 / (m->se_slowness * m->se_slowness);

		weight += w + x * x / (m->se_time * m->se_time);
		sum += w * p->slowness[i] + x * p->arrival[i] / (m->se_time * m->se_time);
	}
	*se = sqrt(m->se_time * m->se_time * (1 + 1. / k) +
		   pow(m->coil[k] - mean, 2) / weight);
	return time + (m->coil[k] - mean) * sum / weight;
}

/* Where the pulse of a particle is searched at coil k: in what the traffic allows, and
 * near the prediction. */
static void window_at(const struct matching *m, const struct passing *p, int k,
	int by_width, double *low, double *high)
{
	double way = m->coil[k] - m->coil[k - 1], se, at;

	*low = p->arrival[k - 1] + way * m->fastest - 3 * sqrt(2) * m->se_time;
	*high = p->arrival[k - 1] + way * m->slowest + 3 * sqrt(2) * m->se_time;
	at = predicted(m, p, k, &se);
	if (k > 1 || by_width) {
		*low = fmax(*low, at - 3 * se);
		*high = fmin(*high, at + 3 * se);
	}
}

/* The share of so many particles that have no pulse of another in any window. */
static double matched(const struct matching *m, int by_width, int particles)
{
	/* Beyond it nothing gets into a window. */
	double reach =
		2 * (m->slowest - m->fastest) * m->coil[m->coils - 1] + 20 * m->se_time;
	int good = 0;

	for (int n = 0; n < particles; n++) {
		struct passing own = pass(m, 0);
		double low[MATCHED_COILS], high[MATCHED_COILS], t = -reach;
		int confused = 0;

		for (int k = 1; k < m->coils; k++)
			window_at(m, &own, k, by_width, &low[k], &high[k]);
		while ((t -= log(uniform()) / m->par->traffic.arrivals) < reach) {
			struct passing other = pass(m, t);

			for (int k = 1; k < m->coils; k++)
				confused |= other.arrival[k] > low[k] &&
					    other.arrival[k] < high[k];
		}
		good += !confused;
	}
	return (double)good / particles;
}

/* The probabilities against drawn particles, with and without widths. */
static void check_matching(void)
{
	enum { PARTICLES = 40000 };
	static const struct {
		int coils;
		double coil[MATCHED_COILS], arrivals, spread, snr;
		enum pipe_profile profile;
	} scene[] = { { 2, { 0, 0.25 }, 100, 0.025, 31.6, PIPE_PLUG },
		{ 3, { 0, 0.1, 0.25 }, 100, 0.025, 31.6, PIPE_PLUG },
		{ 3, { 0, 0.1, 0.25 }, 300, 0, 31.6, PIPE_PLUG },
		{ 3, { 0, 0.05, 0.5 }, 40, 0.1, 10, PIPE_PLUG },
		{ 4, { 0, 0.05, 0.1, 0.3 }, 100, 0.05, 5, PIPE_PLUG },
		{ 4, { 0, 0.02, 0.04, 0.1 }, 30, 0, 31.6, PIPE_TURBULENT },
		{ 6, { 0, 0.02, 0.05, 0.1, 0.2, 0.3 }, 300, 0.01, 10, PIPE_PLUG } };

	for (size_t i = 0; i < sizeof scene / sizeof *scene; i++) {
		struct layout_par par = { { PULSE_SINE, 0.1273, 0, 10e3, scene[i].snr },
			{ { 0.01, 1e-3, scene[i].profile, 7 }, scene[i].arrivals,
				scene[i].spread } };
		const struct pipe *pipe = &par.traffic.pipe;
		double v = pipe_mean_velocity(pipe);
		struct matching m = { .par = &par,
			.coil = scene[i].coil,
			.coils = scene[i].coils,
			.fastest = slowness_at(pipe, 0) * (1 - scene[i].spread),
			.slowest = slowness_at(pipe, 1) * (1 + scene[i].spread) };
		struct layout of;
		struct bound b;

		par.bound.velocity = v;
		bound_closed(&par.bound, m.coil, 1, &b);
		m.se_time = b.time;
		m.se_slowness = b.velocity / (v * v);
		layout_evaluate(&par, m.coil, m.coils, &of);
		for (int by_width = 0; by_width < 2; by_width++) {
			double got = matched(&m, by_width, PARTICLES),
			       want = by_width ? of.by_width : of.unique;

			/* Four standard deviations of the draws, and the error of the
			 * means over points (match.h). */
			ok(fabs(got - want) <
					4 * sqrt(want * (1 - want) / PARTICLES) + 0.001,
				"%d coils, %g per second, spread %g, %s: %.4f, drawn %.4f",
				m.coils, scene[i].arrivals, scene[i].spread,
				by_width ? "by widths" : "by delays", want, got);
		}
	}
}

int main(void)
{
	compare_with_differences(PULSE_SINE, "sine");
	compare_with_differences(PULSE_GAUSS, "gauss");
	compare_with_differences(PULSE_LORENTZ, "lorentz");
	compare_with_formula();
	check_traffic();
	check_search();
	check_matching();
	return tap_done();
}
