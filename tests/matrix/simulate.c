/* simulate - records of two sensors with their truth, to evaluate duet
 *
 * usage: simulate KEY=VALUE ... record=FILE truth=FILE
 *
 * Shares no code with the library or with sensorsim: pulses, flow, noise and bounds are
 * implemented here again.  The table below has the keys with their defaults.
 *
 * The record is a two-channel AU stream of 64-bit floats.  The truth is a table of all
 * events by time:
 *
 *	kind         particle, bubble, shock, impulse or dropout
 *	time1 time2  arrival at either sensor, s
 *	delay        time2 - time1
 *	amplitude    largest deflection at sensor 1 as recorded, V; negative if the first
 *	             lobe is
 *	diameter     of the particle, m
 *	duration     of its pulse, s
 *	begin end    of its trace in the record, both sensors, s
 *	masked       share of its energy in samples that were clipped or dropped
 *	time1_bound delay_bound amplitude_bound
 *	             Cramer-Rao bounds of standard errors, of the amplitude relative
 *
 * The bounds are for arrivals, transit times and amplitudes of a particle and all its
 * neighbours within three durations, with pulse shape, filter and noise spectrum known
 * and the duration proportional to the transit time. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PARAMETERS = 3, NEIGHBOURS = 96 };

static struct option {
	const char *key;
	double value;
} options[] = {
	{ "seed", 1 }, { "rate", 10e3 }, /* Hz */
	{ "seconds", 8 },                /* of record */
	{ "number", 50 },                /* particles; with arrange=poisson per second */
	{ "gap", 2.5 },                  /* arrange=single: least distance, durations */
	{ "duration", 0.01 },            /* of a pulse at mean velocity, s */
	{ "transit", 0.02 },             /* from sensor to sensor at mean velocity, s */
	{ "spread", 0.0125 },            /* plug: transit times within +- this share */
	{ "wall", 0.9 },                 /* no particle beyond this share of the radius */
	{ "smallest", 80e-6 },           /* diameters, m */
	{ "largest", 120e-6 },           /* ... */
	{ "vary", 0 },     /* share within which widths differ from those of velocities */
	{ "ratio", 0 },    /* standard deviation of the gain among particles, relative */
	{ "volts", 1 },    /* peak of 100 um at mean velocity, before the filter */
	{ "gain", 0.909 }, /* of sensor 2 */
	{ "width", 1 },    /* of its coil, over that of sensor 1 */
	{ "snr", 30 },     /* dB: volts over the noise of a sample */
	{ "negative", 0 }, /* share of particles with reversed pulses */
	{ "highpass", 0 }, /* corner of a high-pass, Hz; 0: none */
	{ "orders", 1 },   /* poles of the high-pass */
	{ "lowpass", 0 },  /* corner of a low-pass, Hz */
	{ "poles", 1 },    /* of the low-pass */
	{ "through", 1 },  /* 1: the noise passes both filters, too */
	{ "colour", 0 },   /* corner of the noise itself, Hz */
	{ "common", 0 },   /* correlation of the noise of both sensors */
	{ "hum", 0 },      /* amplitude of 50 Hz, with harmonics 3 and 5, V */
	{ "wander", 0 },   /* rms of its frequency, Hz */
	{ "sweep", 0 },    /* amplitude of a tone that sweeps, V, ... */
	{ "sweepfrom", 100 }, { "sweepto", 150 }, /* ... between these frequencies, Hz */
	{ "baseline", 0 },  /* random walk, V per root of a second */
	{ "flowdrift", 0 }, /* change of the velocity over the record */
	{ "jump", 1 },      /* factor of the velocity from the middle of the record on */
	{ "gaindrift", 0 }, /* change of the gain of sensor 2 */
	{ "noiserise", 1 }, /* noise at the end over noise at the beginning */
	{ "crosstalk", 0 }, /* share of either channel on the other */
	{ "clip", 0 },      /* limit, V; 0: none */
	{ "behind", 0 },    /* white noise behind the limit, over that before it */
	{ "bubbles", 0 },   /* events per second */
	{ "shocks", 0 },    /* ... */
	{ "impulses", 0 },  /* ... */
	{ "dropouts", 0 },  /* ... */
	{ "nan", 0 },       /* 1: samples in them are nan, not 0 */
	{ "step", 0 },      /* of the converter, V; 0: none */
	{ "still", 1 },     /* sensor 2 is constant behind this share of the record */
};

