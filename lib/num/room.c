#include "num/room.h"
#include "num/status.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum num_status room_for(void *array, size_t *room, size_t want, size_t size)
{
	size_t more = *room ? *room : 64;
	void *old, *p;

	if (want <= *room)
		return NUM_OK;
	if (want > SIZE_MAX / 2 / size)
		return NUM_MEMORY;
	while (more < want)
		more *= 2;
	/* Copied, since a pointer to any pointer is no void **. */
	memcpy(&old, array, sizeof old);
	p = realloc(old, more * size);
	if (!p)
		return NUM_MEMORY;
	memcpy(array, &p, sizeof p);
	*room = more;
	return NUM_OK;
}
