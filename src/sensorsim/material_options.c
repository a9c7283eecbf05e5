#include "material_options.h"
#include "cli/msg.h"
#include "common/materials.h"
#include "num/philox.h"
#include <math.h>

static const char *mixture;
static double mur = NAN, sigma = NAN, excitation = 100e3;

static struct material_mix mix;
static struct material own = { "own", 1, 0 };

struct opt material_rows[] = {
	OPT_HEADING("Materials"),
	{ 0, "material", OPT_TEXT, UNIT_NONE, &mixture, 0, 0, "NAME[=SHARE],...",
		"materials of the particles (default ferrous)", 0, 0 },
	{ 0, "mur", OPT_NUM, UNIT_NONE, &mur, 1, 1e6, "MUR",
		"relative permeability, in place of --material", 0, 0 },
	{ 0, "sigma", OPT_NUM, UNIT_NONE, &sigma, 0, 1e9, "S",
		"conductivity, S/m, in place of --material", 0, 0 },
	{ 0, "excitation", OPT_NUM, UNIT_FREQUENCY, &excitation, 0, 1e12, "F",
		"frequency of the exciting field", 0, 0 },
	OPT_END,
};

void material_check(void)
{
	if (mixture && !(isnan(mur) && isnan(sigma)))
		die(EXIT_USAGE, "--material and --mur or --sigma exclude one another");
	if (isnan(mur) && isnan(sigma)) {
		mix = materials_read(mixture ? mixture : "ferrous");
		return;
	}
	own.mu = isnan(mur) ? 1 : mur;
	own.sigma = isnan(sigma) ? 0 : sigma;
	mix = (struct material_mix){ 1, { &own }, { 1 } };
}

const struct material *material_draw(
	uint64_t seed, uint32_t realisation, uint64_t particle)
{
	double u = philox_uniform(seed, realisation, RNG_MATERIAL, particle), upto = 0;
	int i = 0;

	for (int k = 0; k < mix.n; k++)
		upto += mix.share[k];
	u *= upto;
	for (upto = mix.share[0]; i < mix.n - 1 && u >= upto;)
		upto += mix.share[++i];
	return mix.part[i];
}

void material_respond(const struct material *material, struct passage *p)
{
	struct polarisability beta = material_response(material, p->diameter, excitation);

	p->response[0] = beta.re;
	p->response[1] = beta.im;
}
