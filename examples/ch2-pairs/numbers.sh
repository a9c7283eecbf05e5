#!/bin/sh
# numbers.sh - statistics of the ensemble, the thesis' numbers beside ours
#
# Reads 50N.tsv, 100N.tsv and the summaries 50N.steps, 100N.steps; writes a table, and
# for plot.gp the statistics of each load as files of their own.
set -eu

# Mean and standard deviation over the pairs of a column of a summary, step by step.
by_step() {
	awk -F '\t' -v c="$2" '
	/^#/ { next }
	$1 == "realisation" { for (i = 1; i <= NF; i++) { if ($i == c) k = i; if ($i == "step") s = i }; next }
	{ n[$s]++; a[$s] += $k; b[$s] += $k * $k; if ($s > last) last = $s }
	END {
		print "step\tmean\tsd"
		for (i = 1; i <= last; i++) {
			m = a[i] / n[i]; v = b[i] / n[i] - m * m
			sd = v > 0 && n[i] > 1 ? sqrt(v * n[i] / (n[i] - 1)) : 0
			printf "%d\t%.6g\t%.6g\n", i, m, sd
		}
	}' "$1"
}

for load in 50N 100N; do
	by_step $load.steps contact_fraction >$load.contact
	debrisstat --output steps --summary $load.steps $load.tsv >$load.bystep
	debrisstat --output fits --summary $load.steps --diameter 0:500um $load.tsv >$load.fits
	debrisstat --output fits --summary $load.steps --growth step $load.tsv >$load.perstep
	debrisstat --output sizes --diameter 0:500um $load.tsv >$load.sizes
done
for step in 2 3 4 5 6 7 8 9; do
	debrisstat --output sizes --step $step --diameter 0:500um 50N.tsv >sizes.$step
	debrisstat --output aspects --aspects 1,1.2,1.4,1.6,1.8,2,3,5,13 --step $step 50N.tsv >aspects.$step
done

# fit FILE QUANTITY
fit() {
	awk -F '\t' -v q="$2" '$1 == q { print $2 }' "$1"
}

# at FILE COLUMN STEP
at() {
	awk -F '\t' -v c="$2" -v step="$3" '/^#/ { next }
	!k { for (i = 1; i <= NF; i++) if ($i == c) k = i; next }
	$1 == step { print $k }' "$1"
}

# Share of the steps that carry more than 5 % of the load on the outermost cells.
on_rim() {
	awk -F '\t' '/^#/ { next }
	$1 == "realisation" { for (i = 1; i <= NF; i++) if ($i == "edge_load") k = i; next }
	{ n++; if ($k > 0.05) m++ }
	END { print m / n }' "$1.steps"
}

# row WHERE QUANTITY UNIT SCALE THESIS 50N 100N REMARK
row() {
	printf '%s\t%s\t%s\t%s\t%s\t%s\t%s\n' "$1" "$2" "$3" "$5" \
		"$(echo "$6 $4" | awk '{ printf $1 == "-" ? "-" : "%.4g", $1 * $2 }')" \
		"$(echo "$7 $4" | awk '{ printf $1 == "-" ? "-" : "%.4g", $1 * $2 }')" "$8"
}

last=$(grep -v '^#' 50N.contact | tail -n 1 | cut -f 1)
v50=$(fit 50N.fits volume_per_step)
v100=$(fit 100N.fits volume_per_step)

printf 'where\tquantity\tunit\tthesis\t50 N\t100 N\tremark\n'
row "fig 13" "mean volume of a step" m3 1 "2.135e-10, 3.611e-10" "$v50" "$v100" \
	"a point load fails 1.51e-11 and 4.29e-11 at most; the print is 14 and 8 times that"
row "fig 13" "the same, 100 N over 50 N" 1 1 1.69 - "$(echo "$v100 $v50" | awk '{ print $1 / $2 }')" \
	"one contact under a point load: 2^1.5 = 2.83"
row "fig 14" "cells in contact, step 1" % 100 - "$(at 50N.contact mean 1)" \
	"$(at 100N.contact mean 1)" "the thesis gives no number"
row "fig 14" "cells in contact, step $last" % 100 - "$(at 50N.contact mean "$last")" \
	"$(at 100N.contact mean "$last")" "never near the 80 % that would stop it"
row 2.2.1 "steps with over 5 % of the load on the rim" % 100 - "$(on_rim 50N)" "$(on_rim 100N)" \
	"there the half-space ends too early"
row "fig 16" "exponent of the cumulative count" 1 1 1.383 "$(fit 50N.fits power_exponent)" \
	"$(fit 100N.fits power_exponent)" "(2-16) a x^b + c"
row "fig 16" "exponent of the count of a step" 1 1 1.383 "$(fit 50N.perstep power_exponent)" \
	"$(fit 100N.perstep power_exponent)" "the same of each step alone"
row "fig 16" "particles of 100 pairs, step $last" 1 100 \
	"$(echo "$last" | awk '{ printf "%.4g", 41.29 * $1 ^ 1.383 - 70.29 }')" \
	"$(at 50N.bystep particles "$last")" "$(at 100N.bystep particles "$last")" \
	"(2-16) agrees if it counts one step of all pairs; negative below x = 1.47"
row "fig 17" "Weibull shape" 1 1 2.718 "$(fit 50N.fits weibull_shape)" \
	"$(fit 100N.fits weibull_shape)" "(2-17)"
row "fig 17" "Weibull scale" um 1e6 200.7 "$(fit 50N.fits weibull_scale)" \
	"$(fit 100N.fits weibull_scale)" "diameters go with sqrt(F / yield)"
row "fig 17" "mean diameter of the fit" um 1e6 178.5 "$(fit 50N.fits weibull_mean)" \
	"$(fit 100N.fits weibull_mean)" "RULE=potential gives 164 at 50 N"
row "fig 18" "fullest class, step 9" um 1e6 "about 120" \
	"$(grep -v '^#' sizes.9 | sort -t '	' -k 3,3gr | sed -n 1p | cut -f 1)" - "lower edge, classes of 10 um"
row "fig 19" "aspect ratio below 1.4, step 2" % 100 "53 (lowest class)" \
	"$(awk -F '\t' '$1 + 0 >= 1 && $2 + 0 <= 1.4 { s += $4 } END { print s + 0 }' aspects.2)" - \
	"the thesis does not say where its classes end"
row "fig 19" "aspect ratio above 13" % 100 0.3 \
	"$(debrisstat --output aspects --aspects 1,13 50N.tsv | awk -F '\t' '$1 == 13 { print $4 }')" - \
	"length over largest chord across it: flat particles count as round"
