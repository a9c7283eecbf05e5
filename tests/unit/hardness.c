/* Contacts whose load is a whole number of cells at the hardness, and others: a part of
 * the scan of tests/long/hardness.c. */
#include "hardness_scene.h"

int main(void)
{
	hardness_scan(0, 100);
	return tap_done();
}
