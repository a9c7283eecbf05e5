#include "common/non_ferrous.h"
#include "common/materials.h"
#include "signal/pulse/material.h"

static const char *name;
static double excitation = 100e3;

struct opt non_ferrous_rows[] = {
	{ 0, "non-ferrous", OPT_TEXT, UNIT_NONE, &name, 0, 0, "NAME",
		"material of the particles of class non-ferrous", NULL, 0 },
	{ 0, "excitation", OPT_NUM, UNIT_FREQUENCY, &excitation, 0, 1e12, "F",
		"of --non-ferrous: frequency of the exciting field", NULL, 0 },
	OPT_END,
};

static const struct material *material(void)
{
	return material_named("--non-ferrous", name);
}

int non_ferrous_known(void)
{
	opt_require("non-ferrous", "excitation");
	return name && material();
}

int non_ferrous_none(void)
{
	return name && classify_is_ferrous(material());
}

double non_ferrous_size(double equivalent)
{
	return classify_diameter(material(), equivalent, excitation);
}

double non_ferrous_equivalent(double size)
{
	return classify_equivalent(material(), size, excitation);
}
