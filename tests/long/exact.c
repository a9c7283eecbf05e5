/* Contacts whose solution is known, at full size: bounds of the iterations and of the
 * error of the pressure. */
#include "../unit/exact_scene.h"

int main(void)
{
	static const struct exact_scene scene[] = {
		{ 64, 4096, CONTACT_PERIODIC, NOISE, 0.3, 0, 0, 40 },
		{ 4096, 64, CONTACT_PERIODIC, PATCHES, 0.2, 0, 0, 42 },
		{ 64, 4096, CONTACT_PERIODIC, PATCHES, 1, 0, 0, 22 },
		{ 64, 2048, CONTACT_FREE, PATCHES, 0.2, 0, 0, 36 },
		{ 16, 8192, CONTACT_PERIODIC, NOISE, 0.3, 0, 0, 140 },
		{ 16, 8192, CONTACT_PERIODIC, PATCHES, 0.2, 0, 0, 90 },
		{ 3, 10000, CONTACT_PERIODIC, NOISE, 0.3, 0, 0, 140 },
		{ 3, 10000, CONTACT_PERIODIC, PATCHES, 0.2, 0, 0, 55 },
		{ 3, 10000, CONTACT_FREE, PATCHES, 0.2, 0, 0, 85 },
		{ 251, 257, CONTACT_PERIODIC, PATCHES, 0.2, 0, 0, 20 },
		{ 251, 257, CONTACT_FREE, NOISE, 0.02, 0, 0, 16 },
		{ 128, 128, CONTACT_PERIODIC, PATCHES, 0.2, 5e8, 0, 15 },
		{ 128, 128, CONTACT_FREE, NOISE, 0.5, 5e8, 0, 18 },
		{ 64, 1024, CONTACT_PERIODIC, PATCHES, -0.3, 6e8, 0, 22 },
		{ 128, 128, CONTACT_PERIODIC, PATCHES, 0.2, 0, 1, 18 },
		{ 128, 128, CONTACT_FREE, PATCHES, 1, 0, 1000, 16 },
		/* Scenes of the same kinds as those that tuned the solver, but others. */
		{ 48, 5000, CONTACT_PERIODIC, NOISE, 0.6, 0, 0, 75 },
		{ 5000, 5, CONTACT_PERIODIC, PATCHES, 0.6, 0, 0, 40 },
		{ 20, 3000, CONTACT_FREE, NOISE, 0.1, 0, 0, 36 },
		{ 4001, 11, CONTACT_PERIODIC, PATCHES, -0.2, 0, 0, 40 },
		{ 211, 199, CONTACT_PERIODIC, PATCHES, -0.2, 7e8, 0, 18 },
		{ 90, 160, CONTACT_PERIODIC, NOISE, 0.2, 0, 1e3, 18 },
	};

	for (size_t i = 0; i < sizeof(scene) / sizeof(*scene); i++)
		exact_solve(&scene[i]);
	return tap_done();
}
