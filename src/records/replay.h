/* replay.h - a stream made anew by the pipeline that it records */
#ifndef REPLAY_H
#define REPLAY_H

/* Runs the pipeline that made the stream, without a shell: only programs of wearpipe, from
 * the folder of this one, and none of them writes a file.  Copies what it writes to
 * standard output.  Returns the exit status of the pipeline. */
int replay_stream(const char *path);

#endif
