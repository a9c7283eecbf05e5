/* scratches.h - the grooves of particles, cut into a stream of surfaces */
#ifndef SCRATCHES_H
#define SCRATCHES_H

#include <stddef.h>
#include <stdint.h>

/* One groove, to be cut into the surface of its realisation. */
void scratches_add(long realisation, double diameter, double depth, double section);
/* Reads heights, cuts the grooves of their realisation (of all realisations if apart is
 * 0) at random positions and writes the fields, with this cmd, to standard output.
 * Returns the number of grooves whose realisation has no surface; again: of records of
 * the realisation of an earlier one. */
size_t scratches_cut(const char *path, double length, double cut, uint64_t seed,
	int apart, const char *cmd, size_t *again);

#endif
