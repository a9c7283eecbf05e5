/* netfile.c - networks as text: the layers in one line, the weights in one file */
#include "net/netfile.h"
#include "num/crc32.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char first_line[] = "wearpipe-network 2", end_line[] = "end crc32 %08lx";
static const char *const activations[] = { "linear", "tanh", "sigmoid", "relu" };

/* Number from 1 to 2^20 at *s, which moves behind it; 0 if there is none. */
static int take_number(const char **s)
{
	char *end;
	long n;

	if (**s < '0' || **s > '9')
		return 0;
	errno = 0;
	n = strtol(*s, &end, 10);
	if (errno || n < 1 || n > 1 << 20)
		return 0;
	*s = end;
	return (int)n;
}

static enum num_status take_window(const char **s, struct network_layer *l)
{
	l->width = take_number(s);
	if (!l->width || (**s != 'x' && **s != '*'))
		return NUM_DOMAIN;
	++*s;
	l->height = take_number(s);
	return l->height > 0 ? NUM_OK : NUM_DOMAIN;
}

static enum num_status take_activation(const char *s, enum network_activation *activation)
{
	for (unsigned i = 0; i < sizeof activations / sizeof *activations; i++)
		if (strcmp(s, activations[i]) == 0) {
			*activation = (enum network_activation)i;
			return NUM_OK;
		}
	return NUM_DOMAIN;
}

static enum num_status parse_layer(const char *s, struct network_layer *l)
{
	if (strncmp(s, "pool", 4) == 0) {
		s += 4;
		l->kind = NETWORK_POOL;
		return take_window(&s, l) == NUM_OK && !*s ? NUM_OK : NUM_DOMAIN;
	}
	l->units = take_number(&s);
	if (!l->units)
		return NUM_DOMAIN;
	l->kind = NETWORK_DENSE;
	if (strncmp(s, "conv", 4) == 0) {
		s += 4;
		l->kind = NETWORK_CONV;
		l->stride = 1;
		if (take_window(&s, l) != NUM_OK)
			return NUM_DOMAIN;
		if (*s == '/') {
			s++;
			l->stride = take_number(&s);
		}
		if (!l->stride)
			return NUM_DOMAIN;
	} else if (*s == '+') {
		s++;
		l->kind = NETWORK_CASCADE;
	}
	if (!*s)
		return NUM_OK;
	return *s == ':' ? take_activation(s + 1, &l->activation) : NUM_DOMAIN;
}

enum num_status netfile_parse_layers(const char *text, enum network_activation activation,
	struct network_layer *layer, int *count, char why[NETFILE_TEXT])
{
	char word[48];
	size_t n;

	*count = 0;
	for (text += strspn(text, " \t\n"); *text;
		text += n + strspn(text + n, " \t\n")) {
		n = strcspn(text, " \t\n");
		snprintf(word, sizeof word, "%.*s", (int)n, text);
		if (*count == NETWORK_LAYERS_MAX) {
			snprintf(why, NETFILE_TEXT, "more than %d layers",
				NETWORK_LAYERS_MAX);
			return NUM_DOMAIN;
		}
		layer[*count] = (struct network_layer){ .activation = activation };
		if (n >= sizeof word || parse_layer(word, &layer[(*count)++]) != NUM_OK) {
			snprintf(why, NETFILE_TEXT,
				"'%s' is no layer: want like 50, 50+, 10conv30x2 or "
				"pool2x2",
				word);
			return NUM_DOMAIN;
		}
	}
	if (*count == 0)
		snprintf(why, NETFILE_TEXT, "no layers");
	return *count ? NUM_OK : NUM_DOMAIN;
}