static const char *shape_name = "sine", *profile = "plug", *arrange = "single";
static const char *record_file, *truth_file;

static double get(const char *key)
{
	for (size_t i = 0; i < sizeof options / sizeof *options; i++)
		if (strcmp(options[i].key, key) == 0)
			return options[i].value;
	fprintf(stderr, "simulate: no key %s\n", key);
	exit(2);
}

static void set(const char *word)
{
	const char *value = strchr(word, '=');
	size_t length = value ? (size_t)(value - word) : 0;
	static const struct {
		const char *key;
		const char **text;
	} texts[] = { { "shape", &shape_name }, { "profile", &profile },
		{ "arrange", &arrange }, { "record", &record_file },
		{ "truth", &truth_file } };

	for (size_t i = 0; value && i < sizeof texts / sizeof *texts; i++)
		if (strlen(texts[i].key) == length &&
			strncmp(texts[i].key, word, length) == 0) {
			*texts[i].text = value + 1;
			return;
		}
	for (size_t i = 0; value && i < sizeof options / sizeof *options; i++)
		if (strlen(options[i].key) == length &&
			strncmp(options[i].key, word, length) == 0) {
			char *end;

			options[i].value = strtod(value + 1, &end);
			if (end > value + 1 && !*end)
				return;
		}
	fprintf(stderr, "simulate: '%s' is no key=value\n", word);
	exit(2);
}

static void *allocate(size_t count, size_t size)
{
	void *p = calloc(count ? count : 1, size);

	if (!p) {
		fprintf(stderr, "simulate: no memory\n");
		exit(1);
	}
	return p;
}

/* Random numbers: xorshift64*, Box and Muller. */
static uint64_t state;

static double uniform(void)
{
	state ^= state >> 12;
	state ^= state << 25;
	state ^= state >> 27;
	return ((double)((state * 2685821657736338717u) >> 11) + 0.5) /
	       9007199254740992.0;
}

static double between(double a, double b)
{
	return a + (b - a) * uniform();
}

static double normal(void)
{
	static double spare;
	static int have;
	double r, a;

	if (have) {
		have = 0;
		return spare;
	}
	r = sqrt(-2 * log(uniform()));
	a = 2 * M_PI * uniform();
	spare = r * sin(a);
	have = 1;
	return r * cos(a);
}

/* Pulses over s = (t - arrival) / duration; the first lobe has the peak 1. */
static double sine(double s)
{
	return fabs(s) < 0.5 ? -sin(2 * M_PI * s) : 0;
}

static double gauss(double s)
{
	double x = 2 * M_PI * s;

	return -x * exp(0.5 - x * x / 2);
}

static double lorentz(double s)
{
	double x = 2 * M_PI * s, q = 1 + x * x;

	return -16 / (3 * sqrt(3)) * x / (q * q);
}

/* The second lobe is longer and lower, of equal area. */
static double skew(double s)
{
	return s < 0 ? gauss(s) : 0.75 * gauss(0.75 * s);
}

static double echo(double s)
{
	return sine(s) + 0.12 * sine(s - 0.7);
}

/* Two flat lobes apart; three lobes; one with long tails that fall exponentially. */
static double trapezoid(double s)
{
	double x = fabs(fabs(s) - 0.3) / 0.22;
	double y = x < 0.4 ? 1 : x < 1 ? 0.5 + 0.5 * cos(M_PI * (x - 0.4) / 0.6) : 0;

	return s < 0 ? y : -y;
}

static double triple(double s)
{
	double a = (s + 0.42) / 0.13, b = (s + 0.1) / 0.13, c = (s - 0.25) / 0.15;

	return exp(-b * b / 2) - 0.3 * exp(-a * a / 2) - 0.7 * exp(-c * c / 2);
}

static double sech(double s)
{
	double c = 1 / cosh(7 * s);

	return -tanh(7 * s) * c * c * 2.598076211353316;
}

/* No particle: one lobe alone, and a ringing that begins at 0. */
static double bump(double s)
{
	return fabs(s) < 0.5 ? 0.5 + 0.5 * cos(2 * M_PI * s) : 0;
}

static double ring(double s)
{
	return s > 0 ? sin(2 * M_PI * s) * exp(-s / 0.8) : 0;
}

