#include "cli/files.h"
#include "cli/msg.h"
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FILES_MAX = 256 };

/* Regular files in use. */
static struct {
	dev_t device;
	ino_t number;
	int written;
} used[FILES_MAX];
static int nused;

static void claim(FILE *f, const char *name, int written)
{
	struct stat s;

	if (fstat(fileno(f), &s) || !S_ISREG(s.st_mode))
		return;
	for (int i = 0; i < nused; i++) {
		if (used[i].device != s.st_dev || used[i].number != s.st_ino)
			continue;
		if (!written && !used[i].written)
			return;
		die(EXIT_USAGE, "%s: the same file is %s", name,
			written && used[i].written ? "written twice"
						   : "read and written");
	}
	if (nused == FILES_MAX)
		die(EXIT_RUN, "more than %d files", FILES_MAX);
	used[nused].device = s.st_dev;
	used[nused].number = s.st_ino;
	used[nused++].written = written;
}

FILE *file_open(const char *path, const char **name)
{
	int standard = !path || strcmp(path, "-") == 0;
	FILE *f = standard ? stdin : fopen(path, "rb");

	if (!f)
		die(EXIT_RUN, "%s:", path);
	*name = standard ? "standard input" : path;
	claim(f, *name, 0);
	return f;
}

FILE *file_reserve(const char *path, const char **name)
{
	FILE *f;

	if (path && strcmp(path, "-") == 0)
		die(EXIT_USAGE, "-: an output wants the name of a file");
	f = path ? fopen(path, "ab") : stdout; /* not emptied yet */
	if (!f)
		die(EXIT_RUN, "%s:", path);
	*name = path ? path : "standard output";
	claim(f, *name, 1);
	return f;
}

void file_empty(FILE *f)
{
	struct stat s;

	if (fstat(fileno(f), &s) == 0 && S_ISREG(s.st_mode) && ftruncate(fileno(f), 0))
		die(EXIT_RUN, "cannot empty a file:");
}

FILE *file_create(const char *path, const char **name)
{
	FILE *f = file_reserve(path, name);

	if (path)
		file_empty(f);
	return f;
}
