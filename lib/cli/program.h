/* program.h - the name of the running program, as messages and progress show it */
#ifndef CLI_PROGRAM_H
#define CLI_PROGRAM_H

/* opt_parse() sets it; before that it is "wearpipe". */
void program_set_name(const char *name);
const char *program_name(void);

#endif
