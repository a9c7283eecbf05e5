/* A thousand contacts with a hardness, three quarters of them with a load that is a whole
 * number of cells at the hardness: every one is solved by both solvers. */
#include "../unit/hardness_scene.h"

int main(void)
{
	hardness_scan(100, 1100);
	return tap_done();
}
