/* flow.h - what a contact at the hardness leaves behind
 *
 * A cell at the hardness flows by its overlap, -g.  Without load the surface is that much
 * lower there, and pressed again it bears every load up to the old one elastically.
 */
#ifndef CONTACT_FLOW_H
#define CONTACT_FLOW_H

#include <stddef.h>

struct contact_flow {
	double depth; /* greatest, m */
	double sum;   /* of all depths, m: times the area of a cell it is the volume */
};

/* Heights without load, from those given and the pressure and gap of a contact with this
 * hardness. */
struct contact_flow contact_unloaded(size_t n, const double *height,
	const double *pressure, const double *gap, double hardness, double *unloaded);

#endif
