/* status.h - what a function returns that can only run short of memory or be asked for
 * what it is not defined for; those with more reasons have an enum of their own.  0 is
 * success in all of them. */
#ifndef NUM_STATUS_H
#define NUM_STATUS_H

enum num_status {
	NUM_OK,
	NUM_MEMORY, /* out of memory: nothing done */
	NUM_DOMAIN  /* the arguments have no such result */
};

#endif
