/* people.h - a table for people: units in the header, four digits, aligned columns */
#ifndef PEOPLE_H
#define PEOPLE_H

/* Rows come as they are read.  Dies where the stream is no table. */
void people_show(const char *path);

#endif
