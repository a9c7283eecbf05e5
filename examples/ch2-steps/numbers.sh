#!/bin/sh
# numbers.sh - what the thesis says of this scene beside what came out
#
# Reads column-steps.tsv, potential-steps.tsv and column-work.tsv; writes a table.
set -eu

# value FILE COLUMN STEP; STEP max, mean: over all steps
value() {
	awk -F '\t' -v c="$2" -v step="$3" '
	/^#/ { next }
	!k { for (i = 1; i <= NF; i++) { if ($i == c) k = i; if ($i == "step") s = i }; next }
	step == "max" { if (v == "" || $k > v) v = $k; next }
	step == "mean" { sum += $k; v = sum / ++n; next }
	!s || $s == step { v = $k }
	END { print v == "" ? "nan" : v }' "$1"
}

# row WHERE QUANTITY UNIT SCALE THESIS COLUMN-RULE WHOLE-SET REMARK
row() {
	printf '%s\t%s\t%s\t%s\t%s\t%s\t%s\n' "$1" "$2" "$3" "$5" \
		"$(echo "$6 $4" | awk '{ printf $1 == "-" ? "-" : "%.4g", $1 * $2 }')" \
		"$(echo "$7 $4" | awk '{ printf $1 == "-" ? "-" : "%.4g", $1 * $2 }')" "$8"
}
c=column-steps.tsv
p=potential-steps.tsv

printf 'where\tquantity\tunit\tthesis\tcolumn rule (2-12)\twhole set (2-11)\tremark\n'
row 2.2.1 "smallest particle" um 1e6 10.8 9.693e-6 9.693e-6 \
	"(2-13) as printed is an area; the root of it is a square root"
row "fig 8" "cells in contact, step 1" % 100 - "$(value $c contact_fraction 1)" - \
	"falls as the slope 2 Sq / corr grows"
row "fig 8" "largest pressure, step 1" GPa 1e-9 - "$(value $c max_pressure 1)" - \
	"elastic: the mean is 0.35 E* times the slope; yield is 0.355"
row "fig 9" "largest von Mises stress, step 1" GPa 1e-9 - "$(value $c max_stress 1)" - \
	"(2-9), (2-10) as corrected"
row "fig 12 a" "largest particle, step 1" um 1e6 307 "$(value $c max_diameter 1)" \
	"$(value $p max_diameter 1)" "a point load of 50 N gives 307.0 for the whole set"
row "fig 12 i" "mean diameter, step 9" um 1e6 93 "$(value $c mean_diameter 9)" \
	"$(value $p mean_diameter 9)" "eight seeds: 67 to 114 by the column rule"
row "fig 11" "relative roughness, step 10" 1 1 1.0015 "$(value $c relative_roughness 10)" \
	"$(value $p relative_roughness 10)" "pits roughen a surface; 1.0015 is above 1 and yet said to decrease"
row "fig 13" "mean volume of a step" m3 1 2.135e-10 "$(value $c volume mean)" \
	"$(value $p volume mean)" "a point load fails 1.51e-11 at most: the print is 14 times that"
row 2.2.1 "largest contact, all steps" % 100 80 "$(value $c contact_fraction max)" \
	"$(value $p contact_fraction max)" "the stop at 80 % is never near: mean pressure there is 62 MPa"
row 2.2.1 "load on the rim, largest" % 100 - "$(value $c edge_load max)" \
	"$(value $p edge_load max)" "above 5 % the half-space ends too early"
row 2.1.3 "nodes left out" % 100 "50-70" "$(awk -F '\t' '
	NR == 1 { for (i = 1; i <= NF; i++) k[$i] = i }
	NR == 2 { print $k["nodes_skipped"] / ($k["nodes"] + $k["nodes_skipped"]) }' column-work.tsv)" \
	- "of all nodes down to the last layer searched"
