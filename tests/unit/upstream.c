/* Pipelines of the parts of a table, joined. */
#include "cli/upstream.h"
#include "tap.h"
#include <string.h>

static void joins(const char *const *part, const char *want)
{
	struct upstream u = { 0 };
	const char *got;

	for (int i = 0; part[i]; i++)
		upstream_add(&u, part[i]);
	got = upstream_cmd(&u);
	ok(want && got ? !strcmp(got, want) : want == got, "%s: %s",
		want ? want : "nothing", got ? got : "nothing");
	upstream_free(&u);
}

int main(void)
{
	joins((const char *[]){ NULL }, NULL);
	joins((const char *[]){ "roughgen --first 9", NULL }, "roughgen --first 9");
	joins((const char *[]){ "roughgen --first 9", "roughgen --first 10", NULL },
		"roughgen --first 9 --count 2");
	joins((const char *[]){ "roughgen --first 1 | a", "roughgen --first 2 | a",
		      "roughgen --first 3 | b", NULL },
		"{ roughgen --first 1 --count 2 | a; roughgen --first 3 | b; }");
	joins((const char *[]){ "roughgen --first 1", "roughgen --first 1", NULL },
		"{ roughgen --first 1; roughgen --first 1; }");
	joins((const char *[]){ "roughgen --first 2", "roughgen --first 1", NULL },
		"{ roughgen --first 2; roughgen --first 1; }");
	/* Numbers that are those of no surface. */
	joins((const char *[]){ "roughgen f | rwl --first 1",
		      "roughgen f | rwl --first 2", NULL },
		"{ roughgen f | rwl --first 1; roughgen f | rwl --first 2; }");
	joins((const char *[]){ "roughgen --first 1mm", "roughgen --first 2mm", NULL },
		"{ roughgen --first 1mm; roughgen --first 2mm; }");
	/* A part that is counted already. */
	joins((const char *[]){ "roughgen --first 0 --count 2",
		      "roughgen --first 1 --count 2", NULL },
		"{ roughgen --first 0 --count 2; roughgen --first 1 --count 2; }");
	return tap_done();
}
