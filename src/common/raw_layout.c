#include "raw_layout.h"
#include "cli/msg.h"

static struct opt_list size, pixel;

#define RAW(arg)                                                      \
	{                                                             \
		0, "raw", OPT_LIST, UNIT_COUNT, &size, 1, 1e9, arg,   \
			"read headerless little-endian float64", 0, 0 \
	}

struct opt raw_rows[] = {
	RAW("NXxNY"),
	{ 0, "pixel", OPT_LIST, UNIT_LENGTH, &pixel, 1e-15, 1e12, "D[xD]",
		"spacing of --raw along x and y", 0, 0 },
	OPT_END,
};

struct opt raw_layer_rows[] = {
	RAW("NXxNY[xNZ]"),
	{ 0, "pixel", OPT_LIST, UNIT_LENGTH, &pixel, 1e-15, 1e12, "D[xD[xD]]",
		"spacing of --raw along x, y and z", 0, 0 },
	OPT_END,
};

const struct raw_layout *raw_given(void)
{
	static struct raw_layout raw;

	if (!size.n && !pixel.n)
		return NULL;
	if (!size.n || !pixel.n)
		die(EXIT_USAGE, "--raw and --pixel go together");
	if (size.n < 3 && pixel.n > 2)
		die(EXIT_USAGE, "--pixel: three spacings, but --raw has no layers");
	raw = (struct raw_layout){ .nx = (int)size.v[0],
		.ny = (int)size.v[1],
		.nz = size.n > 2 ? (int)size.v[2] : 1,
		.dx = pixel.v[0],
		.dy = pixel.v[pixel.n > 1],
		.dz = size.n > 2 ? pixel.v[pixel.n - 1] : 0 };
	return &raw;
}
