#!/bin/sh
# figures.sh - the fields of the steps as matrices of text, for plot.gp
set -eu
records --field height --output text contact.0.nrrd >before.txt
records --field pressure --output text contact.0.nrrd >pressure.txt
# The layer at depth 0; the text has the layers one below the other.
records --field von_mises --output text stress.nrrd | head -n 129 >mises.txt
last=before.txt
for step in 1 2 3 4 5 6 7 8 9; do
	records --pick $step --field height --output text worn.0.nrrd >worn$step.txt
	# What this step took away: the depth of the removed part.
	awk 'NR == FNR { row[FNR] = $0; next }
		/^#/ || !NF { print; next }
		{ n = split(row[FNR], h, "\t")
		  for (i = 1; i <= n; i++) printf "%g%s", h[i] - $i, i < n ? "\t" : "\n" }' \
		$last worn$step.txt >removed$step.txt
	last=worn$step.txt
done
