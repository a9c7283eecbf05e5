#include "roughness_options.h"
#include "cli/msg.h"

static struct opt_list sq = { 1, { 1e-6 } }, sa;

struct opt roughness_rows[] = {
	{ 'q', "sq", OPT_LIST, UNIT_LENGTH, &sq, 0, 1e9, "Q[:Q2]",
		"root mean square height Sq; two: drawn between them", 0, 0 },
	{ 0, "sa", OPT_LIST, UNIT_LENGTH, &sa, 0, 1e9, "Q[:Q2]",
		"mean absolute height Sa, in place of --sq", 0, 0 },
	OPT_END,
};

void roughness_check_range(const char *word, const struct opt_list *range)
{
	const double least = 1e-30; /* smaller ones would underflow when squared */

	if (range->n == 2 && range->v[0] > range->v[1])
		die(EXIT_USAGE, "--%s %g:%g: the range is descending", word, range->v[0],
			range->v[1]);
	for (int i = 0; i < range->n; i++)
		if (range->v[i] > 0 && range->v[i] < least)
			die(EXIT_USAGE, "--%s %g: want 0, or %g or more", word,
				range->v[i], least);
}

void roughness_check(void)
{
	roughness_check_range("sq", &sq);
	roughness_check_range("sa", &sa);
}

struct rough_range roughness_range(const struct opt_list *range)
{
	return range->n ? (struct rough_range){ range->v[0], range->v[range->n - 1] }
			: (struct rough_range){ 0, 0 };
}

enum rough_kind roughness_kind(void)
{
	return sa.n ? ROUGH_SA : ROUGH_SQ;
}

struct rough_range roughness_target(void)
{
	return roughness_range(sa.n ? &sa : &sq);
}