static const struct shape {
	const char *name;
	double (*at)(double s);
	double from, to; /* where it is not 0 */
} shapes[] = {
	{ "sine", sine, -0.5, 0.5 },
	{ "gauss", gauss, -1.1, 1.1 },
	{ "lorentz", lorentz, -6, 6 },
	{ "skew", skew, -1.1, 1.5 },
	{ "echo", echo, -0.5, 1.2 },
	{ "trapezoid", trapezoid, -0.55, 0.55 },
	{ "triple", triple, -1.1, 1.1 },
	{ "sech", sech, -2.8, 2.8 },
	{ "bump", bump, -0.5, 0.5 },
	{ "ring", ring, 0, 8 },
};

static const struct shape *find_shape(const char *name)
{
	for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
		if (strcmp(shapes[i].name, name) == 0)
			return &shapes[i];
	fprintf(stderr, "simulate: no shape %s\n", name);
	exit(2);
}

enum kind { PARTICLE, BUBBLE, SHOCK, IMPULSE, DROPOUT };
static const char *const kinds[] = { "particle", "bubble", "shock", "impulse",
	"dropout" };

struct event {
	enum kind kind;
	const struct shape *shape;
	double time[2], duration, level[2], diameter;
	double begin, end, peak, energy, lost, bound[PARAMETERS];
	double *slope[2][PARAMETERS]; /* whitened, of n samples from first */
	double (*cross)[PARAMETERS *
			PARAMETERS];     /* Fisher matrix with the events behind it */
	unsigned char known[NEIGHBOURS]; /* which of them are there */
	long first;
	size_t n;
};

static struct event *events;
static size_t count, room;

static struct event *add_event(enum kind kind)
{
	if (count == room) {
		room = room ? 2 * room : 256;
		events = realloc(events, room * sizeof *events);
		if (!events)
			exit(1);
	}
	memset(&events[count], 0, sizeof *events);
	events[count].kind = kind;
	return &events[count++];
}

/* Velocity over the mean, of a particle at random, flux-weighted. */
static double draw_velocity(void)
{
	double wall = get("wall");

	if (strcmp(profile, "plug") == 0)
		return 1 / (1 + get("spread") * between(-1, 1));
	for (;;) {
		double r = wall * sqrt(uniform());
		double v = strcmp(profile, "laminar") == 0
				   ? 2 * (1 - r * r)
				   : 60. / 49 * pow(1 - r, 1. / 7);

		if (uniform() * 2 < v)
			return v;
	}
}

static double flow_at(double t)
{
	double s = t / get("seconds") - 0.5;

	return (1 + get("flowdrift") * s) * (s < 0 ? 1 : get("jump"));
}

static void add_particle(double t)
{
	struct event *e = add_event(PARTICLE);
	double v = draw_velocity() * flow_at(t);
	double d = between(get("smallest"), get("largest"));

	e->shape = find_shape(shape_name);
	e->diameter = d;
	e->duration = get("duration") / v;
	if (get("vary") > 0)
		e->duration *= 1 + get("vary") * between(-1, 1);
	e->time[0] = t;
	e->time[1] = t + get("transit") / v;
	e->level[0] = get("volts") * v * pow(d / 100e-6, 3);
	if (uniform() < get("negative"))
		e->level[0] = -e->level[0];
	e->level[1] = e->level[0] * get("gain") *
		      (1 + get("gaindrift") * (t / get("seconds") - 0.5));
	if (get("ratio") > 0)
		e->level[1] *= exp(get("ratio") * normal());
}

/* Arrivals leave room for whole pulses. */
static void add_particles(void)
{
	double T = get("duration"), begin = 3 * T, number = get("number");
	double end = get("seconds") - 3 * T - 1.5 * get("transit"), t = begin;
	int n = (int)number;

	if (strcmp(arrange, "poisson") == 0) {
		for (t -= log(uniform()) / number; t < end; t -= log(uniform()) / number)
			add_particle(t);
	} else if (strcmp(arrange, "group") == 0) {
		double mean = n / 2.5, period = (end - begin) / mean;

		for (int k = 0; k < (int)mean; k++) {
			int m = 1 + k % 4;
			double at[4], slack = 0.6 * T * m - 0.1 * T * (m - 1);

			for (int i = 0; i < m; i++)
				at[i] = between(0, slack);
			for (int i = 0; i < m; i++) {
				int before = 0;

				for (int j = 0; j < m; j++)
					before += at[j] < at[i];
				add_particle(begin + period * (k + 0.2) + at[i] +
					     0.1 * T * before);
			}
		}
	} else {
		double gap = get("gap") * T, slack = end - begin - gap * (n - 1);

		if (slack <= 0) {
			fprintf(stderr, "simulate: no room for %d particles\n", n);
			exit(2);
		}
		for (int i = 0; i < n;
			i++) { /* the smallest of the n - i that are left */
			double free = begin + slack + gap * i;

			t += gap * (i > 0);
			t += (free - t) * (1 - pow(uniform(), 1. / (n - i)));
			add_particle(t);
		}
	}
}

