/* replay.h - reproduces a stream by its recorded pipeline */
#ifndef REPLAY_H
#define REPLAY_H

/* Runs the pipeline that made the stream, without a shell: only programs of wearpipe,
 * from the folder of this one, and none of them writes a file.  Copies the output of the
 * pipeline to standard output.  Returns the exit status of the pipeline. */
int replay_stream(const char *path);

#endif
