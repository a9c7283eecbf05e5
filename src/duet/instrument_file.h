/* instrument_file.h - the instrument that was learned, in a file */
#ifndef INSTRUMENT_FILE_H
#define INSTRUMENT_FILE_H

#include "signal/separate/instrument.h"

/* A file, and what must be the same when it is used again. */
struct instrument_place {
	const char *path;
	double rate, spacing;
	double angle; /* of the first of two components; NAN: there is one */
	const struct calibrate_par *known;
};

/* Returns 0 if there is no such file; dies if it is torn or is of something else. */
int instrument_read(const struct instrument_place *place, struct instrument *in);
/* Replaces the file once all is written. */
void instrument_write(const struct instrument_place *place, const struct instrument *in);

#endif
