/* ballcal - calibrate a debris sensor by reference balls */
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "common/verdicts.h"
#include "count/detection.h"
#include "count/line.h"
#include "io/quantities.h"
#include "io/reasons.h"
#include "io/tables.h"
#include "num/room.h"
#include "num/select.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Level of the tests of the exponent and of the fit: one right calibration in a hundred
 * is called wrong by each. */
static const double UNLIKELY = 0.01;

static struct opt_texts balls;
static double exponent = 3, confidence = 0.95, noise = NAN, duration = NAN;
static double alarms = 1.0 / 3600, velocity = NAN;

static const struct opt opts[] = {
	{ 0, "balls", OPT_TEXTS, UNIT_NONE, &balls, 0, 0, "FILE:D",
		"pulses of balls of diameter D; may be repeated", NULL, 0 },
	OPT_TABLE(verdict_rows),
	{ 0, "exponent", OPT_NUM, UNIT_NONE, &exponent, 0.1, 20, "N",
		"exponent of the diameter: 3, or 5 for non-ferrous balls", NULL, 0 },
	{ 0, "confidence", OPT_NUM, UNIT_FRACTION, &confidence, 0.01, 0.9999, "C",
		"confidence level of the intervals", NULL, 0 },
	{ 0, "noise", OPT_NUM, UNIT_VOLTAGE, &noise, 1e-30, 1e9, "V",
		"standard deviation of the noise behind the matched filter (default from amplitude_se)",
		NULL, 0 },
	{ 0, "pulse-duration", OPT_NUM, UNIT_TIME, &duration, 1e-12, 1e9, "T",
		"duration of a pulse: for the smallest size", NULL, 0 },
	{ 0, "false-alarms", OPT_NUM, UNIT_FREQUENCY, &alarms, 1e-30, 1e12, "F",
		"accepted number of false detections per second", NULL, 0 },
	{ 0, "velocity", OPT_NUM, UNIT_SPEED, &velocity, 1e-9, 1e6, "V",
		"velocity for the smallest size (default mean of the balls)", NULL, 0 },
	OPT_END,
};

static const struct prog prog = { "ballcal",
	"Calibrate a debris sensor with the pulses of reference balls.", "",
	"nothing; --balls: tables: amplitude velocity [verdict]",
	"table: constant, exponent, smallest size", opts };

/* One pulse: logarithms of its ball's diameter and of amplitude over velocity. */
struct pulse {
	double diameter, response;
	int table, alone; /* alone: does not overlap another */
};

struct pulses {
	struct pulse *pulse;
	size_t n, room;
	double speed;          /* sum of velocities */
	int signs[2];          /* tables of positive and of negative amplitudes */
	int equal;             /* tables of pulses that do not differ */
	struct reasons doubts; /* of tables, by their own account */
	double outlier_p;      /* the least of the tables; nan: none has three pulses */
	/* Squared standard errors of the amplitudes of pulses that stand alone, whose
	 * fit is the matched filter: their sum and number. */
	double squares, alone;
};

/* Reads "FILE:DIAMETER"; fresh memory. */
static char *split(const char *text, double *diameter)
{
	const char *colon = strrchr(text, ':'), *end, *wrong;
	char *path;

	if (!colon || colon == text)
		die(EXIT_USAGE, "--balls %s: want FILE:D", text);
	wrong = unit_parse(colon + 1, UNIT_LENGTH, "", diameter, &end);
	if (!wrong && *diameter > DIAMETER_MOST)
		wrong = "is more than 0.1 m";
	if (wrong || !(*diameter > 0))
		die(EXIT_USAGE, "--balls %s: '%s' %s, want a diameter", text, colon + 1,
			wrong ? wrong : "is not above 0");
	path = xstrdup(text);
	path[colon - text] = '\0';
	return path;
}

/* Magnitude; the amplitudes of a table have one sign, which a sensor that is connected
 * the other way round, or a non-ferrous ball, makes negative. */
