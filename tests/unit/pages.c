/* Memory that a program keeps: it is not asked for again */
#include "num/pages.h"
#include "tap.h"

#include <stdlib.h>
#include <sys/resource.h>

/* As much as the C library gives back to the system when it is freed, unless told. */
enum { SIZE = 40 << 20 };

static long faults(void)
{
	struct rusage usage;

	getrusage(RUSAGE_SELF, &usage);
	return usage.ru_minflt;
}

/* Faults of the system while memory is written to for the first time; -1: there is none.
 */
static long faults_of_use(void)
{
	volatile unsigned char *memory = malloc(SIZE);
	long before = faults();

	for (size_t i = 0; memory && i < SIZE; i += 4096)
		memory[i] = 1;
	before = memory ? faults() - before : -1;
	free((void *)memory);
	return before;
}

int main(void)
{
	long first, again;

	pages_reserve(4 * (size_t)SIZE);
	first = faults_of_use();
	again = faults_of_use();
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
	ok(again >= 0 && again < 16,
		"freed memory is used again without a fault of the system (%ld, %ld)",
		first, again);
#else
	ok(first >= 0 && again >= 0, "other C libraries ignore it");
#endif
	pages_reserve((size_t)1 << 62);
	again = faults_of_use();
	ok(again >= 0, "more than the system has to promise is no error");
	return tap_done();
}
