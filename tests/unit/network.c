/* Networks: what each layer computes, training to known solutions, files of weights */
#include "net/netfile.h"
#include "net/training.h"
#include "num/philox.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

static double uniform(long i)
{
	return 2 * philox_uniform(11, 0, RNG_NETWORK, (uint64_t)i) - 1;
}

/* A convolution with stride written out as sums, against the network. */
static void check_convolution(void)
{
	enum { C = 2, H = 3, W = 11, F = 3, KX = 4, KY = 2, STEP = 3, OW = 4 };
	struct network_layer layer = { NETWORK_CONV, NETWORK_LINEAR, F, KX, KY, STEP };
	struct network *net =
		network_new((struct network_shape){ C, H, W }, &layer, 1, 2);
	network_real x[2 * C * H * W], *w = network_weights(net);
	const network_real *y;
	double worst = 0;

	network_start(net, 1, 0);
	for (size_t i = 0; i < network_weight_count(net); i++)
		w[i] += (network_real)(0.1 * uniform((long)i));
	for (int i = 0; i < 2 * C * H * W; i++)
		x[i] = (network_real)uniform(1000 + i);
	ok(network_outputs(net) == F * H * OW, "the convolution has %d outputs",
		F * H * OW);
	y = network_forward(net, x, 2);
	for (int o = 0; o < 2 * F * H * OW; o++) {
		int s = o / (F * H * OW), f = o / (H * OW) % F, r = o / OW % H,
		    c = o % OW * STEP;
		double sum = w[F * C * KY * KX + f];

		for (int k = 0; k < C * KY * KX; k++) {
			int ch = k / (KY * KX), j = r + k / KX % KY - (KY - 1) / 2;
			int i = c + k % KX - (KX - 1) / 2;

			if (j >= 0 && j < H && i >= 0 && i < W)
				sum += w[f * C * KY * KX + k] *
				       x[((s * C + ch) * H + j) * W + i];
		}
		worst = tap_max(worst, fabs(sum - y[o]));
	}
	ok(worst < 2e-6, "the convolution equals its sum, worst difference %.1g", worst);
	network_free(net);
}

static void check_pool(void)
{
	struct network_layer layer = { NETWORK_POOL, .width = 2, .height = 2 };
	struct network *net =
		network_new((struct network_shape){ 1, 2, 5 }, &layer, 1, 1);
	const network_real x[10] = { 1, 5, -3, -4, -7, 2, 0, -1, -9, -8 };
	const network_real *y = network_forward(net, x, 1);

	ok(network_outputs(net) == 3 && y[0] == 5 && y[1] == -1 && y[2] == -7,
		"pooling 2x2 of five columns gives 5 -1 -7, the last window being cut");
	network_free(net);
}

/* Two cascade layers and the formula of the cascade-forward network. */
static void check_cascade(void)
{
	struct network_layer layer[] = { { NETWORK_CASCADE, NETWORK_TANH, .units = 2 },
		{ NETWORK_CASCADE, NETWORK_TANH, .units = 1 },
		{ NETWORK_DENSE, NETWORK_LINEAR, .units = 1 } };
	struct network *net = network_new((struct network_shape){ 1, 1, 2 }, layer, 3, 1);
	network_real *w = network_weights(net), x[2] = { 0.3f, -0.8f };
	double a, b, c, want;

	for (size_t i = 0; i < network_weight_count(net); i++)
		w[i] = (network_real)uniform((long)i);
	a = tanh(x[0] * w[0] + x[1] * w[2] + w[4]);
	b = tanh(x[0] * w[1] + x[1] * w[3] + w[5]);
	c = tanh(x[0] * w[6] + x[1] * w[7] + a * w[8] + b * w[9] + w[10]);
	want = x[0] * w[11] + x[1] * w[12] + a * w[13] + b * w[14] + c * w[15] + w[16];
	near(network_forward(net, x, 1)[0], want, 1e-6,
		"the cascade-forward layers follow their formula");
	network_free(net);
}

/* y = 2 x0 - x1 + 0.5, which a linear layer can learn exactly. */
static void take_line(void *context, long i, network_real *x, network_real *target)
{
	(void)context;
	x[0] = (network_real)uniform(2 * i);
	x[1] = (network_real)uniform(2 * i + 1);
	target[0] = (network_real)(2 * x[0] - x[1] + 0.5);
}