static double amplitude_of(const struct table_in *t, int column, double *sign)
{
	double a = table_number(t, column);

	if (!isfinite(a) || a == 0)
		die(EXIT_RUN, "%s: line %ld: amplitude is %g, want a number other than 0",
			table_name(t), table_line(t), a);
	if (a * *sign < 0)
		die(EXIT_RUN,
			"%s: line %ld: amplitude is %g, want the sign of those before",
			table_name(t), table_line(t), a);
	*sign = a > 0 ? 1 : -1;
	return fabs(a);
}

/* The number, from 1, of the first pulse that stands alone with a response in a range. */
static size_t first_within(const struct pulses *p, size_t from, double low, double high)
{
	size_t i = from;

	while (!p->pulse[i].alone || exp(p->pulse[i].response) < low ||
		exp(p->pulse[i].response) > high)
		i++;
	return i - from + 1;
}

/* The balls of one table are equal.  Pulses of other particles among theirs change the
 * mean, and the scatter of equal pulses is unknown.  Overlapping pulses scatter by errors
 * of their own.  Noise adds to amplitudes, and what multiplies them, as the path of a
 * ball does, to their logarithms: outliers are those of either scale. */
static void compare(struct pulses *p, size_t from, const char *name)
{
	size_t n = 0;
	double *a = xcalloc(2 * (p->n - from), sizeof *a), *ln = a + (p->n - from);
	struct line_outliers other, scaled;

	for (size_t i = from; i < p->n; i++)
		if (p->pulse[i].alone)
			ln[n++] = p->pulse[i].response;
	if (n < 3) {
		free(a);
		return;
	}
	sort_numbers(ln, n);
	for (size_t i = 0; i < n; i++)
		a[i] = exp(ln[i]);
	if (a[n - 1] - a[0] <= 1e-12 * a[n - 1]) { /* rounding */
		warn("%s: all %zu pulses are equal: their scatter is unknown", name, n);
		p->equal++;
	}
	other = line_outliers(a, n);
	scaled = line_outliers(ln, n);
	if (scaled.p > other.p)
		other = scaled;
	other.p = fmin(1, balls.n * other.p);
	if (other.p < UNLIKELY) {
		double low = a[other.first], high = a[other.first + other.count - 1];

		warn("%s: %zu of %zu pulses are not of the same ball as the others, from "
		     "pulse %zu on, %.3g to %.3g V s/m: p = %.2g",
			name, other.count, n, first_within(p, from, low, high), low, high,
			other.p);
	}
	p->outlier_p = fmin(p->outlier_p, other.p);
	free(a);
}

static void read_balls(struct pulses *p, const char *text, int table)
{
	double diameter;
	char *path = split(text, &diameter);
	struct table_in *t;
	int more, ca, cv, cw, ce = -1;
	size_t before = p->n;
	double sign = 0;

	/* Pulses that count twice make intervals too narrow. */
	if (file_is_read(path))
		die(EXIT_USAGE, "--balls %s: the same file is given twice", text);
	t = table_open(path);
	more = table_next(t);
	ca = table_need_quantity(t, "amplitude", UNIT_VOLTAGE);
	cv = table_need_quantity(t, "velocity", UNIT_SPEED);
	cw = verdict_column(t);
	if (isnan(noise) && !isnan(duration))
		ce = table_need_quantity(t, "amplitude_se", UNIT_VOLTAGE);
	for (; more; more = table_next(t)) {
		double a, v;
		int alone = cw < 0 || strcmp(table_text(t, cw), "alone") == 0;

		if (verdict_of(t, cw) != VERDICT_SURE)
			continue;
		a = amplitude_of(t, ca, &sign);
		v = table_positive(t, cv);
		if (room_for(&p->pulse, &p->room, p->n + 1, sizeof *p->pulse))
			die(EXIT_RUN, "out of memory");
		p->pulse[p->n++] =
			(struct pulse){ log(diameter), log(a / v), table, alone };
		p->speed += v;
		if (ce >= 0 && alone) {
			p->squares += pow(table_positive(t, ce), 2);
			p->alone++;
		}
	}
	if (p->n == before)
		die(EXIT_RUN, "%s: no pulse for the calibration", table_name(t));
	p->signs[sign < 0]++;
	compare(p, before, table_name(t));
	reasons_add(&p->doubts, table_doubted(t));
	table_close(t);
	free(path);
}

