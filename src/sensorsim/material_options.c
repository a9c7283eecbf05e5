#include "material_options.h"
#include "cli/msg.h"
#include "num/philox.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MIXED = 16 };

static const char *mixture;
static double mur = NAN, sigma = NAN, excitation = 100e3;

/* The materials of the mixture and the shares of all up to each. */
static const struct material *part[MIXED];
static double upto[MIXED];
static int parts;
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

char *material_names(void)
{
	char *names = xstrdup("");

	for (int i = 0; material_at(i); i++) {
		char *longer =
			xprintf("%s%s%s", names, i ? ", " : "", material_at(i)->name);

		free(names);
		names = longer;
	}
	return names;
}

/* NAME or NAME=SHARE of length bytes. */
static void add_part(const char *text, size_t length)
{
	char *word = xstrdup(text), *equals, *end;
	double share = 1;

	word[length] = '\0';
	equals = strchr(word, '=');
	if (equals) {
		*equals = '\0';
		share = strtod(equals + 1, &end);
		if (end == equals + 1 || *end || !(share >= 0 && share <= 1e9))
			die(EXIT_USAGE, "--material %s: '%s' is not a share", mixture,
				equals + 1);
	}
	if (parts == MIXED)
		die(EXIT_USAGE, "--material: at most %d", MIXED);
	part[parts] = material_find(word);
	if (!part[parts])
		die(EXIT_USAGE, "--material: no '%s'; there are %s", word,
			material_names());
	upto[parts] = share + (parts ? upto[parts - 1] : 0);
	parts++;
	free(word);
}

void material_check(void)
{
	if (mixture && !(isnan(mur) && isnan(sigma)))
		die(EXIT_USAGE, "--material and --mur or --sigma exclude one another");
	if (isnan(mur) && isnan(sigma)) {
		for (const char *s = mixture ? mixture : "ferrous"; s;) {
			size_t length = strcspn(s, ",");

			add_part(s, length);
			s = s[length] ? s + length + 1 : NULL;
		}
	} else {
		own.mu = isnan(mur) ? 1 : mur;
		own.sigma = isnan(sigma) ? 0 : sigma;
		part[0] = &own;
		upto[0] = 1;
		parts = 1;
	}
	if (!(upto[parts - 1] > 0))
		die(EXIT_USAGE, "--material %s: all shares are 0", mixture);
}

const struct material *material_draw(
	uint64_t seed, uint32_t realisation, uint64_t particle)
{
	double u = upto[parts - 1] *
		   philox_uniform(seed, realisation, RNG_MATERIAL, particle);
	int i = 0;

	while (i < parts - 1 && u >= upto[i])
		i++;
	return part[i];
}

void material_respond(const struct material *material, struct passage *p)
{
	struct polarisability beta = material_response(material, p->diameter, excitation);

	p->response[0] = beta.re;
	p->response[1] = beta.im;
}
