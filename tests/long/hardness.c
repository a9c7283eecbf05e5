/* Two thousand contacts with a hardness, half of them of white noise on prime numbers of
 * cells, three quarters with a load that is a whole
 * number of cells at the hardness: every one is solved by both solvers. */
#include "../unit/hardness_scene.h"

int main(void)
{
	hardness_scan(100, 1100);
	return tap_done();
}
