/* periods.h - how long a gap between two particles a table of periods may have
 *
 * A gap costs a row for every period in it.  Ten million rows are about a gigabyte of
 * output, more than any reader of such a table needs: the period or the unit of time is
 * wrong.
 */
#ifndef COMMON_PERIODS_H
#define COMMON_PERIODS_H

enum { PERIODS_MOST = 10000000 };

#endif
