#include "contact/kernel.h"
#include <math.h>
#include <stddef.h>

/* Nodes and weights on [-1/2, 1/2], the positive half; an odd rule starts with 0. */
struct gauss {
	int n;
	double node[3], weight[3];
};

static const struct gauss gauss3 = { 2, { 0, 0.38729833462074168852 },
	{ 0.44444444444444444444, 0.27777777777777777778 } };
static const struct gauss gauss4 = { 2,
	{ 0.16999052179242813253, 0.43056815579702628761 },
	{ 0.32607257743127307131, 0.17392742256872692869 } };
static const struct gauss gauss5 = { 3,
	{ 0, 0.26923465505284154552, 0.45308992296933199640 },
	{ 0.28444444444444444444, 0.23931433524968323402, 0.11846344252809454376 } };

/* Integral of 1/r by a product rule.  Both signs of every node are visited; node 0
 * carries half its weight twice. */
static double patch_far(const struct gauss *g, double dx, double dy, double x, double y)
{
	double sum = 0;

	for (int i = 0; i < g->n; i++) {
		double wx = g->node[i] == 0 ? g->weight[i] / 2 : g->weight[i];
		double x1 = x - dx * g->node[i], x2 = x + dx * g->node[i], line = 0;

		for (int j = 0; j < g->n; j++) {
			double w = g->node[j] == 0 ? g->weight[j] / 2 : g->weight[j];
			double y1 = y - dy * g->node[j], y2 = y + dy * g->node[j];

			line += w * (1 / sqrt(x1 * x1 + y1 * y1) +
					    1 / sqrt(x1 * x1 + y2 * y2) +
					    1 / sqrt(x2 * x2 + y1 * y1) +
					    1 / sqrt(x2 * x2 + y2 * y2));
		}
		sum += wx * line;
	}
	return dx * dy * sum;
}

/* Corner function x asinh(y/|x|) + y asinh(x/|y|).  The usual x ln(y + r) + y ln(x + r)
 * loses up to four digits more along the axes. */
static double corner(double x, double y)
{
	double f = 0;

	if (x != 0)
		f += x * asinh(y / fabs(x));
	if (y != 0)
		f += y * asinh(x / fabs(y));
	return f;
}

static double patch_near(double dx, double dy, double x, double y)
{
	double x1 = x - dx / 2, x2 = x + dx / 2, y1 = y - dy / 2, y2 = y + dy / 2;

	return corner(x2, y2) - corner(x2, y1) - corner(x1, y2) + corner(x1, y1);
}

/* The four corners cancel more and more with distance, while from 8 cells on a Gauss
 * rule is exact to rounding; the farther, the fewer points it needs.  In between, and
 * where a long cell is far only in units of its short side, the cell is halved. */
double kernel_patch(double dx, double dy, double x, double y)
{
	double side = dx > dy ? dx : dy, r = hypot(x, y) / side;

	if (r > 130)
		return patch_far(&gauss3, dx, dy, x, y);
	if (r > 32)
		return patch_far(&gauss4, dx, dy, x, y);
	if (r > 8)
		return patch_far(&gauss5, dx, dy, x, y);
	if (r <= 2 && dx <= 2 * dy && dy <= 2 * dx)
		return patch_near(dx, dy, x, y);
	if (dx > dy)
		return kernel_patch(dx / 2, dy, x - dx / 4, y) +
		       kernel_patch(dx / 2, dy, x + dx / 4, y);
	return kernel_patch(dx, dy / 2, x, y - dy / 4) +
	       kernel_patch(dx, dy / 2, x, y + dy / 4);
}

static double corner_along(double x, double y)
{
	return y != 0 ? y * asinh(x / fabs(y)) : 0;
}

double kernel_patch_along(double dx, double dy, double x, double y)
{
	double x1 = x - dx / 2, x2 = x + dx / 2, y1 = y - dy / 2, y2 = y + dy / 2;

	return corner_along(x2, y2) - corner_along(x2, y1) - corner_along(x1, y2) +
	       corner_along(x1, y1);
}

double kernel_modulus(double e1, double nu1, double e2, double nu2)
{
	return 1 / ((1 - nu1 * nu1) / e1 + (1 - nu2 * nu2) / e2);
}

static double halfspace_patch(
	const void *context, double dx, double dy, double x, double y)
{
	return kernel_patch(dx, dy, x, y) / (M_PI * *(const double *)context);
}

static double halfspace_wave(const void *context, double q)
{
	return 2 / (*(const double *)context * q);
}

struct contact_kernel kernel_halfspace(const double *estar)
{
	return (struct contact_kernel){ estar, halfspace_patch, halfspace_wave };
}

static double coated_wave(const void *context, double q)
{
	const struct kernel_coating *c = context;
	double nu = c->poisson, base = c->base_poisson, depth = q * c->thickness;
	double shear = c->young / (2 * (1 + nu));
	double ratio = shear / (c->base_young / (2 * (1 + base)));
	double lambda = 1 - 4 * (1 - nu) / (1 + ratio * (3 - 4 * base));
	double kappa = (ratio - 1) / (ratio + 3 - 4 * nu), theta = exp(-2 * depth);
	double above = 1 + 4 * depth * kappa * theta - lambda * kappa * theta * theta;
	double below = 1 - (lambda + kappa + 4 * kappa * depth * depth) * theta +
		       lambda * kappa * theta * theta;

	return ((1 - nu) / shear * above / below + 2 * c->other) / q;
}

struct contact_kernel kernel_coated(const struct kernel_coating *coating)
{
	return (struct contact_kernel){ coating, NULL, coated_wave };
}