/* Events of this kind at random, as many per second. */
static void add_foreign(enum kind kind, const char *key)
{
	double T = get("duration"), rate = get(key), end = get("seconds") - 5 * T;

	if (rate <= 0)
		return;
	for (double t = 5 * T - log(uniform()) / rate; t < end;
		t -= log(uniform()) / rate) {
		struct event *e = add_event(kind);
		double level = get("volts") * between(0.4, 1.6);

		e->time[0] = e->time[1] = t;
		e->duration = T;
		e->level[0] = uniform() < 0.5 ? level : -level;
		e->level[1] = e->level[0] * between(0.7, 1.1);
		if (kind == BUBBLE) {
			e->shape = find_shape("bump");
			e->time[1] += get("transit") / draw_velocity() / flow_at(t);
			e->duration = T * between(1.5, 3);
		} else if (kind == SHOCK) {
			e->shape = find_shape("ring");
			e->duration = T * between(0.3, 1);
		} else if (kind == IMPULSE) {
			e->duration = (1 + floor(3 * uniform())) / get("rate");
			e->level[0] *= 3;
			e->level[1] *= uniform() < 0.5 ? 3 : 0;
		} else {
			e->duration = between(0.5, 4) * T;
		}
	}
}

/* One-pole filters. Between samples of the input, h apart, it is interpolated linearly.
 */
static void low_pass(double *y, size_t n, double h, double corner)
{
	double w = 2 * M_PI * corner * h, a = exp(-w), q = -expm1(-w) / w, x = 0, out = 0;

	for (size_t i = 0; i < n; i++) {
		double next = y[i];

		out = a * out + (q - a) * x + (1 - q) * next;
		y[i] = out;
		x = next;
	}
}

static void high_pass(double *y, size_t n, double h, double corner)
{
	double w = 2 * M_PI * corner * h, a = exp(-w), q = -expm1(-w) / w, x = 0, out = 0;

	for (size_t i = 0; i < n; i++) {
		double next = y[i];

		out = a * out + (q - a) * x + (1 - q) * next;
		y[i] = next - out;
		x = next;
	}
}

/* The same for white noise at the rate of the record, and its inverse. */
static double pole(double corner)
{
	return exp(-2 * M_PI * corner / get("rate"));
}

static void colour_noise(double *y, size_t n)
{
	double k = pole(get("colour")), own = sqrt(1 - k * k), out = normal();

	if (get("colour") > 0)
		for (size_t i = 0; i < n; i++)
			y[i] = out = k * out + own * y[i];
	for (int p = 0; p < get("poles") && get("lowpass") > 0 && get("through") > 0;
		p++) {
		k = pole(get("lowpass"));
		out = 0;
		for (size_t i = 0; i < n; i++)
			y[i] = out = k * out + (1 - k) * y[i];
	}
	for (int p = 0; p < get("orders") && get("highpass") > 0 && get("through") > 0;
		p++) {
		double x = 0;

		k = pole(get("highpass"));
		out = 0;
		for (size_t i = 0; i < n; i++) {
			double next = y[i];

			y[i] = out = k * out + (1 + k) / 2 * (next - x);
			x = next;
		}
	}
}

static void whiten(double *y, size_t n)
{
	double k, last;

	for (int p = 0; p < get("orders") && get("highpass") > 0 && get("through") > 0;
		p++) {
		double sum = 0;

		k = pole(get("highpass"));
		last = 0;
		for (size_t i = 0; i < n; i++) {
			double out = y[i];

			y[i] = sum += (out - k * last) * 2 / (1 + k);
			last = out;
		}
	}
	for (int p = 0; p < get("poles") && get("lowpass") > 0 && get("through") > 0;
		p++) {
		k = pole(get("lowpass"));
		last = 0;
		for (size_t i = 0; i < n; i++) {
			double out = y[i];

			y[i] = (out - k * last) / (1 - k);
			last = out;
		}
	}
	k = pole(get("colour"));
	last = 0;
	if (get("colour") > 0)
		for (size_t i = 0; i < n; i++) {
			double out = y[i];

			y[i] = (out - k * last) / sqrt(1 - k * k);
			last = out;
		}
}

