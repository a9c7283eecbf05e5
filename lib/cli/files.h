/* files.h - files that are read and written, each for one purpose only
 *
 * Every stream is opened here.  A regular file that a program reads, or writes as another
 * output, must not be written: its data would be lost or mixed.  All functions die if a
 * file cannot be opened, and return its name for messages.
 */
#ifndef CLI_FILES_H
#define CLI_FILES_H

#include <stdio.h>

/* Set in the environment of programs that replay a pipeline: output to named files is
 * discarded. */
#define FILE_REPLAY "WEARPIPE_REPLAY"

/* To be called first: a closed standard input, output or error is replaced by a
 * descriptor that fails, or discards messages, so that no file opened later takes its
 * number. */
void files_start(void);
/* Marks standard output as used. */
void file_claim_output(void);
/* Marks a file that is opened later, but must not be an output, as read. */
void file_claim_input(const char *path);
/* Whether the path is a regular file that is read already. */
int file_is_read(const char *path);
/* --follow: inputs without an end mark are still being written. */
void file_follow(void);
int file_followed(void);
/* To read; path NULL or "-" is standard input, which must not be a terminal unless it is
 * named. */
FILE *file_open(const char *path, const char **name);
/* Opens a file for writing and empties it; path NULL is standard output, and "-" is an
 * error. */
FILE *file_create(const char *path, const char **name);
/* The same for output that is written last: the file keeps its contents until
 * file_empty(), so that it is still refused if it is opened for reading. */
FILE *file_reserve(const char *path, const char **name);
void file_empty(FILE *f);
/* Opens a file beside path, under a name of this process alone.  file_replace() puts it
 * in the place of path once what it holds is complete, and frees its name; it may still
 * be open. */
FILE *file_create_beside(const char *path, char **fresh);
void file_replace(char *fresh, const char *path);

#endif
