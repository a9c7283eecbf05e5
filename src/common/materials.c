#include "common/materials.h"
#include "cli/msg.h"
#include <stdlib.h>
#include <string.h>

char *material_names(void)
{
	char *names = xstrdup("");

	for (int i = 0; material_at(i); i++)
		names = xappend(names, "%s%s", i ? ", " : "", material_at(i)->name);
	return names;
}

const struct material *material_named(const char *option, const char *name)
{
	const struct material *found = material_find(name);

	if (!found)
		die(EXIT_USAGE, "%s: no '%s'; there are %s", option, name,
			material_names());
	return found;
}

/* NAME or NAME=SHARE of length bytes. */
static void add_part(struct material_mix *mix, const char *text, size_t length)
{
	char *word = xstrdup(text), *equals, *end;
	double share = 1;

	word[length] = '\0';
	equals = strchr(word, '=');
	if (equals) {
		*equals = '\0';
		share = strtod(equals + 1, &end);
		if (end == equals + 1 || *end || !(share >= 0 && share <= 1e9))
			die(EXIT_USAGE, "--material %s: '%s' is not a share", word,
				equals + 1);
	}
	if (mix->n == MATERIALS_MIXED)
		die(EXIT_USAGE, "--material: at most %d", MATERIALS_MIXED);
	mix->part[mix->n] = material_named("--material", word);
	mix->share[mix->n++] = share;
	free(word);
}

struct material_mix materials_read(const char *text)
{
	struct material_mix mix = { 0 };
	double sum = 0;

	for (const char *s = text; s;) {
		size_t length = strcspn(s, ",");

		add_part(&mix, s, length);
		s = s[length] ? s + length + 1 : NULL;
	}
	for (int i = 0; i < mix.n; i++)
		sum += mix.share[i];
	if (!(sum > 0))
		die(EXIT_USAGE, "--material %s: all shares are 0", text);
	return mix;
}
