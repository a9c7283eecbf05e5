/* pretty.h - a table for people: units in the header, four digits, aligned columns */
#ifndef PRETTY_H
#define PRETTY_H

/* Rows come as they are read.  Dies where the stream is no table. */
void pretty_show(const char *path);

#endif
