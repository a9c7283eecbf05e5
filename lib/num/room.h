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

#include <stddef.h>

/* Enlarges the array at *array to at least want elements, keeping its contents. -1 when
 * out of memory: then nothing is changed. */
int room_for(void *array, size_t *room, size_t want, size_t size);

#endif
