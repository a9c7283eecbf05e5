#include "pump_options.h"
#include "cli/msg.h"
#include <math.h>
#include <string.h>

static const char *const size_sets[] = { "all", "step", NULL };

struct pump pump = { .pair = { .area = 2346.3e-6,
			     .gap_new = NAN,
			     .threshold_gap = NAN,
			     .threshold_leakage = NAN,
			     .threshold_volume = NAN },
	.fragment_area = NAN,
	.transition = 0.1,
	.critical_size = NAN,
	.critical_probability = 0.05,
	.radii = { .n = 4 },
	.ports = { 2, { 0.15e6, 21e6 } } };

struct opt pump_threshold_rows[] = {
	OPT_HEADING("Failure"),
	{ 0, "threshold-gap", OPT_NUM, UNIT_LENGTH, &pump.pair.threshold_gap, 1e-12, 1,
		"H", "gap at failure", 0, 0 },
	{ 0, "threshold-leakage", OPT_NUM, UNIT_FLOW, &pump.pair.threshold_leakage, 1e-15,
		1e3, "Q",
		"leakage of the pump at failure [2.8 L/min if no threshold is given]", 0,
		0 },
	{ 0, "threshold-volume", OPT_NUM, UNIT_VOLUME, &pump.pair.threshold_volume, 1e-30,
		1e3, "V", "worn volume at failure", 0, 0 },
	{ 0, "critical-size", OPT_NUM, UNIT_LENGTH, &pump.critical_size, 1e-12, 1, "D",
		"diameter of large particles, for failure by their share", 0, 0 },
	{ 0, "critical-probability", OPT_NUM, UNIT_FRACTION, &pump.critical_probability,
		1e-12, 1, "P", "share of large particles, by number, at failure", 0, 0 },
	{ 0, "sizes", OPT_WORD, UNIT_NONE, &pump.per_step, 0, 0, "all|step",
		"share among all particles so far, or among those of a step", size_sets,
		0 },
	OPT_END,
};

struct opt pump_face_rows[] = {
	OPT_HEADING("Sliding pair"),
	{ 0, "area", OPT_NUM, UNIT_AREA, &pump.pair.area, 1e-18, 1e6, "A",
		"nominal contact area", 0, 0 },
	{ 0, "fragment-area", OPT_NUM, UNIT_AREA, &pump.fragment_area, 1e-24, 1e6, "A",
		"area of a fragment [that of the table of --wear, else 1e-8 m2]", 0, 0 },
	{ 0, "transition", OPT_NUM, UNIT_FRACTION, &pump.transition, 0, 1, "SHARE",
		"share of the area in the zone of linear pressure", 0, 0 },
	{ 0, "initial-gap", OPT_NUM, UNIT_LENGTH, &pump.pair.gap_new, 0, 1, "H",
		"gap when new [first one observed, else that of 1.5 L/min]", 0, 0 },
	{ 0, "alpha0", OPT_NUM, UNIT_ANGLE, &pump.pair.leakage.alpha0, 1e-9,
		6.283185307179587, "A", "angle of the ports in (4-30)", 0, 0 },
	{ 0, "leak-ratio", OPT_NUM, UNIT_FRACTION, &pump.pair.leakage.ratio, 1e-9, 1, "R",
		"share of this pair in the leakage of the pump", 0, 0 },
	{ 0, "radii", OPT_LIST, UNIT_LENGTH, &pump.radii, 1e-9, 1e3, "R1,R2,R3,R4",
		"radii of the sealing lands", 0, 0 },
	{ 0, "ports", OPT_LIST, UNIT_PRESSURE, &pump.ports, 0, 1e12, "PIN:POUT",
		"inlet and outlet pressure", 0, 0 },
	{ 0, "viscosity", OPT_NUM, UNIT_VISCOSITY, &pump.pair.leakage.viscosity, 1e-12,
		1e6, "MU", "dynamic viscosity", 0, 0 },
	OPT_END,
};

void pump_init(void)
{
	pump.pair.leakage = leakage_thesis();
	memcpy(pump.radii.v, pump.pair.leakage.radius, sizeof pump.pair.leakage.radius);
}

void pump_check(void)
{
	struct pair *p = &pump.pair;
	const char *wrong;

	memcpy(p->leakage.radius, pump.radii.v, sizeof p->leakage.radius);
	p->leakage.drop = pump.ports.v[1] - pump.ports.v[0];
	wrong = leakage_check(&p->leakage);
	if (wrong)
		die(EXIT_USAGE, "%s", wrong);
	if (p->threshold_leakage > 0.1)
		warn("--threshold-leakage %g m3/s: is %gL/min meant?",
			p->threshold_leakage, p->threshold_leakage);
	if (p->threshold_gap >= 1e-2)
		warn("--threshold-gap %g m: is %gum meant?", p->threshold_gap,
			p->threshold_gap);
	if (p->threshold_volume > 1e-2)
		warn("--threshold-volume %g m3: is %gmm3 meant?", p->threshold_volume,
			p->threshold_volume);
	if (p->area > 10)
		warn("--area %g m2: is %gmm2 meant?", p->area, p->area);
	if (isnan(p->threshold_gap) && isnan(p->threshold_leakage) &&
		isnan(p->threshold_volume) && isnan(pump.critical_size))
		p->threshold_leakage = 2.8e-3 / 60;
}

/* Appends a phrase where none of some options was given. */
static void assume(char **list, const char *phrase, const char *const *options)
{
	for (; *options; options++)
		if (opt_given(*options))
			return;
	*list = xappend(*list, "%s%s", *list ? ", " : "", phrase);
}

char *pump_assumed(int fragments, int leaks)
{
	static const char *const area[] = { "area", NULL };
	static const char *const threshold[] = { "threshold-gap", "threshold-leakage",
		"threshold-volume", "critical-size", NULL };
	static const char *const lands[] = { "radii", "ports", "viscosity", "alpha0",
		"leak-ratio", NULL };
	char *list = NULL;

	if (fragments && isnan(pump.fragment_area)) {
		pump.fragment_area = 1e-8;
		list = xstrdup("fragments of 1e-8 m2 (--fragment-area)");
	}
	if (fragments)
		assume(&list, "a contact area of 2346.3 mm2 (--area)", area);
	assume(&list, "failure at a leakage of 2.8 L/min (--threshold-leakage)",
		threshold);
	if (leaks || !isnan(pump.pair.threshold_leakage))
		assume(&list,
			"sealing lands, ports and oil of the thesis' pump (--radii, "
			"--ports, --viscosity)",
			lands);
	return list;
}
