/* stats.h - counters of the work done and the work left out
 *
 * --stats FILE receives one TSV row: program, wall and CPU seconds, peak memory,
 * then the counters in the order they were first named.  -v prints them too.
 * Names are lower_case nouns: iterations, transforms, layers, layers_skipped.
 */
#ifndef CLI_STATS_H
#define CLI_STATS_H

void stats_add(const char *name, double amount); /* counts; the first call starts at 0 */
void stats_set(const char *name, double value);  /* keeps the last value */
void stats_max(const char *name, double value);  /* keeps the largest value */

/* For opt_parse() and shell_done() only. */
void stats_start(void);
void stats_open(const char *path); /* before the work, to detect errors early */
void stats_write(const char *program);

#endif
