#include "components.h"
#include "cli/msg.h"
#include "common/materials.h"
#include "signal/pulse/material.h"
#include <math.h>

static double phase, phase_error = M_PI / 90, excitation = 100e3, class_error = 0.01;
static const char *materials;
static struct material_mix mix;

struct opt component_rows[] = {
	OPT_HEADING("Four channels: in phase and in quadrature"),
	{ 0, "phase", OPT_NUM, UNIT_ANGLE, &phase, -10, 10, "A",
		"phase of ferrous particles after demodulation", 0, 0 },
	{ 0, "phase-error", OPT_NUM, UNIT_ANGLE, &phase_error, 0, 10, "A",
		"rms error of this phase", 0, 0 },
	{ 0, "excitation", OPT_NUM, UNIT_FREQUENCY, &excitation, 1e-3, 1e12, "F",
		"frequency of the exciting field", 0, 0 },
	{ 0, "material", OPT_TEXT, UNIT_NONE, &materials, 0, 0, "NAME[=SHARE],...",
		"materials there may be, with their shares (default all)", 0, 0 },
	{ 0, "class-error", OPT_NUM, UNIT_FRACTION, &class_error, 0, 0.5, "P",
		"probability of error above which the class is unclear", 0, 0 },
	OPT_END,
};

/* As much of ferrous ones as of others. */
static struct material_mix all_materials(void)
{
	struct material_mix all = { 0 };
	double count[2] = { 0 };

	for (int i = 0; material_at(i); i++)
		count[classify_is_ferrous(material_at(i))]++;
	for (int i = 0; material_at(i); i++) {
		all.part[all.n] = material_at(i);
		all.share[all.n++] = 1 / count[classify_is_ferrous(material_at(i))];
	}
	return all;
}

void components_check(int channels)
{
	static const char *const given[] = { "phase", "phase-error", "excitation",
		"material", "class-error" };

	if (channels == 4) {
		mix = materials ? materials_read(materials) : all_materials();
		return;
	}
	for (size_t i = 0; i < sizeof given / sizeof *given; i++)
		if (opt_given(given[i]))
			die(EXIT_USAGE,
				"--%s is for four channels (I1 Q1 I2 Q2), the record has %d",
				given[i], channels);
}

double components_angle(void)
{
	return phase - M_PI / 4;
}

double components_share(void)
{
	return cos(M_PI / 4);
}

struct component_class components_classify(double size, double of_both, double phase_se)
{
	struct component_class class = {
		.phase = remainder(of_both + components_angle() - phase, 2 * M_PI),
		.name = "unclear"
	};

	class.ferrous = classify_ferrous(mix.part, mix.share, mix.n, size, class.phase,
		hypot(phase_se, phase_error), excitation);
	if (class.ferrous >= 1 - class_error)
		class.name = "ferrous";
	else if (class.ferrous <= class_error)
		class.name = "non-ferrous";
	return class;
}