static void check_training(void)
{
	static const char *const name[] = { "Adam", "gradient descent" };
	struct network_layer layer = { NETWORK_DENSE, NETWORK_LINEAR, .units = 1 };
	struct network_training par = {
		.epochs = 200, .samples = 64, .batch = 16, .loss = network_mse, .seed = 5
	};
	network_real again[3];

	for (int k = 0; k < 2; k++) {
		struct network *net =
			network_new((struct network_shape){ 1, 1, 2 }, &layer, 1, 16);
		network_real *w = network_weights(net);
		double error;

		par.optimiser = k ? NETWORK_DESCENT : NETWORK_ADAM;
		par.rate = k ? 0.2 : 0.05;
		for (int run = 0; run < 2; run++) {
			network_start(net, 5, 0);
			ok(network_train(net, &par, take_line, NULL) == NETWORK_OK,
				"%s: the training succeeds", name[k]);
			if (run == 0)
				memcpy(again, w, sizeof again);
		}
		error = fabs(w[0] - 2) + fabs(w[1] + 1) + fabs(w[2] - 0.5);
		ok(error < 2e-5, "%s finds the line, error %.1g", name[k], error);
		ok(memcmp(again, w, sizeof again) == 0,
			"%s: a second training gives the same bytes", name[k]);
		network_start(net, 5, 0);
		memcpy(again, w, sizeof again);
		network_start(net, 5, 1);
		ok(memcmp(again, w, sizeof again) != 0,
			"another repetition gives other weights");
		network_free(net);
	}
}

/* The first step of Adam is rate * sign(gradient), whatever the gradient's size. */
static void check_adam_step(void)
{
	struct network_layer layer = { NETWORK_DENSE, NETWORK_LINEAR, .units = 1 };
	struct network_training par = {
		.epochs = 1, .samples = 8, .batch = 8, .loss = network_mse, .rate = 1e-3
	};
	struct network *net =
		network_new((struct network_shape){ 1, 1, 2 }, &layer, 1, 8);
	network_real *w = network_weights(net);

	network_train(net, &par, take_line, NULL);
	near(w[0], 1e-3, 1e-8, "the first step of Adam upwards is the learning rate");
	near(w[1], -1e-3, 1e-8, "the first step of Adam downwards is the learning rate");
	network_free(net);
}

static void check_divergence(void)
{
	struct network_layer layer = { NETWORK_DENSE, NETWORK_LINEAR, .units = 1 };
	struct network_training par = { .optimiser = NETWORK_DESCENT,
		.epochs = 2000,
		.samples = 8,
		.batch = 8,
		.loss = network_mse,
		.rate = 50 };
	struct network *net =
		network_new((struct network_shape){ 1, 1, 2 }, &layer, 1, 8);

	ok(network_train(net, &par, take_line, NULL) == NETWORK_DIVERGED,
		"a step that is too long is reported as divergence");
	network_free(net);
}

/* Eight numbers made from two: an auto-encoder of two units can represent them. */
static void take_plane(void *context, long i, network_real *x, network_real *target)
{
	(void)context;
	for (int k = 0; k < 8; k++)
		x[k] = (network_real)(0.3 * (uniform(2 * i) * cos(k) +
						    uniform(2 * i + 1) * sin(k)));
	target[0] = 0;
}

static double last_loss;

static void keep_loss(void *context, long epoch, double loss)
{
	(void)context;
	(void)epoch;
	last_loss = loss;
}

/* Without sparsity the plane is reconstructed; with it the mean activation stays near the
 * wanted level, but still varies with the samples. */
static void check_pretraining(void)
{
	struct network_layer layer[] = { { NETWORK_DENSE, NETWORK_SIGMOID, .units = 6 },
		{ NETWORK_DENSE, NETWORK_LINEAR, .units = 1 } };
	struct network *net =
		network_new((struct network_shape){ 1, 1, 8 }, layer, 2, 100);
	struct network_training par = { .epochs = 600,
		.samples = 100,
		.batch = 100,
		.rate = 0.02,
		.loss = network_mse,
		.report = keep_loss };
	network_real *w = network_weights(net), x[8], t[1], last = w[6 * 9];

	for (int sparse = 0; sparse < 2; sparse++) {
		double mean = 0, square = 0;

		par.penalty = (struct network_penalty){ 0, 0, sparse ? 4 : 0, 0.05 };
		ok(network_pretrain(net, 0, &par, take_plane, NULL) == NETWORK_OK,
			"the pre-training succeeds");
		for (long i = 0; i < 100; i++) {
			take_plane(NULL, i, x, t);
			network_forward(net, x, 1);
			for (int u = 0; u < 6; u++) {
				double a = network_activations(net, 0)[u];

				mean += a / 600;
				square += a * a / 600;
			}
		}
		if (sparse)
			ok(fabs(mean - 0.05) < 0.02 && square - mean * mean > 1e-5,
				"sparse pre-training: the mean activation %.3f is near 0.05, deviation %.2g",
				mean, sqrt(square - mean * mean));
		else
			ok(mean > 0.1 && last_loss < 0.03 / 50,
				"plain pre-training: the mean activation is %.3f and %.2g of 0.03 is not reconstructed",
				mean, last_loss);
	}
	ok(w[6 * 9] == last, "pre-training does not change the layers behind");
	network_free(net);
}