static int by_diameter(const void *a, const void *b)
{
	double x = ((const struct pulse *)a)->diameter,
	       y = ((const struct pulse *)b)->diameter;

	return x < y ? -1 : x > y;
}

/* Half intervals of the constant and of the exponent, and the p-value of the latter; nan
 * where there are too few sizes. */
struct doubt {
	double constant, slope, slope_p;
};

/* Pulses of a table may share an error, such as that of the instrument which was
 * estimated from their record.  The intervals are therefore at least those of the means
 * of the tables, each a single observation: for the constant from two tables on, for the
 * exponent from three. */
static void allow_shared(const struct pulses *p, struct doubt *d)
{
	size_t tables = (size_t)balls.n;
	double *x = xcalloc(3 * tables, sizeof *x), *y = x + tables, *n = y + tables;
	double mean = 0, square = 0;
	struct line l;

	for (size_t i = 0; i < p->n; i++) {
		const struct pulse *q = &p->pulse[i];

		x[q->table] += q->diameter;
		y[q->table] += q->response;
		n[q->table]++;
	}
	for (size_t k = 0; k < tables; k++) {
		x[k] /= n[k];
		y[k] /= n[k];
		mean += (y[k] - exponent * x[k]) / (double)tables;
	}
	for (size_t k = 0; k < tables; k++)
		square += pow(y[k] - exponent * x[k] - mean, 2);
	d->constant = fmax(d->constant,
		line_t(confidence, (double)(tables - 1)) *
			sqrt(square / (double)(tables - 1) / (double)tables));
	/* Means of equal diameters differ by rounding. */
	if (!isnan(d->slope_p) && line_fit(x, y, tables, confidence, &l) == 0) {
		d->slope = fmax(d->slope, l.t * l.slope_se);
		d->slope_p = fmax(d->slope_p, line_slope_p(&l, exponent));
	}
	free(x);
}

static void put(struct table_out *t, const char *name, const char *unit, double value,
	double low, double high)
{
	table_put_text(t, name);
	table_put(t, value);
	table_put(t, low);
	table_put(t, high);
	table_put_text(t, unit);
	table_end_row(t);
}

/* Prints a quantity whose logarithm has this half interval. */
static void put_log(
	struct table_out *t, const char *name, const char *unit, double ln, double half)
{
	put(t, name, unit, exp(ln), exp(ln - half), exp(ln + half));
}

static void put_smallest(struct table_out *t, double ln_k, double half, double speed)
{
	struct detection d = { 1, detection_threshold(duration, alarms), exponent };
	double ln50 = (log(d.threshold * noise / speed) - ln_k) / exponent;
	put(t, "threshold", "1", d.threshold, NAN, NAN);
	put_log(t, "d50", "m", ln50, half / exponent);
	put_log(t, "d90", "m", ln50 + log(detection_diameter(&d, 0.9)), half / exponent);
}

