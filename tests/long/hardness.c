/* Three thousand contacts with a hardness, a third of them of white noise on prime
 * numbers of cells and a third of waves along strips; of the others three quarters have a
 * load that is a whole number of cells at the hardness.  Every one is solved by both
 * solvers. */
#include "../unit/hardness_scene.h"

int main(void)
{
	hardness_scan(100, 1100);
	return tap_done();
}
