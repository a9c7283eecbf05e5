/* join.h - the streams of several processes as the stream of one */
#ifndef JOIN_H
#define JOIN_H

/* Writes the records or rows of n files, or of standard input where n is 0, one after
 * another.  Tables with the same columns have one header, and repeated comments are kept
 * once; each pipeline precedes its rows.  Dies where a file is not whole, or no stream
 * that could be joined. */
void join_streams(int n, char **path);

#endif
