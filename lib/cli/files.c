#include "cli/files.h"
#include "cli/msg.h"
#include "cli/text.h"
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
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
static int nused, claimed_output;

static void claim_state(const struct stat *s, const char *name, int written)
{
	if (!S_ISREG(s->st_mode))
		return;
	for (int i = 0; i < nused; i++) {
		if (used[i].device != s->st_dev || used[i].number != s->st_ino)
			continue;
		if (!written && !used[i].written)
			return;
		die(EXIT_USAGE, "%s: the same file is %s", name,
			written && used[i].written ? "written twice"
						   : "read and written");
	}
	if (nused == FILES_MAX)
		die(EXIT_RUN, "more than %d files", FILES_MAX);
	used[nused].device = s->st_dev;
	used[nused].number = s->st_ino;
	used[nused++].written = written;
}

static void claim(FILE *f, const char *name, int written)
{
	struct stat s;

	if (fstat(fileno(f), &s) == 0)
		claim_state(&s, name, written);
}

int file_is_read(const char *path)
{
	struct stat s;

	for (int i = 0; i < nused && stat(path, &s) == 0; i++)
		if (!used[i].written && used[i].device == s.st_dev &&
			used[i].number == s.st_ino)
			return 1;
	return 0;
}

static int follow;

void file_follow(void)
{
	follow = 1;
}

int file_followed(void)
{
	return follow;
}

static void open_closed(int fd, int flags)
{
	if (fcntl(fd, F_GETFD) >= 0 || errno != EBADF)
		return;
	if (open("/dev/null", flags) != fd)
		exit(EXIT_RUN); /* standard error is closed, too */
}

void files_start(void)
{
	open_closed(STDIN_FILENO, O_WRONLY);  /* cannot be read */
	open_closed(STDOUT_FILENO, O_RDONLY); /* cannot be written */
	open_closed(STDERR_FILENO, O_WRONLY);
}

void file_claim_output(void)
{
	if (!claimed_output++)
		claim(stdout, "standard output", 1);
}

void file_claim_input(const char *path)
{
	struct stat s;

	if (stat(path, &s) == 0)
		claim_state(&s, text_file_name(path), 0);
}

FILE *file_open(const char *path, const char **name)
{
	int standard = !path || strcmp(path, "-") == 0;
	FILE *f = standard ? stdin : fopen(path, "rb");

	/* A hint in place of waiting for what nobody types. */
	if (!path && isatty(STDIN_FILENO))
		die(EXIT_USAGE, "nothing to read: name a file, or - for what is typed");
	if (!f)
		die(EXIT_RUN, "%s:", text_file_name(path));
	*name = standard ? "standard input" : text_file_name(path);
	claim(f, *name, 0);
	return f;
}

FILE *file_reserve(const char *path, const char **name)
{
	FILE *f;

	if (path && strcmp(path, "-") == 0)
		die(EXIT_USAGE, "-: an output requires a file name");
	if (path && getenv(FILE_REPLAY) && strncmp(path, "/dev/fd/", 8) != 0)
		path = "/dev/null";
	f = path ? fopen(path, "ab") : stdout; /* not emptied yet */
	if (!f)
		die(EXIT_RUN, "%s:", text_file_name(path));
	*name = path ? text_file_name(path) : "standard output";
	if (path)
		claim(f, *name, 1);
	else
		file_claim_output();
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

FILE *file_create_beside(const char *path, char **fresh)
{
	FILE *f;

	*fresh = getenv(FILE_REPLAY) ? xstrdup("/dev/null")
				     : xprintf("%s.%ld.new", path, (long)getpid());
	f = fopen(*fresh, "wb");
	if (!f)
		die(EXIT_RUN, "%s:", *fresh);
	return f;
}

void file_replace(char *fresh, const char *path)
{
	if (!getenv(FILE_REPLAY) && rename(fresh, path))
		die(EXIT_RUN, "%s:", path);
	free(fresh);
}
