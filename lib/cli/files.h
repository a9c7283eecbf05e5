/* files.h - files that are read and written, none of them for two purposes
 *
 * Every stream is opened here.  A regular file that a program reads, or writes as another
 * output, must not be written: its data would be lost or mixed.  All functions die where
 * a file cannot be opened, and tell its name for messages.
 */
#ifndef CLI_FILES_H
#define CLI_FILES_H

#include <stdio.h>

/* Set in the environment of programs that replay a pipeline: what they would write to
 * files by name goes nowhere. */
#define FILE_REPLAY "WEARPIPE_REPLAY"

/* First of all: what was closed of standard input, output and error becomes a descriptor
 * that fails, or drops messages, lest a file that is opened takes its place. */
void files_start(void);
/* Standard output is in use, by whatever is printed there. */
void file_claim_output(void);
/* Inputs that end without an end are still being written: --follow. */
void file_follow(void);
int file_followed(void);
/* To read; path NULL or "-" is standard input. */
FILE *file_open(const char *path, const char **name);
/* To write, emptied; path NULL is standard output, and "-" is misuse. */
FILE *file_create(const char *path, const char **name);
/* The same for what is written last: the file keeps its old contents until
 * file_empty(), so that a file to read may yet be found to be the same. */
FILE *file_reserve(const char *path, const char **name);
void file_empty(FILE *f);

#endif