static struct network *round_trip(
	struct network *net, char *text, size_t size, struct netfile *file)
{
	FILE *f = fmemopen(text, size, "w");
	struct network *back;

	netfile_write(f, net, "the delays are read back", "make it");
	fclose(f);
	f = fmemopen(text, strlen(text), "r");
	back = netfile_read(f, 1, file);
	fclose(f);
	return back;
}

static void check_file(void)
{
	static const char *const layers = "3conv4x2/2:relu pool2x1 5+:tanh 4:sigmoid 2";
	struct network_layer layer[NETWORK_LAYERS_MAX];
	char why[NETFILE_TEXT], text[8192] = "", copy[8192] = "";
	int n;
	enum num_status status =
		netfile_parse_layers(layers, NETWORK_LINEAR, layer, &n, why);
	struct network *net = network_new((struct network_shape){ 1, 2, 9 }, layer, n, 1),
		       *back;
	struct netfile file;
	size_t bytes = network_weight_count(net) * sizeof(network_real);

	ok(status == NUM_OK && n == 5, "the network has five layers");
	network_start(net, 1, 0);
	network_weights(net)[0] = 1.17549435e-38F;
	back = round_trip(net, text, sizeof text, &file);
	if (ok(back != NULL, "a file is read back")) {
		ok(memcmp(network_weights(net), network_weights(back), bytes) == 0,
			"the weights are read back bit by bit");
		ok(strcmp(file.purpose, "the delays are read back") == 0 &&
				strcmp(file.cmd, "make it") == 0,
			"purpose and command are read back");
		free(file.cmd);
		network_free(back);
		back = round_trip(net, copy, sizeof copy, &file);
		ok(strcmp(text, copy) == 0,
			"the network is written again as the same bytes");
		free(file.cmd);
		network_free(back);
	}
	n = 0;
	for (size_t cut = 1; cut < strlen(text); cut++) {
		FILE *f = fmemopen(text, cut, "r");

		back = netfile_read(f, 1, &file);
		n += back != NULL;
		network_free(back);
		fclose(f);
	}
	ok(n == 0, "every truncation of the file is refused");
	for (size_t i = 0; i < strlen(text); i++)
		for (const char *c = "9-x \n#\177"; *c; c++) {
			FILE *f;

			if (text[i] == *c)
				continue;
			strcpy(copy, text);
			copy[i] = *c;
			f = fmemopen(copy, strlen(copy), "r");
			back = netfile_read(f, 1, &file);
			n += back != NULL;
			network_free(back);
			fclose(f);
		}
	ok(n == 0, "a file with any byte changed is refused");
	network_free(net);
}

static void check_refusals(void)
{
	static const char *const bad[] = { "", "x", "0", "10conv", "10conv3", "10conv3x",
		"pool2", "5:cosh", "-3", "5conv2x2/0", "2000000", "3 4 pool2x0",
		"1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1" };
	struct network_layer layer[NETWORK_LAYERS_MAX], huge = { .units = 1 << 20 };
	struct network_layer wide = {
		.kind = NETWORK_CONV, .units = 1, .width = 4096, .height = 4096
	};
	char why[NETFILE_TEXT];
	int n;

	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		*why = '\0';
		ok(netfile_parse_layers(bad[i], NETWORK_TANH, layer, &n, why) ==
					NUM_DOMAIN &&
				*why,
			"the layers '%.20s' are refused: %s", bad[i], why);
	}
	ok(!network_new((struct network_shape){ 1, 2, 500 }, &huge, 1, 1),
		"a network with too many weights is refused");
	ok(!network_new((struct network_shape){ 1, 0, 500 }, &huge, 1, 1),
		"an input without rows is refused");
	ok(!network_new((struct network_shape){ 1 << 20, 1, 1 }, &wide, 1, 1),
		"a window of more values than an int counts is refused");
	wide.width = wide.height = 1000;
	ok(!network_new((struct network_shape){ 1, 4000, 4000 }, &wide, 1, 1),
		"layers that together are too large are refused");
}

int main(void)
{
	check_convolution();
	check_pool();
	check_cascade();
	check_training();
	check_adam_step();
	check_divergence();
	check_pretraining();
	check_file();
	check_refusals();
	return tap_done();
}
