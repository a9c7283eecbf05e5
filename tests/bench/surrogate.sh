#!/bin/sh
# debrisgen --surrogate against the full model: seconds, and what the estimate is off by.
#
# scene     cells and their size, surface and load; the surrogate is fitted to FITTED (24)
#           kinds of surfaces of examples/debris-surrogate, of 64 x 64 cells
# particles by the full model, and the share of the cells that fail
# full surrogate
#           processor seconds of debrisgen: medians of ROUNDS (3) runs in turn
# volume    estimate over that of the full model; within: whether its 90 % interval holds
. "$(dirname "$0")/setup"

sh "$top/examples/debris-surrogate/contacts" fit 64 0 "${FITTED:-24}" |
	debrisfit --yield 200MPa:800MPa --friction 0:0.6 --poisson 0.2:0.4 >surrogate.tsv

# wear WHAT PROGRAM OPTION ...: adds the seconds to seconds.WHAT
wear() {
	what=$1
	shift
	"$@" --summary "$what.tsv" --stats stats.tsv contact.nrrd >"particles.$what" 2>/dev/null || [ $? = 3 ]
	column cpu_seconds stats.tsv >>"seconds.$what"
}

median() {
	sort -g "seconds.$1" | awk '{ s[NR] = $1 } END { print (s[int((NR + 1) / 2)] + s[int(NR / 2) + 1]) / 2 }'
}

printf 'scene\tparticles\tfail\tfull\tsurrogate\tratio\tvolume\twithin\n'
while IFS='|' read -r surface load model; do
	rm -f seconds.*
	# shellcheck disable=SC2086 # words
	roughgen $surface --crown auto 2>/dev/null | bemcontact $load >contact.nrrd 2>/dev/null
	for _ in $(seq "${ROUNDS:-3}"); do
		# shellcheck disable=SC2086
		wear full debrisgen $model
		# shellcheck disable=SC2086
		wear quick debrisgen $model --surrogate surrogate.tsv --width 1000 --audit 0
	done
	points=${surface#-n } cells=$(column realisation full.tsv | awk -v n="${points%% *}" '{ s += n * n } END { print s }')
	failed=$(column columns particles.full | awk '{ s += $1 } END { print s }')
	for s in full quick; do
		grep -v '^#' $s.tsv >$s.rows
	done
	paste full.rows quick.rows | awk -F '\t' -v scene="$surface $load $model" -v cells="$cells" -v failed="$failed" \
		-v full="$(median full)" -v quick="$(median quick)" '
		!n { for (i = 1; i <= NF; i++) { if ($i == "volume") v[++m] = i; if ($i == "volume_low") low = i
			if ($i == "volume_high") high = i; if ($i == "particles" && !p) p = i } n = 1; next }
		{ k += $p; a += $v[1]; b += $v[2]; held += $low <= $v[1] && $v[1] <= $high; all++ }
		END { printf "%s\t%d\t%.2g\t%.3g\t%.3g\t%.1f\t%.4f\t%d/%d\n", scene, k, failed / cells, full, quick,
			full / quick, b / a, held, all }'
done <<END
-n 1536 -L 12mm -q 0.8um --acf exp -l 50um|--pressure 20MPa -E 210GPa|-Y 355MPa -u 0.3
-n 640 -L 2.56mm -q 0.3um -l 9um -c 3|--pressure 20MPa -E 210GPa|-Y 700MPa -u 0.3
-n 1024 -L 4mm -q 0.5um --hurst 0.3|--pressure 10MPa -E 400GPa|-Y 2GPa -u 0.2 --poisson 0.22
-n 512 -L 4mm -q 0.5um -l 50um -c 2|--pressure 20MPa -E 210GPa|-Y 355MPa -u 0.3
-n 256 -L 1mm -q 0.5um --acf exp -l 20um -c 6|--pressure 20MPa -E 210GPa|-Y 700MPa -u 0.4
-n 384 -L 1.5mm -q 0.3um -l 8um -c 4|--pressure 20MPa -E 210GPa|-Y 500MPa
-n 900 -L 4.5mm -q 0.6um --hurst 0.6|--pressure 20MPa -E 210GPa|-Y 355MPa -u 0.3 --shear y
-n 1024 -L 10mm -q 1um -l 120um|--pressure 20MPa -E 210GPa|-Y 355MPa -u 0.3
-n 768 -L 6mm -q 0.3um --acf exp -l 30um -c 2|--pressure 9MPa -E 105GPa|-Y 230MPa -u 0.5
-n 640 -L 3.2mm -q 0.3um -l 14um -c 2|--pressure 26MPa -E 105GPa|-Y 230MPa -u 0.5
-n 768 -L 6mm -q 1um --acf exp -l 30um -c 2|--pressure 50MPa -E 105GPa|-Y 230MPa -u 0.5
-n 640 -L 3.2mm -q 0.5um -l 14um -c 2|--pressure 90MPa -E 105GPa|-Y 230MPa -u 0.5
-n 640 -L 3.2mm -q 1um -l 14um -c 2|--pressure 150MPa -E 105GPa|-Y 230MPa -u 0.5
END
