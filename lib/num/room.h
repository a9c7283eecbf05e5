/* room.h - arrays that grow
 *
 *	struct point *point = NULL;
 *	size_t room = 0, count = 0;
 *	if (room_for(&point, &room, count + 1, sizeof *point))
 *		return NUM_MEMORY;
 *	point[count++] = p;
 */
#ifndef NUM_ROOM_H
#define NUM_ROOM_H

#include "num/status.h"
#include <stddef.h>

/* Grows the array whose pointer is *array to at least want elements, keeping those in it.
 * On NUM_MEMORY nothing has changed. */
enum num_status room_for(void *array, size_t *room, size_t want, size_t size);

#endif
