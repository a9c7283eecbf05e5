/* scores.h - scores of the networks of delaynet */
#ifndef SCORES_H
#define SCORES_H

/* Writes a table of how the network in this file does in the lessons. */
void score_network(const char *path);

#endif