/* Duration of the pulse of an event at either sensor. */
static double lasts(const struct event *e, int c)
{
	return e->duration * (c ? get("width") : 1);
}

/* Samples that the pulses of an event fill at either sensor, with the tail of the
 * filters. */
static void extent(const struct event *e, int c, long *first, size_t *n)
{
	double rate = get("rate"), tail = 0, t = e->time[c], T = lasts(e, c), last;

	if (get("highpass") > 0)
		tail = (5 + get("orders")) / (2 * M_PI * get("highpass"));
	if (get("lowpass") > 0)
		tail += 12 / (2 * M_PI * get("lowpass"));
	*first = (long)floor((t + e->shape->from * T) * rate) - 2;
	last = ceil((t + e->shape->to * T + tail) * rate) + 2;
	*n = (size_t)(last - (double)*first);
}

/* A pulse of amplitude 1 behind the filters. */
static void render(
	const struct shape *shape, double t, double T, long first, size_t n, double *y)
{
	int filtered = get("highpass") > 0 || get("lowpass") > 0;
	size_t fine = filtered ? 8 : 1;
	double h = 1 / get("rate") / (double)fine, begin = (double)first / get("rate");
	double *x = allocate(n * fine, sizeof *x);

	for (size_t i = 0; i < n * fine; i++) {
		double s = (begin + (double)i * h - t) / T;

		x[i] = s > shape->from && s < shape->to ? shape->at(s) : 0;
	}
	for (int p = 0; p < get("poles") && get("lowpass") > 0; p++)
		low_pass(x, n * fine, h, get("lowpass"));
	for (int p = 0; p < get("orders") && get("highpass") > 0; p++)
		high_pass(x, n * fine, h, get("highpass"));
	for (size_t i = 0; i < n; i++)
		y[i] = x[i * fine];
	free(x);
}

/* Adds an event to both channels of N samples. */
static void draw_event(struct event *e, double *x, long N)
{
	double rate = get("rate");

	e->begin = e->time[0];
	e->end = e->time[1];
	for (int c = 0; c < 2 && e->shape; c++) {
		long first;
		size_t n;
		double *y, most = 0;

		extent(e, c, &first, &n);
		y = allocate(n, sizeof *y);
		render(e->shape, e->time[c], lasts(e, c), first, n, y);
		for (size_t i = 0; i < n; i++) {
			long k = first + (long)i;

			most = fmax(most, fabs(y[i]));
			if (k >= 0 && k < N)
				x[2 * k + c] += e->level[c] * y[i];
		}
		if (c == 0)
			e->peak = e->level[0] * most;
		free(y);
	}
	if (e->shape) {
		e->begin += e->shape->from * e->duration;
		e->end += e->shape->to * lasts(e, 1);
	} else {
		e->end += e->duration;
		e->peak = e->level[0];
	}
	for (long k = (long)(e->time[0] * rate);
		e->kind == IMPULSE && (double)k < e->end * rate && k < N; k++)
		for (int c = 0; c < 2; c++)
			x[2 * k + c] += e->level[c];
}

static double noise_at(double t)
{
	return get("volts") * pow(10, -get("snr") / 20) *
	       (1 + (get("noiserise") - 1) * t / get("seconds"));
}

static void add_noise(double *x, long N)
{
	double rate = get("rate"), rho = get("common"), own = sqrt(1 - rho * rho);
	double *y[2];

	for (int c = 0; c < 2; c++)
		y[c] = allocate((size_t)N, sizeof *y[c]);
	for (long i = 0; i < N; i++) {
		y[0][i] = normal();
		y[1][i] = rho * y[0][i] + own * normal();
	}
	for (int c = 0; c < 2; c++) {
		double walk = 0, leak = exp(-2 * M_PI * 0.05 / rate);
		double step = get("baseline") / sqrt(rate), begin = noise_at(0);
		double rise = (noise_at(1) - begin) / rate;

		colour_noise(y[c], (size_t)N);
		for (long i = 0; i < N; i++) {
			if (step > 0)
				walk = leak * walk + step * normal();
			x[2 * i + c] += (begin + rise * (double)i) * y[c][i] + walk;
		}
		free(y[c]);
	}
}

