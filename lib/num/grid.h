/* grid.h - index of a grid point in memory: ny rows of nx points */
#ifndef NUM_GRID_H
#define NUM_GRID_H

#include <stddef.h>

/* Points of nx by ny. */
static inline size_t grid_size(int nx, int ny)
{
	return (size_t)nx * (size_t)ny;
}

/* Place of (ix, iy) in rows of nx; all of them >= 0. */
static inline size_t grid_at(int nx, int ix, int iy)
{
	return (size_t)iy * (size_t)nx + (size_t)ix;
}

#endif