int main(int argc, char **argv)
{
	struct pulses p = { .outlier_p = NAN };
	struct table_out *t;
	struct line l;
	double *x, *y, sizes = 1, ln_k = 0, deviation = 0, lack;
	struct doubt doubt = { NAN, NAN, NAN };
	int fitted, doubtful;
	const char *why; /* a table is doubtful, by its own account */
	char unit[40];   /* of amplitude over velocity and diameter to the exponent */

	opt_parse(&prog, argc, argv);
	if (!balls.n)
		die(EXIT_USAGE, "--balls is missing: FILE:D, a table of pulses and the "
				"diameter of its balls");
	opt_require("pulse-duration", "noise false-alarms velocity");
	if (!isnan(duration) && isnan(detection_threshold(duration, alarms)))
		die(EXIT_USAGE,
			"--false-alarms %g Hz: too many for any threshold with pulses of %g s",
			alarms, duration);
	for (int i = 0; i < balls.n; i++)
		read_balls(&p, balls.v[i], i);
	if (p.n < 3)
		die(EXIT_RUN, "want at least 3 pulses to estimate their scatter, got %zu",
			p.n);
	if (isnan(noise) && !isnan(duration) && p.alone == 0)
		die(EXIT_RUN,
			"no pulse stands alone: the amplitudes of others have larger "
			"errors than the noise: want --noise");
	qsort(p.pulse, p.n, sizeof *p.pulse, by_diameter);
	x = xcalloc(p.n, sizeof *x);
	y = xcalloc(p.n, sizeof *y);
	for (size_t i = 0; i < p.n; i++) {
		x[i] = p.pulse[i].diameter;
		y[i] = p.pulse[i].response;
		ln_k += (y[i] - exponent * x[i]) / (double)p.n;
		sizes += i > 0 && x[i] > x[i - 1];
	}
	for (size_t i = 0; i < p.n; i++)
		deviation += pow(y[i] - exponent * x[i] - ln_k, 2);
	deviation = sqrt(deviation / (double)(p.n - 1));
	doubt.constant =
		line_t(confidence, (double)(p.n - 1)) * deviation / sqrt((double)p.n);
	fitted = line_fit(x, y, p.n, confidence, &l) == 0;
	lack = fitted ? line_lack_of_fit(x, y, p.n) : NAN;
	if (fitted) {
		line_allow_unequal(
			x, y, p.n, confidence, &l); /* small balls scatter more */
		doubt.slope = l.t * l.slope_se;
		doubt.slope_p = line_slope_p(&l, exponent);
	}
	if (balls.n >= 2)
		allow_shared(&p, &doubt);
	why = reasons_text(&p.doubts);
	doubtful = doubt.slope_p < UNLIKELY || lack < UNLIKELY ||
		   p.outlier_p < UNLIKELY || p.equal || why || (p.signs[0] && p.signs[1]);
	if (p.signs[0] && p.signs[1])
		warn("amplitudes are positive in %d tables and negative in %d: balls of several "
		     "materials have no constant in common",
			p.signs[0], p.signs[1]);
	if (doubt.slope_p < UNLIKELY)
		warn("the exponent is %.3g, not %g: p = %.2g%s", l.slope, exponent,
			doubt.slope_p,
			balls.n < 3
				? ", unless a diameter or a record has an error of its own"
				: "");
	if (lack < UNLIKELY)
		warn("no power law fits all balls within the scatter of their pulses, p = %.2g: "
		     "diameters or records have errors of their own",
			lack);
	snprintf(unit, sizeof unit, "V.s/m^%g", exponent + 1);
	t = table_create(NULL, opt_cmd(NULL, NULL), "1 unit unit unit 1",
		"quantity value low high unit");
	/* The exit status is lost in a pipe. */
	if (doubtful)
		table_comment(
			t, "doubtful", "%s", why ? why : "the balls, as a warning says");
	put(t, "pulses", "1", (double)p.n, NAN, NAN);
	put(t, "sizes", "1", sizes, NAN, NAN);
	put_log(t, "calibration", unit, ln_k, doubt.constant);
	put(t, "scatter", "1", deviation, NAN, NAN);
	if (fitted) {
		put(t, "exponent", "1", l.slope, l.slope - doubt.slope,
			l.slope + doubt.slope);
		put(t, "exponent_p", "1", doubt.slope_p, NAN, NAN);
		put(t, "lack_of_fit_p", "1", lack, NAN, NAN);
	}
	put(t, "outlier_p", "1", p.outlier_p, NAN, NAN);
	if (isnan(noise))
		noise = sqrt(p.squares / p.alone);
	if (!isnan(duration))
		put_smallest(t, ln_k, doubt.constant,
			isnan(velocity) ? p.speed / (double)p.n : velocity);
	table_done(t);
	stats_set("pulses", (double)p.n);
	verdict_report();
	free(x);
	free(y);
	free(p.pulse);
	reasons_free(&p.doubts);
	return shell_done(doubtful ? EXIT_NOCONV : EXIT_SUCCESS);
}
