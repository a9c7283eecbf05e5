#include "io/keys.h"
#include "cli/msg.h"
#include <stdlib.h>
#include <string.h>

static int find(const struct keys *keys, const char *key)
{
	for (int i = 0; i < keys->n; i++)
		if (strcmp(keys->key[i], key) == 0)
			return i;
	return -1;
}

void keys_set(struct keys *keys, const char *key, const char *value)
{
	int i = find(keys, key);

	if (i < 0) {
		i = keys->n++;
		keys->key = xrealloc(keys->key, (size_t)keys->n, sizeof *keys->key);
		keys->value = xrealloc(keys->value, (size_t)keys->n, sizeof *keys->value);
		keys->key[i] = xstrdup(key);
	} else {
		free(keys->value[i]);
	}
	keys->value[i] = xstrdup(value);
}

void keys_drop(struct keys *keys, const char *key)
{
	int i = find(keys, key);

	if (i < 0)
		return;
	free(keys->key[i]);
	free(keys->value[i]);
	for (keys->n--; i < keys->n; i++) {
		keys->key[i] = keys->key[i + 1];
		keys->value[i] = keys->value[i + 1];
	}
}

const char *keys_get(const struct keys *keys, const char *key)
{
	int i = find(keys, key);

	return i < 0 ? NULL : keys->value[i];
}

void keys_free(struct keys *keys)
{
	for (int i = 0; i < keys->n; i++) {
		free(keys->key[i]);
		free(keys->value[i]);
	}
	free(keys->key);
	free(keys->value);
	*keys = (struct keys){ 0 };
}