/* Mains whose frequency is an Ornstein-Uhlenbeck process of 2 s. */
static void add_hum(double *x, long N)
{
	double rate = get("rate"), keep = exp(-0.5 / rate),
	       off = get("wander") * normal();
	double turn = uniform(), shift = uniform(), level = get("hum");
	double kick = get("wander") * sqrt(1 - keep * keep);

	for (long i = 0; i < N && level > 0; i++) {
		off = keep * off + kick * normal();
		turn += (50 + off) / rate;
		for (int c = 0; c < 2; c++) {
			double a = 2 * M_PI * (turn + c * shift);

			x[2 * i + c] +=
				level * (sin(a) + 0.4 * sin(3 * a) + 0.1 * sin(5 * a));
		}
	}
}

/* A tone whose frequency changes linearly over the record. */
static void add_sweep(double *x, long N)
{
	double rate = get("rate"), from = get("sweepfrom"),
	       change = get("sweepto") - from;
	double level = get("sweep"), first = level > 0 ? uniform() : 0, shift = 0.3;

	for (long i = 0; i < N && level > 0; i++) {
		double t = (double)i / rate;
		double turn = (from + change * (double)i / (double)N / 2) * t + first;

		for (int c = 0; c < 2; c++)
			x[2 * i + c] += level * sin(2 * M_PI * (turn + c * shift));
	}
}

static void mix_channels(double *x, long N)
{
	double share = get("crosstalk");

	for (long i = 0; i < N; i++) {
		double first = x[2 * i];

		x[2 * i] += share * x[2 * i + 1];
		x[2 * i + 1] += share * first;
	}
}

/* Clipping, dropouts and the converter; masked[] becomes 1 where samples are lost. */
static void spoil(double *x, long N, unsigned char *masked)
{
	double clip = get("clip"), step = get("step"), rate = get("rate");

	for (size_t i = 0; i < count; i++)
		if (events[i].kind == DROPOUT)
			for (long k = (long)(events[i].time[0] * rate);
				(double)k < events[i].end * rate && k < N; k++) {
				x[2 * k] = x[2 * k + 1] = get("nan") > 0 ? NAN : 0;
				masked[2 * k] = masked[2 * k + 1] = 1;
			}
	for (long k = 0; k < 2 * N; k++) {
		if (clip > 0 && fabs(x[k]) >= clip) {
			x[k] = x[k] > 0 ? clip : -clip;
			masked[k] = 1;
		}
		if (get("behind") > 0)
			x[k] += get("behind") * noise_at((double)k / 2 / rate) * normal();
		if (step > 0)
			x[k] = step * round(x[k] / step);
		if (k % 2 == 1 && (double)k / 2 > get("still") * (double)N) {
			x[k] = x[k - 2];
			masked[k] = 1;
		}
	}
}

static void note_masked(struct event *e, long N, const unsigned char *masked)
{
	for (int c = 0; c < 2; c++) {
		long first;
		size_t n;
		double *y;

		extent(e, c, &first, &n);
		y = allocate(n, sizeof *y);
		render(e->shape, e->time[c], lasts(e, c), first, n, y);
		for (size_t i = 0; i < n; i++) {
			long k = first + (long)i;

			e->energy += y[i] * y[i];
			if (k < 0 || k >= N || masked[2 * k + c])
				e->lost += y[i] * y[i];
		}
		free(y);
	}
}

/* Derivatives of the two pulses by arrival, transit time and logarithm of the amplitude,
 * in units of white noise. */
static void make_slopes(struct event *e)
{
	double tau = e->time[1] - e->time[0], h = 1e-3 * e->duration,
	       sigma = hypot(noise_at(e->time[0]) * hypot(1, get("behind")),
		       get("step") / sqrt(12)),
	       rho = get("common");
	long last;
	size_t n;

	e->cross = allocate(NEIGHBOURS, sizeof *e->cross);
	extent(e, 0, &e->first, &n);
	extent(e, 1, &last, &n);
	e->n = (size_t)(last - e->first) + n;
	for (int c = 0; c < 2; c++)
		for (int p = 0; p < PARAMETERS; p++) {
			double *a = allocate(e->n, sizeof *a),
			       *b = allocate(e->n, sizeof *b);
			double t = e->time[c], dt = p == 0 ? h : p == 1 && c ? h : 0;
			double T = lasts(e, c);
			double dT = p == 1 ? h * T / tau : 0;

			render(e->shape, t + dt, T + dT, e->first, e->n, a);
			if (p < 2)
				render(e->shape, t - dt, T - dT, e->first, e->n, b);
			for (size_t i = 0; i < e->n; i++)
				a[i] = e->level[c] / sigma *
				       (p < 2 ? (a[i] - b[i]) / (2 * h) : a[i]);
			free(b);
			whiten(a, e->n);
			e->slope[c][p] = a;
		}
	for (int p = 0; p < PARAMETERS; p++)
		for (size_t i = 0; i < e->n; i++)
			e->slope[1][p][i] =
				(e->slope[1][p][i] - rho * e->slope[0][p][i]) /
				sqrt(1 - rho * rho);
}

