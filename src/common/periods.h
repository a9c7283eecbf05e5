/* periods.h - where periods end, and how many a gap between two particles may have
 *
 * A gap costs a row for every period in it.  Ten million rows are about a gigabyte of
 * output, more than any reader of such a table needs: the period or the unit of time is
 * wrong.
 */
#ifndef COMMON_PERIODS_H
#define COMMON_PERIODS_H

enum { PERIODS_MOST = 10000000 };

/* End of the first k periods, to 15 digits, since times are decimal numbers: three times
 * 0.1 is 4e-17 more than 0.3, and a particle at 0.3 s is in the fourth period. */
double period_end(double k, double period);

#endif
