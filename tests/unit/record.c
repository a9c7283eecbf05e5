/* Reasons why a record is doubtful: each stands once, also beside one that contains it */
#include "io/record.h"
#include "tap.h"

#include <string.h>

static void add(struct record *r, const char *why, const char *all)
{
	record_doubt(r, why);
	ok(strcmp(record_get(r, "doubtful"), all) == 0, "after '%s': '%s', want '%s'",
		why, record_get(r, "doubtful"), all);
}

int main(void)
{
	struct record r = { 0 };

	ok(record_get(&r, "doubtful") == NULL, "a record is not doubtful at first");
	add(&r, "step 12 did not converge", "step 12 did not converge");
	add(&r, "step 12", "step 12 did not converge; step 12");
	add(&r, "12", "step 12 did not converge; step 12; 12");
	add(&r, "step 12", "step 12 did not converge; step 12; 12");
	add(&r, "step 12; 12", "step 12 did not converge; step 12; 12");
	add(&r, "converge", "step 12 did not converge; step 12; 12; converge");
	record_free(&r);
	return tap_done();
}
