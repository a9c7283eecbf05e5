#include "contact/flow.h"

struct contact_flow contact_unloaded(size_t n, const double *height,
	const double *pressure, const double *gap, double hardness, double *unloaded)
{
	struct contact_flow flow = { 0, 0 };

	for (size_t i = 0; i < n; i++) {
		/* Elsewhere an overlap is what the tolerance leaves. */
		double depth = pressure[i] >= hardness && gap[i] < 0 ? -gap[i] : 0;

		unloaded[i] = height[i] - depth;
		flow.sum += depth;
		if (depth > flow.depth)
			flow.depth = depth;
	}
	return flow;
}