static void write_layer(FILE *f, const struct network_layer *l)
{
	if (l->kind == NETWORK_POOL) {
		fprintf(f, " pool%dx%d", l->width, l->height);
		return;
	}
	fprintf(f, " %d", l->units);
	if (l->kind == NETWORK_CASCADE)
		putc('+', f);
	if (l->kind == NETWORK_CONV)
		fprintf(f, "conv%dx%d", l->width, l->height);
	if (l->kind == NETWORK_CONV && l->stride != 1)
		fprintf(f, "/%d", l->stride);
	fprintf(f, ":%s", activations[l->activation]);
}

static void write_text(FILE *f, struct network *net, const char *purpose, const char *cmd)
{
	struct network_shape in = network_input(net);
	const network_real *w = network_weights(net);
	size_t n = network_weight_count(net);

	fprintf(f, "%s\n", first_line);
	if (cmd)
		fprintf(f, "# cmd: %s\n", cmd);
	fprintf(f, "purpose %s\ninput %d %d %d\nlayers", purpose, in.channels, in.height,
		in.width);
	for (int i = 0; i < network_layers(net); i++)
		write_layer(f, network_layer(net, i));
	fprintf(f, "\nweights %zu\n", n);
	for (size_t i = 0; i < n; i++)
		fprintf(f, "%.9g%c", w[i], i % 8 == 7 || i == n - 1 ? '\n' : ' ');
}

enum num_status netfile_write(
	FILE *f, struct network *net, const char *purpose, const char *cmd)
{
	char *text = NULL;
	size_t n;
	FILE *memory = open_memstream(&text, &n);
	int whole = 0;

	if (memory) {
		write_text(memory, net, purpose, cmd);
		whole = !ferror(memory);
		whole &= !fclose(memory) && text; /* glibc returns 0 without memory */
	}
	if (whole) {
		fwrite(text, 1, n, f);
		fprintf(f, end_line, (unsigned long)crc32_add(0, text, n));
		putc('\n', f);
	}
	free(text);
	return whole ? NUM_OK : NUM_MEMORY;
}

struct reader {
	FILE *f;
	char *text;
	size_t size;
	struct netfile *file;
	char *why;
	uint32_t checksum, before; /* of the lines so far, and of those before the last */
};

/* The next line that is not a comment, without its newline; NULL with why at the end. */
static char *next_line(struct reader *r, const char *want)
{
	do {
		ssize_t n = getline(&r->text, &r->size, r->f);
		r->file->line++;
		if (n <= 0 || r->text[n - 1] != '\n') {
			snprintf(r->why, NETFILE_TEXT, "ends early: want %s", want);
			return NULL;
		}
		if (strlen(r->text) != (size_t)n) {
			snprintf(r->why, NETFILE_TEXT, "not text: want %s", want);
			return NULL;
		}
		r->before = r->checksum;
		r->checksum = crc32_add(r->checksum, r->text, (size_t)n);
		r->text[n - 1] = '\0';
		if (strncmp(r->text, "# cmd: ", 7) == 0) {
			free(r->file->cmd);
			r->file->cmd = strdup(r->text + 7);
			if (!r->file->cmd) {
				snprintf(r->why, NETFILE_TEXT, "out of memory");
				return NULL;
			}
		}
	} while (r->text[0] == '#');
	return r->text;
}

/* What follows the word that the next line must begin with. */
static char *next_value(struct reader *r, const char *word)
{
	char *s = next_line(r, word);
	size_t n = strlen(word);

	if (!s)
		return NULL;
	if (strncmp(s, word, n) != 0 || s[n] != ' ' || s[n + 1] == '\0') {
		snprintf(r->why, NETFILE_TEXT, "want '%s ...', got '%.40s'", word, s);
		return NULL;
	}
	return s + n + 1;
}

/* The last line, with the checksum of those before it. */
static enum num_status read_end(struct reader *r)
{
	const char *s = next_line(r, "'end'");
	char want[32];

