/* scratches.h - the grooves of particles, cut into a stream of surfaces */
#ifndef SCRATCHES_H
#define SCRATCHES_H

#include <stddef.h>
#include <stdint.h>

/* One groove, to be cut into the surface of its realisation from this step on, over this
 * share of the length. */
void scratches_add(
	long realisation, long step, double diameter, double depth, double share);
/* Reads heights, cuts grooves into them at random positions and writes the fields, with
 * this cmd, to standard output: into each record those of its realisation (of all if
 * apart is 0) and, if stepped, of its step and earlier ones.  Returns the number of
 * grooves that no surface has; again: of records whose realisation, and if stepped step,
 * is that of an earlier one.  why: the grooves are doubtful, and the records become so,
 * NULL: they are not; own: the same of the records themselves, fresh memory. */
size_t scratches_cut(const char *path, double length, double cut, uint64_t seed,
	int apart, int stepped, const char *cmd, const char *why, size_t *again,
	char **own);

/* Why the records that are counted by again are doubtful. */
extern const char scratched_again[];

#endif
