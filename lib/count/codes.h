/* codes.h - cleanliness codes of hydraulic oil
 *
 * ISO 4406: for particles of at least 4, 6 and 14 um(c) a scale number each, from a table
 * of upper limits per millilitre that is not quite a power of two.
 * SAE AS4059, cumulative: for particles larger than 4, 6, 14, 21, 38 and 70 um(c), called
 * A to F, a class each, from limits per 100 ml.
 */
#ifndef COUNT_CODES_H
#define COUNT_CODES_H

enum { ISO4406_SIZES = 3, ISO4406_CODES = 29, AS4059_SIZES = 6, AS4059_CLASSES = 15 };

extern const double iso4406_size[ISO4406_SIZES]; /* m */
extern const double as4059_size[AS4059_SIZES];   /* m */

/* Upper limit of a scale number 0 to 28, per m3. */
double iso4406_limit(int code);
/* The scale number of so many particles per m3: the first whose limit is not below, or
 * ISO4406_CODES beyond the last. */
int iso4406_code(double number);

/* Upper limit of class k, 0 to 14 for 000, 00, 0, 1, ..., 12, per m3. */
double as4059_limit(int size, int k);
/* The class of so many particles per m3, or AS4059_CLASSES beyond the last. */
int as4059_class(int size, double number);
/* "000", "7"; ">12" beyond the last. */
const char *as4059_name(int k);

#endif