	if (!s)
		return NUM_DOMAIN;
	snprintf(want, sizeof want, end_line, (unsigned long)r->before);
	if (strcmp(s, want) == 0)
		return NUM_OK;
	if (strncmp(s, "end", 3) == 0)
		snprintf(r->why, NETFILE_TEXT,
			"want '%s', got '%.40s': damaged or edited", want, s);
	else
		snprintf(r->why, NETFILE_TEXT,
			"want 'end' after the weights, got '%.40s'", s);
	return NUM_DOMAIN;
}

static enum num_status read_weights(struct reader *r, struct network *net)
{
	network_real *w = network_weights(net);
	size_t n = network_weight_count(net), i = 0;
	char *s = next_value(r, "weights"), *end;

	if (!s)
		return NUM_DOMAIN;
	if (strtoull(s, &end, 10) != n || *end) {
		snprintf(r->why, NETFILE_TEXT, "the layers have %zu weights, got '%.20s'",
			n, s);
		return NUM_DOMAIN;
	}
	while (i < n) {
		s = next_line(r, "weights");
		if (!s)
			return NUM_DOMAIN;
		for (; i < n && *(s += strspn(s, " \t")); s = end) {
			w[i++] = (network_real)strtod(s, &end);
			if (end == s || (*end && *end != ' ' && *end != '\t') ||
				!isfinite(w[i - 1])) {
				snprintf(r->why, NETFILE_TEXT,
					"weight %zu: want a finite number, got '%.20s'",
					i, s);
				return NUM_DOMAIN;
			}
		}
	}
	if (s[strspn(s, " \t")]) {
		snprintf(r->why, NETFILE_TEXT, "more than %zu weights", n);
		return NUM_DOMAIN;
	}
	return read_end(r);
}

static enum num_status read_input(const char *s, struct network_shape *shape)
{
	shape->channels = take_number(&s);
	if (!shape->channels || *s++ != ' ')
		return NUM_DOMAIN;
	shape->height = take_number(&s);
	if (!shape->height || *s++ != ' ')
		return NUM_DOMAIN;
	shape->width = take_number(&s);
	return shape->width && !*s ? NUM_OK : NUM_DOMAIN;
}

static struct network *read_network(struct reader *r, int batch)
{
	struct network_layer layer[NETWORK_LAYERS_MAX];
	struct network_shape input;
	struct network *net;
	char *s = next_line(r, first_line);
	int layers;

	if (!s)
		return NULL;
	if (strcmp(s, first_line) != 0) {
		snprintf(r->why, NETFILE_TEXT, "want '%s', got '%.40s'", first_line, s);
		return NULL;
	}
	s = next_value(r, "purpose");
	if (!s)
		return NULL;
	snprintf(r->file->purpose, NETFILE_TEXT, "%s", s);
	s = next_value(r, "input");
	if (!s)
		return NULL;
	if (read_input(s, &input) != NUM_OK) {
		snprintf(r->why, NETFILE_TEXT,
			"want 'input CHANNELS ROWS COLUMNS', got '%.40s'", s);
		return NULL;
	}
	s = next_value(r, "layers");
	if (!s ||
		netfile_parse_layers(s, NETWORK_LINEAR, layer, &layers, r->why) != NUM_OK)
		return NULL;
	net = network_new(input, layer, layers, batch);
	if (!net) {
		snprintf(r->why, NETFILE_TEXT, "cannot build the layers: %s",
			errno == EDOM ? "too large" : "out of memory");
		return NULL;
	}
	if (read_weights(r, net) != NUM_OK) {
		network_free(net);
		return NULL;
	}
	return net;
}

struct network *netfile_read(FILE *f, int batch, struct netfile *file)
{
	struct reader r = { .f = f, .file = file, .why = file->why };
	struct network *net;

	*file = (struct netfile){ .line = 0 };
	net = read_network(&r, batch);
	if (net && getc(f) != EOF) {
		snprintf(file->why, NETFILE_TEXT, "something follows 'end'");
		network_free(net);
		net = NULL;
	}
	if (!net) {
		free(file->cmd);
		file->cmd = NULL;
	}
	free(r.text);
	return net;
}
