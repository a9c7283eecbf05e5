/* simulated.h - what a table of particles says was simulated, by its comment lines
 *
 * debrisgen writes "# realisation:" and "# last_step:" for each realisation: without them
 * a realisation, or last steps, in which nothing was worn off would be unknown.
 */
#ifndef COMMON_SIMULATED_H
#define COMMON_SIMULATED_H

struct simulated {
	long count;           /* realisations, each one counted in ascending order */
	long lowest, highest; /* of them, if count > 0 */
	long last_step;       /* 0: unknown */
};

/* A comment for table_with_comments(); to: struct simulated, at first { 0 }. */
void simulated_comment(void *to, const char *key, const char *value);

#endif
