/* actions.h - what records does with a stream other than selecting from it */
#ifndef ACTIONS_H
#define ACTIONS_H

/* Reads a stream of any format to its end and prints a line with its contents; dies if it
 * is damaged or truncated.  Returns the exit status: EXIT_NOCONV if the stream has no end
 * mark, so that completeness is unknown. */
int check_stream(const char *path);

/* Writes the records or rows of n files, or of standard input where n is 0, one after
 * another.  Tables with the same columns have one header, and repeated comments are kept
 * once; each pipeline precedes its rows.  Dies where a file is not complete or is not a
 * stream that can be joined. */
void join_streams(int n, char **path);

/* Prints a table for reading: units in the header, four digits, aligned columns.  Rows
 * come as they are read.  Dies where the stream is not a table. */
void show_pretty(const char *path);

/* Runs the pipeline that made the stream, without a shell: only programs of wearpipe,
 * from the folder of this one, and none of them writes a file.  Copies the output of the
 * pipeline to standard output.  Returns the exit status of the pipeline. */
int replay_stream(const char *path);

#endif
