#include "io/formats.h"
#include "cli/msg.h"
#include "io/kinds.h"
#include "num/bytes.h"
#include "num/crc32.h"
#include "num/lanes.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER_MAX = 1 << 20 };

const char mark_key[] = "stream:=", mark_zeros[] = "00000000";

/* Adds a line to the checksum, with zeros for the digits of a mark. */
static void sum_line(struct place *at, const char *line, size_t n)
{
	size_t key = strlen(mark_key), digits = strlen(mark_zeros);

	if (strncmp(line, mark_key, key) != 0 || n < key + digits + 1) {
		at->checksum = crc32_add(at->checksum, line, n);
		return;
	}
	at->checksum = crc32_add(at->checksum, line, n - digits - 1);
	at->checksum = crc32_add(at->checksum, mark_zeros, digits);
	at->checksum = crc32_add(at->checksum, line + n - 1, 1);
}

char *header_line(struct place *at, size_t *header_size)
{
	size_t most = input_limit("header", HEADER_MAX), room = 0, n;
	char *line = NULL;

	n = *header_size < most ? input_line(at->in, &line, &room, most - *header_size)
				: 1;
	if (*header_size + n > most)
		die(EXIT_RUN, "%s: record %ld: header longer than %zu bytes", at->name,
			at->record, most);
	if (n == 0 || line[n - 1] != '\n') {
		if (*header_size == 0 && at->record == 1)
			kind_refuse(at->name, line, n, KIND_FIELD);
		free(line);
		return NULL;
	}
	*header_size += n;
	sum_line(at, line, n);
	line[--n] = '\0';
	if (n && line[n - 1] == '\r')
		line[--n] = '\0';
	return line;
}

void check_sizes(const struct place *at, const double *sizes, int n)
{
	double all = 8, most = (double)input_limit("bytes", (size_t)1e15);

	for (int i = 0; i < n; i++) {
		if (!(sizes[i] >= 1 && sizes[i] <= 1e9) || sizes[i] != floor(sizes[i]))
			die(EXIT_RUN,
				"%s: record %ld: size %g, want a whole number from 1 to 1e9",
				at->name, at->record, sizes[i]);
		all *= sizes[i];
	}
	if (all > most)
		die(EXIT_RUN, "%s: record %ld: %g bytes of samples are too many",
			at->name, at->record, all);
}

void warn_units(const struct place *at, int spacings, int heights)
{
	if (at->record == 1 && !(spacings && heights))
		warn("%s: no unit of %s in the header: metres are assumed", at->name,
			spacings  ? "heights"
			: heights ? "spacings"
				  : "spacings and heights");
}

void check_spacing(const struct place *at, int axis, double spacing)
{
	if (!(spacing >= 1e-30 && spacing <= 1e30))
		die(EXIT_RUN,
			"%s: record %ld: spacing of axis %d is %g m, want 1e-30 to 1e30",
			at->name, at->record, axis, spacing);
}

/* A regular file must have the length that its header declares: checked before memory is
 * allocated. */
static void check_length(const struct place *at, uint64_t want)
{
	uint64_t left = input_left(at->in);

	if (left < want)
		die(EXIT_RUN, "%s: record %ld: want %llu bytes, got %llu", at->name,
			at->record, (unsigned long long)want, (unsigned long long)left);
}

static inline void take_two(const unsigned char *bytes, size_t width, double *to)
{
	lanes two = { bytes_double_little(bytes), bytes_double_little(bytes + width) };

	lanes_store(to, two, 2);
}

/* Little-endian doubles, which wearpipe itself writes, by eight: loops are not unrolled
 * at -O2. */
static void take_doubles(const unsigned char *bytes, size_t width, size_t n, double *to)
{
	size_t i = 0;

	for (; i + 8 <= n; i += 8, bytes += 8 * width) {
		take_two(bytes, width, to + i);
		take_two(bytes + 2 * width, width, to + i + 2);
		take_two(bytes + 4 * width, width, to + i + 4);
		take_two(bytes + 6 * width, width, to + i + 6);
	}
	for (; i < n; i++, bytes += width)
		to[i] = bytes_double_little(bytes);
}

/* Every width bytes a sample of the layout. */
static void take_samples(const unsigned char *bytes, size_t width, size_t n,
	struct samples layout, double *to)
{
	if (layout.single && layout.big_endian)
		for (size_t i = 0; i < n; i++)
			to[i] = (double)bytes_float(bytes_u32_big(bytes + i * width));
	else if (layout.single)
		for (size_t i = 0; i < n; i++)
			to[i] = (double)bytes_float(bytes_u32_little(bytes + i * width));
	else if (layout.big_endian)
		for (size_t i = 0; i < n; i++)
			to[i] = bytes_double_big(bytes + i * width);
	else
		take_doubles(bytes, width, n, to);
}

