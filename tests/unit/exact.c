/* Contacts whose solution is known: strips, primes, hardnesses and holes, small ones of
 * those of tests/long/exact.c. */
#include "exact_scene.h"

int main(void)
{
	exact_solve(&(struct exact_scene){
		64, 1024, CONTACT_PERIODIC, NOISE, 0.3, 0, 0, 30 });
	exact_solve(&(struct exact_scene){
		3, 2000, CONTACT_PERIODIC, PATCHES, 0.2, 0, 0, 26 });
	exact_solve(&(struct exact_scene){
		16, 1024, CONTACT_PERIODIC, PATCHES, 0.2, 0, 0, 28 });
	exact_solve(&(struct exact_scene){
		127, 131, CONTACT_PERIODIC, PATCHES, 0.2, 0, 0, 22 });
	exact_solve(
		&(struct exact_scene){ 127, 131, CONTACT_FREE, NOISE, 0.02, 0, 0, 14 });
	exact_solve(&(struct exact_scene){
		96, 96, CONTACT_PERIODIC, PATCHES, 0.2, 5e8, 0, 13 });
	exact_solve(
		&(struct exact_scene){ 64, 64, CONTACT_FREE, NOISE, 0.5, 5e8, 0, 17 });
	exact_solve(&(struct exact_scene){
		96, 96, CONTACT_PERIODIC, PATCHES, 0.2, 0, 1, 18 });
	exact_solve(
		&(struct exact_scene){ 96, 96, CONTACT_FREE, PATCHES, 1, 0, 1000, 14 });
	return tap_done();
}
