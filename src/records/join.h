/* join.h - the streams of several processes as the stream of one */
#ifndef JOIN_H
#define JOIN_H

/* Writes the records or rows of n files, or of standard input where n is 0, one after
 * another.  Of tables with the same columns the header is kept once, and so is a comment
 * that is repeated; each pipeline stands before its rows.  Dies where a file is not
 * whole, or no stream that could be joined. */
void join_streams(int n, char **path);

#endif
