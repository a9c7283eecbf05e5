#include "common/periods.h"
#include <stdio.h>
#include <stdlib.h>

double period_end(double k, double period)
{
	char text[32];

	snprintf(text, sizeof text, "%.15g", k * period);
	return strtod(text, NULL);
}
