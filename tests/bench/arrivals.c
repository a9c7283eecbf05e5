/* arrivals - arrivals of one to four overlapping pulses: a network and the joint fit,
 * against the Cramer-Rao bound
 *
 * usage: arrivals NETWORK [SECTIONS]
 *
 * Sections of cnndata.h: duration 100 samples, delays within +-1.5 samples, amplitudes of
 * cube roots uniform in (0.8, 1.15), spacing at least 10 samples.  Errors are root mean
 * squares in samples (delay, arrival) and relative (size), with the number of pulses
 * given; sections in which a fit finds fewer are excluded from its errors and counted in
 * found.  The bound is the mean Fisher bound at the truth.  Seconds are of CPU, per
 * section. */
#include "net/cnndata.h"
#include "net/netfile.h"
#include "signal/fit/joint.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum method { NETWORK, FIT, BOUND, METHODS };

static const char *const names[] = { "network", "fit", "bound" };

struct tally {
	double found, time, delay, size, pulses, seconds, searches;
};

static double cpu_seconds(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int look(
	struct network *net, const struct cnndata_section *s, struct joint_pulse *pulse)
{
	struct cnn_pulse guess[CNN_SOURCES];
	int m = cnn_apply(net, &s->section, s->sources, guess);

	for (int k = 0; k < m; k++)
		pulse[k] = (struct joint_pulse){
			.t = guess[k].t, .delta = guess[k].delta, .a = guess[k].a
		};
	return m;
}

static void add_errors(struct tally *t, const struct cnndata_section *s,
	const struct joint_pulse *pulse, int m, enum method method)
{
	if (m != s->sources)
		return;
	t->found++;
	for (int k = 0; k < m; k++) {
		const struct joint_pulse *p = &pulse[k];
		const struct cnn_pulse *want = &s->pulse[k];
		int bound = method == BOUND;

		t->pulses++;
		t->time += bound ? p->cov[0] : pow(p->t - want->t, 2);
		t->delay += bound ? p->cov[0] - 2 * p->cov[1] + p->cov[2]
				  : pow(p->delta - want->delta, 2);
		t->size += bound ? p->cov[5] / pow(3 * p->a, 2)
				 : pow(cbrt(p->a / want->a) - 1, 2);
	}
}

/* The section in units of its noise. */
static void whiten(struct cnndata_section *s)
{
	for (size_t i = 0; i < CNNDATA_SAMPLES; i++) {
		s->y1[i] /= s->noise;
		s->y2[i] /= s->noise;
	}
	for (int k = 0; k < s->sources; k++)
		s->pulse[k].a /= s->noise;
}

static void work_section(struct network *net, struct joint *joint,
	const struct shape *shape, struct cnndata_section *s, enum method method,
	struct tally *t)
{
	struct joint_scene scene = { .shape = shape,
		.duration = s->section.duration,
		.transit = 196.35,
		.gain = s->section.gain,
		.width = 1,
		.delta_min = -s->section.reach,
		.delta_max = s->section.reach,
		.threshold = 33,
		.threshold_near = 25,
		.max_pulses = s->sources };
	struct joint_pulse pulse[JOINT_PULSES_MAX];
	struct joint_result r = { 0 };
	const double *y1 = s->section.y1, *y2 = s->section.y2;
	double begin = cpu_seconds();
	int m = 0;

	if (method == NETWORK)
		m = look(net, s, pulse);
	if (method == FIT)
		joint_fit(joint, &scene, y1, y2, s->section.n, pulse, &m, &r);
	if (method == BOUND) {
		for (m = 0; m < s->sources; m++)
			pulse[m] = (struct joint_pulse){ .t = s->pulse[m].t,
				.delta = s->pulse[m].delta,
				.a = s->pulse[m].a };
		joint_refine(joint, &scene, y1, y2, s->section.n, pulse, m, &r);
	}
	t->seconds += cpu_seconds() - begin;
	t->searches += (double)r.searches;
	add_errors(t, s, pulse, m, method);
}

int main(int argc, char **argv)
{
	long sections = argc > 2 ? atol(argv[2]) : 200;
	FILE *f = argc > 1 ? fopen(argv[1], "r") : NULL;
	struct netfile file;
	struct network *net = f ? netfile_read(f, 1, &file) : NULL;
	struct joint *joint = joint_new();
	struct shape *shape = shape_new(PULSE_SINE);
	struct cnndata_section *s = malloc(sizeof *s);

	if (!net || !cnn_suits(net) || !joint || !shape || !s || sections < 1) {
		fprintf(stderr, "usage: arrivals NETWORK [SECTIONS]\n");
		return 2;
	}
	printf("method\tsources\tsnr\tsections\tfound\tarrival_rmse\tdelay_rmse\tsize_rmse\t"
	       "seconds\tsearches\n");
	for (int n = 1; n <= CNN_SOURCES; n++)
		for (int snr = 20; snr <= 40; snr += 10)
			for (int method = 0; method < METHODS; method++) {
				struct cnndata_par par = cnndata_default();
				struct tally t = { 0 };

				par.sources[0] = par.sources[1] = n;
				par.snr[0] = par.snr[1] = snr;
				par.reach[0] = par.reach[1] = 0.015;
				par.gain[0] = par.gain[1] = 0.909;
				par.size[0] = 0.8;
				par.size[1] = 1.15;
				for (long i = 0; i < sections; i++) {
					cnndata_section(
						&par, 1000000000u + (uint32_t)i, s);
					whiten(s);
					work_section(net, joint, shape, s,
						(enum method)method, &t);
				}
				printf("%s\t%d\t%d\t%ld\t%.4f\t%.4g\t%.4g\t%.4g\t%.3g\t%.3g\n",
					names[method], n, snr, sections,
					t.found / (double)sections,
					sqrt(t.time / t.pulses), sqrt(t.delay / t.pulses),
					sqrt(t.size / t.pulses),
					t.seconds / (double)sections,
					t.searches / (double)sections);
				fflush(stdout);
			}
	free(s);
	free(file.cmd);
	shape_free(shape);
	joint_free(joint);
	network_free(net);
	fclose(f);
	return 0;
}
