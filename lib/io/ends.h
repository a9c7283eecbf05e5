/* ends.h - end marks of streams: output made from an input without one gets none
 *
 * A reader that detects a truncated input only at its end calls ends_miss() after it has
 * returned the complete part.  The writers call ends_check() before the end mark, so that
 * the result of a truncated input does not look complete.
 */
#ifndef IO_ENDS_H
#define IO_ENDS_H

/* Value of the key "stream" of streams that promise an end. */
#define ENDS_PROMISE "wearpipe-streams(5)"

/* The message is kept for ends_check(), which dies with the first one. */
void ends_miss(const char *format, ...) __attribute__((format(printf, 1, 2)));
void ends_check(void);

#endif
