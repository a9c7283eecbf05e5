/* keys.h - a short list of key and value texts, in order of first appearance */
#ifndef IO_KEYS_H
#define IO_KEYS_H

enum { KEYS_MOST = 1000 }; /* of a table */

struct keys {
	int n;
	char **key, **value;
};

/* Copies both; a key that is there gets the new value. */
void keys_set(struct keys *keys, const char *key, const char *value);
void keys_drop(struct keys *keys, const char *key);
const char *keys_get(const struct keys *keys, const char *key); /* NULL if absent */
void keys_free(struct keys *keys);

#endif
