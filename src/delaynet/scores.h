/* scores.h - what the networks of delaynet are worth */
#ifndef SCORES_H
#define SCORES_H

/* Writes a table of how the network in this file does in the lessons. */
void score_network(const char *path);

#endif
