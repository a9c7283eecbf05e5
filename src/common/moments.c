#include "common/moments.h"
#include "cli/msg.h"
#include "num/room.h"
#include <string.h>

static int is_before(const struct moment *a, const struct moment *b)
{
	return a->realisation != b->realisation ? a->realisation < b->realisation
						: a->step < b->step;
}

int moments_again(struct moments *m, struct moment next)
{
	size_t low = 0, high = m->n;

	/* Most ensembles ascend. */
	if (m->n > 0 && is_before(&m->of[m->n - 1], &next))
		low = m->n;
	while (low < high) {
		size_t mid = low + (high - low) / 2;

		if (is_before(&m->of[mid], &next))
			low = mid + 1;
		else
			high = mid;
	}
	if (low < m->n && !is_before(&next, &m->of[low]))
		return 1;
	if (room_for(&m->of, &m->room, m->n + 1, sizeof *m->of))
		die(EXIT_RUN, "out of memory");
	memmove(m->of + low + 1, m->of + low, (m->n - low) * sizeof *m->of);
	m->of[low] = next;
	m->n++;
	return 0;
}
