/* cnn.c - a network's first estimate of a section of overlapping pulses */
#include "net/cnn.h"
#include <math.h>

int cnn_suits(const struct network *net)
{
	struct network_shape in = network_input(net);

	return in.channels == 2 && in.height == 1 && in.width == CNN_POINTS &&
	       network_outputs(net) == CNN_OUTPUTS;
}

int cnn_head(int sources)
{
	return CNN_SOURCES + 3 * sources * (sources - 1) / 2;
}

/* Centre of the energy of both channels. */
static double find_centre(const struct cnn_section *s)
{
	double sum = 0, moment = 0;

	for (size_t i = 0; i < s->n; i++) {
		double e = s->y1[i] * s->y1[i] + s->y2[i] * s->y2[i];

		sum += e;
		moment += e * (double)i;
	}
	return sum > 0 ? moment / sum : -1;
}

/* Means of y over cells of the given width, the first of which begins at begin; sample i
 * fills [i - 1/2, i + 1/2), and outside of the section y is 0. */
static void average(const double *y, size_t n, double begin, double width, double *cell)
{
	for (int k = 0; k < CNN_POINTS; k++) {
		double a = begin + k * width + 0.5, b = a + width, sum = 0;

		a = fmax(a, 0);
		b = fmin(b, (double)n);
		if (a < b) {
			size_t i = (size_t)a, last = (size_t)b;

			sum = -y[i] * (a - (double)i);
			for (; i < last; i++)
				sum += y[i];
			if (last < n)
				sum += y[last] * (b - (double)last);
		}
		cell[k] = sum / width;
	}
}

int cnn_lay(const struct cnn_section *s, network_real *x, struct cnn_frame *frame)
{
	double y1[CNN_POINTS], y2[CNN_POINTS], width = s->duration / CNN_PER_PULSE, begin,
					       slope;

	if (!(width >= 0.5) || (double)s->n > width * CNN_POINTS || !(s->gain > 0) ||
		!(s->reach >= 0) || s->reach > CNN_REACH_MAX * s->duration)
		return 0;
	*frame = (struct cnn_frame){ find_centre(s), s->duration, 0, s->middle,
		fmax(s->reach, CNN_REACH_MIN * s->duration) };
	if (frame->centre < 0)
		return 0;
	begin = frame->centre - width * CNN_POINTS / 2;
	average(s->y1, s->n, begin, width, y1);
	average(s->y2, s->n, begin + s->middle, width, y2);
	for (int k = 0; k < CNN_POINTS; k++)
		frame->scale = fmax(frame->scale, fabs(y1[k]));
	if (!(frame->scale > 0))
		return 0;
	slope = 2 * M_PI * frame->reach / s->duration;
	for (int k = 0; k < CNN_POINTS; k++) {
		x[k] = (network_real)(y1[k] / frame->scale);
		x[CNN_POINTS + k] =
			(network_real)((y2[k] / s->gain - y1[k]) / frame->scale / slope);
	}
	return 1;
}

int cnn_pulses(const network_real *output, const struct cnn_frame *frame, int sources,
	struct cnn_pulse *pulse)
{
	const network_real *o;

	if (sources < 1) {
		sources = 1;
		for (int k = 2; k <= CNN_SOURCES; k++)
			if (output[k - 1] > output[sources - 1])
				sources = k;
	}
	o = output + cnn_head(sources);
	for (int k = 0; k < sources; k++, o += 3) {
		pulse[k].t = frame->centre + o[0] * frame->duration;
		pulse[k].delta = frame->middle + fmin(fmax(o[1], -1), 1) * frame->reach;
		pulse[k].a = frame->scale * pow(fmax(o[2], 0), 3);
	}
	return sources;
}

int cnn_apply(struct network *net, const struct cnn_section *section, int sources,
	struct cnn_pulse *pulse)
{
	network_real x[2 * CNN_POINTS];
	struct cnn_frame frame;

	if (sources > CNN_SOURCES || !cnn_lay(section, x, &frame))
		return 0;
	return cnn_pulses(network_forward(net, x, 1), &frame, sources, pulse);
}