static void drop_slopes(struct event *e)
{
	free(e->cross);
	e->cross = NULL;
	for (int c = 0; c < 2; c++)
		for (int p = 0; p < PARAMETERS; p++) {
			free(e->slope[c][p]);
			e->slope[c][p] = NULL;
		}
}

static double inner(const struct event *a, int p, const struct event *b, int q)
{
	long from = a->first > b->first ? a->first : b->first;
	long end_a = a->first + (long)a->n, end_b = b->first + (long)b->n;
	long to = end_a < end_b ? end_a : end_b;
	double sum = 0;

	for (int c = 0; c < 2; c++) {
		const double *x = a->slope[c][p] - a->first,
			     *y = b->slope[c][q] - b->first;

		for (long k = from; k < to; k++)
			sum += x[k] * y[k];
	}
	return sum;
}

/* Fisher matrix of the parameters of a by those of b, which is a or behind it. */
static const double *cross(struct event *a, struct event *b)
{
	static const double none[PARAMETERS * PARAMETERS];
	const double scale[PARAMETERS] = { get("duration"), get("duration"), 1 };
	long k = b - a;

	if (k >= NEIGHBOURS)
		return none;
	if (!a->known[k])
		for (int p = 0; p < PARAMETERS; p++)
			for (int q = 0; q < PARAMETERS; q++)
				a->cross[k][PARAMETERS * p + q] =
					scale[p] * scale[q] * inner(a, p, b, q);
	a->known[k] = 1;
	return a->cross[k];
}

/* Diagonal of the inverse of f (m x m, row by row, destroyed) for one parameter; nan
 * where f is not positive definite. */
static double inverse_diagonal(double *f, int m, int which, double *work)
{
	for (int j = 0; j < m; j++) {
		double d = f[j * m + j];

		for (int k = 0; k < j; k++)
			d -= f[j * m + k] * f[j * m + k];
		if (!(d > 0))
			return NAN;
		f[j * m + j] = d = sqrt(d);
		for (int i = j + 1; i < m; i++) {
			double s = f[i * m + j];

			for (int k = 0; k < j; k++)
				s -= f[i * m + k] * f[j * m + k];
			f[i * m + j] = s / d;
		}
	}
	/* |L^-1 e|^2 */
	double sum = 0;

	for (int i = 0; i < m; i++) {
		double s = i == which;

		for (int k = 0; k < i; k++)
			s -= f[i * m + k] * work[k];
		work[i] = s / f[i * m + i];
		sum += work[i] * work[i];
	}
	return sum;
}

/* Bounds of particle i of those in list[0 .. n), which are in order. */
static void bound_of(struct event *const *list, int n, int i)
{
	int m = PARAMETERS * n;
	double *f = allocate((size_t)(m * m), sizeof *f);
	double *g = allocate((size_t)(m * m), sizeof *g);
	double *work = allocate((size_t)m, sizeof *work);

	for (int a = 0; a < n; a++)
		for (int b = 0; b <= a; b++) {
			const double *block = cross(list[b], list[a]);

			for (int p = 0; p < PARAMETERS; p++)
				for (int q = 0; q < PARAMETERS; q++)
					f[(PARAMETERS * a + p) * m + PARAMETERS * b + q] =
						block[PARAMETERS * q + p];
		}
	for (int p = 0; p < PARAMETERS; p++) {
		memcpy(g, f, (size_t)(m * m) * sizeof *f);
		list[i]->bound[p] =
			(p < 2 ? get("duration") : 1) *
			sqrt(inverse_diagonal(g, m, PARAMETERS * i + p, work));
	}
	free(f);
	free(g);
	free(work);
}

