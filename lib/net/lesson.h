/* lesson.h - training samples of one kind, with their loss
 *
 * A lesson provides the samples of network_train(), counted from first; a set that is
 * used many times can be kept in memory.
 */
#ifndef NET_LESSON_H
#define NET_LESSON_H

#include "net/cnndata.h"
#include "net/delaydata.h"
#include "net/delayloss.h"
#include "net/training.h"
#include "num/status.h"

struct lesson {
	const char *purpose; /* for the file of weights */
	struct network_shape input;
	int inputs, outputs, targets;
	network_loss *loss;
	uint32_t first;
	int of_pulses;
	struct delaydata_par sines;
	struct cnndata_par pulses;
	network_real *x, *target; /* samples kept, one after another; else NULL */
};

/* Sections of sines (delaydata.h), labels of delays, loss of the caller's choice. */
struct lesson lesson_of_sines(
	const struct delaydata_par *par, network_loss *loss, uint32_t first);
/* Sections of pulses (cnndata.h), for the networks of cnn.h. */
struct lesson lesson_of_pulses(const struct cnndata_par *par, uint32_t first);

/* Makes count samples and keeps them; they are given back with lesson_drop(). */
enum num_status lesson_keep(struct lesson *lesson, long count);
void lesson_drop(struct lesson *lesson);

/* For network_train(); the context is the lesson. */
network_sample lesson_sample;

/* 1 if the network has the lesson's inputs and outputs, of any width. */
int lesson_suits(const struct lesson *l, const struct network *net);

#endif
