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
	ok(want && got ? !strcmp(got, want) : want == got,
		"the parts '%s', ... are joined as '%s'", part[0] ? part[0] : "",
		got ? got : "");
	upstream_free(&u);
}

int main(void)
{
	joins((const char *[]){ NULL }, NULL);
	joins((const char *[]){ "a --first 9 --count 1", NULL }, "a --first 9 --count 1");
	joins((const char *[]){ "a --first 9 --count 1", "a --first 10 --count 1", NULL },
		"a --first 9 --count 2");
	joins((const char *[]){ "a -x --first 1 --count 1 -y | b",
		      "a -x --first 2 --count 1 -y | b",
		      "a -x --first 3 --count 1 -y | c", NULL },
		"{ a -x --first 1 --count 2 -y | b; a -x --first 3 --count 1 -y | c; }");
	joins((const char *[]){ "a --first 1 --count 1", "a --first 1 --count 1", NULL },
		"{ a --first 1 --count 1; a --first 1 --count 1; }");
	joins((const char *[]){ "a --first 2 --count 1", "a --first 1 --count 1", NULL },
		"{ a --first 2 --count 1; a --first 1 --count 1; }");
	/* Several realisations in one part. */
	joins((const char *[]){ "a --first 0 --count 2", "a --first 2 --count 3", NULL },
		"a --first 0 --count 5");
	joins((const char *[]){ "a --first 0 --count 2", "a --first 1 --count 2", NULL },
		"{ a --first 0 --count 2; a --first 1 --count 2; }");
	/* A program without --count, and numbers that are those of no source. */
	joins((const char *[]){ "a --first 0", "a --first 1", NULL },
		"{ a --first 0; a --first 1; }");
	joins((const char *[]){ "a f | b --first 1 --count 1",
		      "a f | b --first 2 --count 1", NULL },
		"{ a f | b --first 1 --count 1; a f | b --first 2 --count 1; }");
	joins((const char *[]){ "a --first 1mm --count 1", "a --first 2mm --count 1",
		      NULL },
		"{ a --first 1mm --count 1; a --first 2mm --count 1; }");
	joins((const char *[]){ "a --first 1 --count 1e3", "a --first 2 --count 1e3",
		      NULL },
		"{ a --first 1 --count 1e3; a --first 2 --count 1e3; }");
	return tap_done();
}
