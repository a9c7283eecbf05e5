#include "raw_layout.h"
#include "cli/msg.h"

static struct opt_list size, pixel;

struct opt raw_rows[] = {
	{ 0, "raw", OPT_LIST, UNIT_COUNT, &size, 1, 1e9, "NXxNY",
		"read headerless little-endian float64 heights", 0, 0 },
	{ 0, "pixel", OPT_LIST, UNIT_LENGTH, &pixel, 1e-15, 1e12, "D[xD]",
		"spacing of --raw along x and y", 0, 0 },
	OPT_END,
};

const struct raw_layout *raw_given(void)
{
	static struct raw_layout raw;

	if (!size.n && !pixel.n)
		return NULL;
	if (!size.n || !pixel.n)
		die(EXIT_USAGE, "--raw and --pixel go together");
	raw = (struct raw_layout){ (int)size.v[0], (int)size.v[1], pixel.v[0],
		pixel.v[pixel.n - 1] };
	return &raw;
}
