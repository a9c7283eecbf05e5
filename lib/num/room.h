/* room.h - arrays that grow
 *
 *	struct point *point = NULL;
 *	size_t room = 0, count = 0;
 *	if (room_for(&point, &room, count + 1, sizeof *point))
 *		return -1;
 *	point[count++] = p;
 */
#ifndef NUM_ROOM_H
#define NUM_ROOM_H

#include "num/status.h"
#include <stddef.h>

/* Sees to it that the array whose pointer stands at *array has room for want elements;
 * what is in it stays.  Where there is no memory all is as before. */
enum num_status room_for(void *array, size_t *room, size_t want, size_t size);

#endif
