/* leakage - eq 4-30, its inverse, and the figures of the thesis' pump */
#include "life/pair/pair.h"
#include "tap.h"

int main(void)
{
	struct leakage pump = leakage_thesis(), whole = pump, thin = pump;
	double q = 2.8e-3 / 60;
	double r = 0.05, width = 1e-5, slot;

	/* The angle has six figures, hence 5e-6 / 2.6 / 3 of 16.79 um. */
	near(leakage_gap(&pump, q), 16.79e-6, 1.1e-11,
		"a leakage of 2.8 L/min belongs to a gap of 16.79 um");
	whole.ratio = 1;
	whole.alpha0 = 3.71008;
	near(leakage_gap(&whole, q), 16.79e-6, 5e-12,
		"without the 70 % rule that gap takes an angle of 3.71008 rad");
	for (double h = 1e-9; h < 1e-2; h *= 7)
		near(leakage_gap(&pump, leakage_flow(&pump, h)) / h, 1, 4e-16,
			"flow of the gap and gap of the flow are inverse functions");
	near(leakage_flow(&pump, 2e-6) / leakage_flow(&pump, 1e-6), 8, 1e-14,
		"the flow grows with the cube of the gap");
	near(leakage_flow(&pump, -1e-6), -leakage_flow(&pump, 1e-6), 0,
		"the flow is odd in the gap");
	/* A thin land is a plane slot: Q = b h^3 dP / (12 mu L) with b = alpha0 r. */
	thin.radius[0] = thin.radius[2] = r;
	thin.radius[1] = thin.radius[3] = r + width;
	thin.ratio = 1;
	slot = 2 * thin.alpha0 * (r + width / 2) * 1e-18 * thin.drop /
	       (12 * thin.viscosity * width);
	near(leakage_flow(&thin, 1e-6) / slot, 1, 1e-8,
		"thin lands leak like plane slots");
	ok(leakage_check(&pump) == NULL,
		"the dimensions of the pump of the thesis are accepted");
	thin.radius[3] = thin.radius[2];
	ok(leakage_check(&thin) != NULL, "a land without width is refused");
	pump.ratio = 1.5;
	ok(leakage_check(&pump) != NULL, "a ratio above one is refused");
	return tap_done();
}
