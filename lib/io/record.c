#include "io/record.h"
#include "cli/msg.h"
#include "num/pages.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void free_spares(struct record *r)
{
	while (r->spares > 0)
		free(r->spare[--r->spares]);
}

/* Keeps the memory of a field, or frees it. */
static void release(struct record *r, double *data)
{
	size_t n = record_points(r);

	if (n != r->spare_points)
		free_spares(r);
	r->spare_points = n;
	if (r->spares < RECORD_FIELDS_MAX)
		r->spare[r->spares++] = data;
	else
		free(data);
}

void record_clear(struct record *r)
{
	struct record empty = { 0 };

	for (int i = 0; i < r->nfields; i++) {
		free(r->name[i]);
		free(r->unit[i]);
		if (r->data[i])
			release(r, r->data[i]);
	}
	keys_free(&r->keys);
	free(r->cmd);
	memcpy(empty.spare, r->spare, sizeof empty.spare);
	empty.spares = r->spares;
	empty.spare_points = r->spare_points;
	*r = empty;
}

void record_free(struct record *r)
{
	record_clear(r);
	free_spares(r);
}

void record_init(struct record *r, int nx, int ny, double dx, double dy)
{
	record_free(r);
	r->nx = nx;
	r->ny = ny;
	r->nz = 1;
	r->dx = dx;
	r->dy = dy;
}

int record_find(const struct record *r, const char *name)
{
	for (int i = 0; i < r->nfields; i++)
		if (strcmp(r->name[i], name) == 0)
			return i;
	return -1;
}

size_t record_points(const struct record *r)
{
	return (size_t)r->nx * (size_t)r->ny * (size_t)r->nz;
}

static double *new_data(struct record *r, int zeroed)
{
	size_t n = record_points(r);
	double *data;

	if (n != r->spare_points)
		free_spares(r);
	if (r->spares == 0) {
		data = zeroed ? xcalloc(n, sizeof *data)
			      : xrealloc(NULL, n, sizeof *data);
		pages_large(data, n * sizeof *data);
		return data;
	}
	data = r->spare[--r->spares];
	if (zeroed)
		memset(data, 0, n * sizeof *data);
	return data;
}

void record_name_field(struct record *r, const char *name, const char *unit)
{
	if (r->nfields == RECORD_FIELDS_MAX)
		die(EXIT_RUN, "more than %d fields in a record", RECORD_FIELDS_MAX);
	r->name[r->nfields] = xstrdup(name);
	r->unit[r->nfields] = xstrdup(unit);
	r->data[r->nfields++] = NULL;
}

void record_new_field(struct record *r, const char *name, const char *unit)
{
	record_name_field(r, name, unit);
	r->data[r->nfields - 1] = new_data(r, 0);
}

double *record_add(struct record *r, const char *name, const char *unit)
{
	int i = record_find(r, name);

	if (i < 0) {
		i = r->nfields;
		record_name_field(r, name, unit);
		r->data[i] = new_data(r, 1);
	}
	return r->data[i];
}

void record_drop(struct record *r, const char *name)
{
	int i = record_find(r, name);

	if (i < 0)
		return;
	free(r->name[i]);
	free(r->unit[i]);
	free(r->data[i]);
	for (r->nfields--; i < r->nfields; i++) {
		r->name[i] = r->name[i + 1];
		r->unit[i] = r->unit[i + 1];
		r->data[i] = r->data[i + 1];
	}
}

void record_set(struct record *r, const char *key, const char *format, ...)
{
	char value[4096];
	va_list ap;
	int n;

	va_start(ap, format);
	n = vsnprintf(value, sizeof value, format, ap);
	va_end(ap);
	if (n < 0 || (size_t)n >= sizeof value)
		die(EXIT_RUN, "value of key %s is longer than %zu bytes", key,
			sizeof value);
	keys_set(&r->keys, key, value);
}

void record_drop_key(struct record *r, const char *key)
{
	keys_drop(&r->keys, key);
}

/* Whether a reason is one of, or some neighbours of, those joined by "; ". */
static int is_among(const char *reasons, const char *why)
{
	size_t n = strlen(why);

	for (const char *at = reasons; (at = strstr(at, why)) != NULL; at++) {
		int begins = at == reasons ||
			     (at - reasons > 1 && at[-1] == ' ' && at[-2] == ';');

		if (begins && (at[n] == '\0' || strncmp(at + n, "; ", 2) == 0))
			return 1;
	}
	return 0;
}

void record_doubt(struct record *r, const char *why)
{
	const char *before = record_get(r, "doubtful");
	char *both;

	if (before && is_among(before, why))
		return;
	both = before ? xprintf("%s; %s", before, why) : xstrdup(why);
	record_set(r, "doubtful", "%s", both);
	free(both);
}

const char *record_get(const struct record *r, const char *key)
{
	return keys_get(&r->keys, key);
}

void record_copy_keys(struct record *to, const struct record *from)
{
	to->realisation = from->realisation;
	for (int i = 0; i < from->keys.n; i++)
		keys_set(&to->keys, from->keys.key[i], from->keys.value[i]);
}

double record_get_number(const struct record *r, const char *key)
{
	const char *text = record_get(r, key);
	char *end;
	double v;

	if (!text)
		return NAN;
	v = strtod(text, &end);
	return end == text || *end ? NAN : v;
}
