#include "time_unit.h"
#include <stddef.h>

static const char *const words[] = { "s", "min", "h", "d", NULL };
static const double seconds[] = { 1, 60, 3600, 86400 };

static int unit;

struct opt timeunit_rows[] = {
	{ 0, "time-unit", OPT_WORD, UNIT_NONE, &unit, 0, 0, "s|min|h|d",
		"unit of the times read", words, 0 },
	OPT_END,
};

double timeunit(void)
{
	return seconds[unit];
}
