#include "cli/program.h"

static const char *program = "wearpipe";

void program_set_name(const char *name)
{
	program = name;
}

const char *program_name(void)
{
	return program;
}