/* Events are in order of time1. */
static void make_bounds(void)
{
	size_t made = 0, dropped = 0;

	for (size_t i = 0; i < count; i++) {
		struct event *list[NEIGHBOURS], *e = &events[i];
		double reach = 3 * fmax(e->duration, get("duration"));
		int n = 0, self = 0;

		if (e->kind != PARTICLE)
			continue;
		for (; made < count && events[made].time[0] < e->time[0] + reach; made++)
			if (events[made].kind == PARTICLE)
				make_slopes(&events[made]);
		for (; events[dropped].time[0] < e->time[0] - 6 * reach; dropped++)
			if (events[dropped].kind == PARTICLE)
				drop_slopes(&events[dropped]);
		for (size_t k = dropped; k < made && n < NEIGHBOURS; k++)
			if (events[k].kind == PARTICLE &&
				fabs(events[k].time[0] - e->time[0]) < reach) {
				self = k == i ? n : self;
				list[n++] = &events[k];
			}
		bound_of(list, n, self);
	}
	for (size_t i = 0; i < made; i++)
		if (events[i].kind == PARTICLE)
			drop_slopes(&events[i]);
}

static int by_time(const void *a, const void *b)
{
	double x = ((const struct event *)a)->time[0],
	       y = ((const struct event *)b)->time[0];

	return (x > y) - (x < y);
}

static FILE *create(const char *path)
{
	FILE *f = path ? fopen(path, "wb") : NULL;

	if (!f) {
		fprintf(stderr, "simulate: cannot write %s\n",
			path ? path : "record=, truth=");
		exit(1);
	}
	return f;
}

static void put_bytes(FILE *f, uint64_t word, int bytes)
{
	for (int i = bytes - 1; i >= 0; i--)
		putc((int)(word >> 8 * i & 255), f);
}

static void write_record(const double *x, long N)
{
	FILE *f = create(record_file);
	const uint32_t header[] = { 0x2e736e64, 32, 0xffffffff, 7, (uint32_t)get("rate"),
		2, 0, 0 };

	for (int i = 0; i < 8; i++)
		put_bytes(f, header[i], 4);
	for (long i = 0; i < 2 * N; i++) {
		uint64_t bits;

		memcpy(&bits, &x[i], sizeof bits);
		put_bytes(f, bits, 8);
	}
	if (fclose(f) != 0)
		exit(1);
}

static void write_truth(void)
{
	FILE *f = create(truth_file);

	fprintf(f,
		"kind\ttime1\ttime2\tdelay\tamplitude\tdiameter\tduration\tbegin\tend\t"
		"masked\ttime1_bound\tdelay_bound\tamplitude_bound\n");
	for (size_t i = 0; i < count; i++) {
		const struct event *e = &events[i];
		int one = e->kind == PARTICLE;

		fprintf(f, "%s\t%.9g\t%.9g\t%.9g\t%.9g\t%.9g\t%.9g\t%.9g\t%.9g\t%.3g",
			kinds[e->kind], e->time[0], e->time[1], e->time[1] - e->time[0],
			e->peak, one ? e->diameter : NAN, e->duration, e->begin, e->end,
			one ? e->lost / e->energy : 0);
		for (int p = 0; p < PARAMETERS; p++)
			fprintf(f, "\t%.6g", one ? e->bound[p] : NAN);
		putc('\n', f);
	}
	if (fclose(f) != 0)
		exit(1);
}

int main(int argc, char **argv)
{
	long N;
	double *x;
	unsigned char *masked;

	for (int i = 1; i < argc; i++)
		set(argv[i]);
	N = (long)(get("seconds") * get("rate"));
	state = 0x9e3779b97f4a7c15u * ((uint64_t)get("seed") + 1);
	for (int i = 0; i < 20; i++)
		uniform();
	x = allocate(2 * (size_t)N, sizeof *x);
	masked = allocate(2 * (size_t)N, 1);
	add_particles();
	add_foreign(BUBBLE, "bubbles");
	add_foreign(SHOCK, "shocks");
	add_foreign(IMPULSE, "impulses");
	add_foreign(DROPOUT, "dropouts");
	qsort(events, count, sizeof *events, by_time);
	for (size_t i = 0; i < count; i++)
		draw_event(&events[i], x, N);
	add_noise(x, N);
	add_hum(x, N);
	add_sweep(x, N);
	mix_channels(x, N);
	spoil(x, N, masked);
	for (size_t i = 0; i < count; i++)
		if (events[i].kind == PARTICLE)
			note_masked(&events[i], N, masked);
	make_bounds();
	write_record(x, N);
	write_truth();
	free(x);
	free(masked);
	free(events);
	return 0;
}
