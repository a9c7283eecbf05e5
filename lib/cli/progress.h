/* progress.h - a line on the terminal that tells how far a program has come
 *
 * "debrisgen: 45 %, 12 s left", for work of over a second and only where standard error
 * is a terminal.  Programs of one pipeline have a line each, in their order; the line is
 * erased at the end.
 */
#ifndef CLI_PROGRESS_H
#define CLI_PROGRESS_H

/* done of total of what, such as "steps"; total <= 0: unknown, tells done alone.  Cheap
 * to call often. */
void progress(const char *what, double done, double total);
/* Bytes that were read of the input, which tell of programs that call nothing else. */
void progress_read(double bytes, double total);
/* Erases the line; messages call it themselves. */
void progress_clear(void);

#endif
