/* lesson.c - what a network is trained with: samples of one kind, with their loss */
#include "net/lesson.h"
#include "num/status.h"
#include <stdlib.h>
#include <string.h>

struct lesson lesson_of_sines(
	const struct delaydata_par *par, network_loss *loss, uint32_t first)
{
	return (struct lesson){ .purpose = "delays",
		.input = { 1, 2, par->points },
		.inputs = 2 * par->points,
		.outputs = par->sources,
		.targets = par->sources,
		.loss = loss,
		.first = first,
		.sines = *par };
}

struct lesson lesson_of_pulses(const struct cnndata_par *par, uint32_t first)
{
	return (struct lesson){ .purpose = "arrivals",
		.input = { 2, 1, CNN_POINTS },
		.inputs = 2 * CNN_POINTS,
		.outputs = CNN_OUTPUTS,
		.targets = CNNDATA_TARGETS,
		.loss = cnndata_loss,
		.first = first,
		.of_pulses = 1,
		.pulses = *par };
}

static void make_sample(
	const struct lesson *l, long i, network_real *x, network_real *target)
{
	struct cnndata_section s;

	if (!l->of_pulses) {
		delaydata_sample(&l->sines, l->first + (uint32_t)i, x, target);
		return;
	}
	cnndata_section(&l->pulses, l->first + (uint32_t)i, &s);
	cnndata_target(&s, x, target);
}

enum num_status lesson_keep(struct lesson *l, long count)
{
	l->x = calloc((size_t)count * (size_t)l->inputs, sizeof *l->x);
	l->target = calloc((size_t)count * (size_t)l->targets, sizeof *l->target);
	if (!l->x || !l->target) {
		lesson_drop(l);
		return NUM_MEMORY;
	}
	for (long i = 0; i < count; i++)
		make_sample(l, i, l->x + i * l->inputs, l->target + i * l->targets);
	return NUM_OK;
}

void lesson_drop(struct lesson *l)
{
	free(l->x);
	free(l->target);
	l->x = l->target = NULL;
}

void lesson_sample(void *context, long i, network_real *x, network_real *target)
{
	const struct lesson *l = context;

	if (!l->x) {
		make_sample(l, i, x, target);
		return;
	}
	memcpy(x, l->x + i * l->inputs, (size_t)l->inputs * sizeof *x);
	memcpy(target, l->target + i * l->targets, (size_t)l->targets * sizeof *target);
}

int lesson_suits(const struct lesson *l, const struct network *net)
{
	struct network_shape in = network_input(net);

	if (l->of_pulses)
		return cnn_suits(net);
	return in.channels == 1 && in.height == 2 && network_outputs(net) <= DELAYS_MAX;
}
