/* progress.h - a line on the terminal that shows how much of its work a program has done
 *
 * "debrisgen: 45 %, 12 s left", for work of over a second and only where standard error
 * is a terminal.  Programs of one pipeline have a line each, in their order; the line is
 * erased at the end.  The share is that of the bytes read, if their number is known, or
 * that given by the program.
 */
#ifndef CLI_PROGRESS_H
#define CLI_PROGRESS_H

/* Starts the clock, which the first call of another function starts otherwise. */
void progress_begin(void);
/* done of total of what, such as "epochs"; total <= 0: unknown, shows the share of the
 * input, or done; what NULL: shows the share of the input again.  Cheap to call often. */
void progress(const char *what, double done, double total);
/* Bytes of the input that were used. */
void progress_read(double bytes, double total);
/* Share, 0 to 1, of the work on the input read since the last call with 1; last: no more
 * input will be read. */
void progress_within(double share, int last);
/* Erases the line; messages call it themselves. */
void progress_clear(void);

#endif