void parts_begin(struct parts *p, size_t points, size_t width)
{
	size_t most = (size_t)PARTS * PART_POINTS;

	*p = (struct parts){ .all = points, .width = width };
	p->bytes = xrealloc(NULL, points < most ? points : most, width);
}

static size_t count_parts(const struct parts *p)
{
	return (p->points + PART_POINTS - 1) / PART_POINTS;
}

size_t parts_next(struct parts *p)
{
	size_t most = (size_t)PARTS * PART_POINTS, left;

	p->first += p->points;
	left = p->all - p->first;
	p->points = left < most ? left : most;
	return count_parts(p);
}

size_t part_points(const struct parts *p, size_t k)
{
	size_t left = p->points - k * PART_POINTS;

	return left < PART_POINTS ? left : PART_POINTS;
}

unsigned char *part_bytes(const struct parts *p, size_t k)
{
	return p->bytes + k * PART_POINTS * p->width;
}

uint32_t parts_sum(const struct parts *p, uint32_t checksum)
{
	for (size_t k = 0; k < count_parts(p); k++)
		checksum = crc32_join(
			checksum, p->checksum[k], part_points(p, k) * p->width);
	return checksum;
}

void parts_end(struct parts *p)
{
	free(p->bytes);
}

/* Whether all samples are finite, a multiple of eight. */
LANES_CLONES static int all_finite(const double *x, size_t n)
{
	lanes4 a, b, sum = { 0 }, other = { 0 }; /* nan as soon as one is not finite */

	for (size_t i = 0; i < n; i += 8) {
		memcpy(&a, x + i, sizeof a);
		memcpy(&b, x + i + 4, sizeof b);
		sum += 0 * a;
		other += 0 * b;
	}
	sum += other;
	return sum[0] + sum[1] + sum[2] + sum[3] == 0;
}

/* The first sample that is not a number or infinite, or n. */
static size_t first_infinite(const double *x, size_t n)
{
	size_t whole = n - n % 8, i = all_finite(x, whole) ? whole : 0;

	while (i < n && isfinite(x[i]))
		i++;
	return i;
}

void check_finite(const struct place *at, const struct record *r, const char *name,
	const double *sample, size_t n, size_t first)
{
	size_t i = first_infinite(sample, n), nx = (size_t)r->nx;

	if (i < n)
		die(EXIT_RUN,
			"%s: record %ld: %s is %g at x %zu, y %zu; want finite samples",
			at->name, at->record, name, sample[i], (first + i) % nx,
			(first + i) / nx % (size_t)r->ny);
}

struct reading {
	struct parts parts;
	double *unkept; /* these parts of a field that is only checked */
	struct record *r;
	struct samples layout;
};

static void take_part(void *context, size_t k, int worker)
{
	struct reading *t = context;
	const unsigned char *bytes = part_bytes(&t->parts, k);
	size_t n = part_points(&t->parts, k), width = t->parts.width;
	size_t step = t->layout.single ? 4 : 8;

	(void)worker;
	t->parts.checksum[k] = crc32_add(0, bytes, n * width);
	for (size_t field = 0; field < (size_t)t->r->nfields; field++) {
		double *kept = t->r->data[field];

		take_samples(bytes + field * step, width, n, t->layout,
			(kept ? kept + t->parts.first : t->unkept) + k * PART_POINTS);
	}
}

void samples_read(struct place *at, struct record *r, struct samples layout)
{
	size_t points = record_points(r), parts;
	size_t width = (size_t)r->nfields * (layout.single ? 4 : 8);
	struct reading t = { .r = r, .layout = layout };
	struct parts *p = &t.parts;

	check_length(at, (uint64_t)width * points);
	parts_begin(p, points, width);
	if (at->unkept)
		t.unkept = xcalloc((size_t)PARTS * PART_POINTS, sizeof *t.unkept);
	while ((parts = parts_next(p)) > 0) {
		size_t got = input_read(at->in, p->bytes, p->points * width);

		if (got < p->points * width)
			die(EXIT_RUN, "%s: record %ld: want %zu bytes, got %zu", at->name,
				at->record, points * width, p->first * width + got);
		pool_run(at->pool, parts, take_part, &t);
		at->checksum = parts_sum(p, at->checksum);
		if (at->unkept && record_find(r, at->unkept) >= 0)
			check_finite(at, r, at->unkept, t.unkept, p->points, p->first);
	}
	parts_end(p);
	free(t.unkept);
}
