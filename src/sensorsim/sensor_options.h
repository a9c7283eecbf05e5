/* sensor_options.h - the pipe, its two sensors and what disturbs them: options of
 * sensorsim */
#ifndef SENSOR_OPTIONS_H
#define SENSOR_OPTIONS_H

#include "cli/opt.h"
#include "signal/simulate/passage.h"
#include "signal/simulate/scene.h"

extern struct opt sensors_rows[]; /* for OPT_TABLE */

/* Dies where options contradict one another. */
void sensors_check(void);

double sensors_rate(void); /* Hz */
struct pipe sensors_pipe(void);
/* The pipe and sensors that particles pass, without the diameters. */
struct stream sensors_stream(uint64_t seed, uint32_t realisation);
/* Time from the first trace of a pulse to its centre. */
double sensors_half_pulse(double velocity);
/* Duration of a pulse at mean velocity, s. */
double sensors_pulse(void);
double sensors_drift_time(void); /* s */
int sensors_channels(void);
/* Events that are no particles, in a record of this length, s; NULL: there are none. */
struct disturbances *sensors_disturbances(
	uint64_t seed, uint32_t realisation, double length);
/* The signal without its particles; dies where a line is above half the rate. */
struct scene *sensors_scene(uint64_t seed, uint32_t realisation);

#endif
