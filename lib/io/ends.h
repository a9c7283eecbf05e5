/* ends.h - the ends of streams: what was read without one gets none when written
 *
 * A reader that can only tell afterwards that its input was cut off calls ends_miss()
 * and hands out what was whole.  The writers call ends_check() before they end a
 * stream, so that a program dies before what it made of half an input looks whole.
 */
#ifndef IO_ENDS_H
#define IO_ENDS_H

/* Value of the key "stream" of streams that promise an end. */
#define ENDS_PROMISE "wearpipe-streams(5)"

/* The message is kept for ends_check(), which dies with the first one. */
void ends_miss(const char *format, ...) __attribute__((format(printf, 1, 2)));
void ends_check(void);

#endif
