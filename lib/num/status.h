/* status.h - result of a function that fails only without memory or for arguments outside
 * its domain; functions with more causes have enums of their own.  0 is success in all of
 * them. */
#ifndef NUM_STATUS_H
#define NUM_STATUS_H

enum num_status {
	NUM_OK,
	NUM_MEMORY, /* out of memory: nothing done */
	NUM_DOMAIN  /* the arguments have no such result */
};

#endif
