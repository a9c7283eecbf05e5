#include "count/codes.h"
#include <math.h>

const double iso4406_size[ISO4406_SIZES] = { 4e-6, 6e-6, 14e-6 };
const double as4059_size[AS4059_SIZES] = { 4e-6, 6e-6, 14e-6, 21e-6, 38e-6, 70e-6 };

/* As printed by the makers of counters (HYDAC, FCU 8111 manual; Schroeder Industries,
 * Contamination Classification): after ISO 4406:1999 there is no number beyond 28, though
 * charts of the first edition go on to 30. */
static const double iso_per_ml[ISO4406_CODES] = { 0.01, 0.02, 0.04, 0.08, 0.16, 0.32,
	0.64, 1.3, 2.5, 5, 10, 20, 40, 80, 160, 320, 640, 1300, 2500, 5000, 1e4, 2e4, 4e4,
	8e4, 1.6e5, 3.2e5, 6.4e5, 1.3e6, 2.5e6 };

/* Classes 000 to 4 as printed; 5 to 12 double up to the limit of class 12.  Limits are
 * sums of the size ranges of NAS 1638, in which halves of a particle are cut off.  All
 * are those of Machinery Lubrication India, November 2019, page 28 (revision E, table 2),
 * and, to three digits, of HYDAC's CS 1000 manual (3247149n, page 90). */
static const double as_low[AS4059_SIZES][7] = {
	{ 195, 390, 780, 1560, 3120, 6250, 12500 },
	{ 76, 152, 304, 609, 1217, 2432, 4864 }, { 14, 27, 54, 109, 217, 432, 864 },
	{ 3, 5, 10, 20, 39, 76, 152 }, { 1, 1, 2, 4, 7, 13, 26 }, { 0, 0, 0, 1, 1, 2, 4 }
};
static const double as_top[AS4059_SIZES] = { 3200000, 1245584, 221584, 39184, 6784,
	1024 };

/* A count divided by a volume may differ from a limit by rounding. */
static const double rounding = 1e-12;

double iso4406_limit(int code)
{
	return iso_per_ml[code] * 1e6;
}

int iso4406_code(double number)
{
	int code = 0;

	while (code < ISO4406_CODES && number > iso4406_limit(code) * (1 + rounding))
		code++;
	return code;
}

double as4059_limit(int size, int k)
{
	double per_100ml = k < 7 ? as_low[size][k] : floor(ldexp(as_top[size], k - 14));

	return per_100ml * 1e4;
}

int as4059_class(int size, double number)
{
	int k = 0;

	while (k < AS4059_CLASSES && number > as4059_limit(size, k) * (1 + rounding))
		k++;
	return k;
}

const char *as4059_name(int k)
{
	static const char *const names[] = { "000", "00", "0", "1", "2", "3", "4", "5",
		"6", "7", "8", "9", "10", "11", "12", ">12" };

	return names[k];
}
