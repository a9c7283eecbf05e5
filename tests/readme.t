#!/bin/sh
# The pipeline of the README runs as printed and predicts the right life
. "$(dirname "$0")/tap.sh"

sed -n '/^```sh$/,/^```$/p' "$top/README.md" | sed '/^```/d' >pipeline.sh
ok 'the pipeline of the README runs' sh -e pipeline.sh
# Of some 900 particles about one pair arrives within 0.3 ms, and is fitted as one.
is 'the pipeline of the README warns of rows that may be pairs alone' \
	"$(sed '/^duet: signal.au: [1-5] of 90[0-9] rows may be two particles/d
	/^wear-volume: [1-5] row.* doubtful/d' err)" ''
worn=$(column volume particles.tsv | awk '{ s += $1 } END { print s }')
is 'each hour but the last has a row' "$(column t life.tsv | wc -l)" 59
# Each particle found is known to 1e-4 of its diameter; a small one hides in a large one.
for t in found truth; do
	wear-volume $t.tsv >$t.volume
done
near 'the detected volume is the worn volume' "$(paste found.volume truth.volume |
	awk '/^[0-9]/ { r = $2 / $4 } END { print r }')" 1 0.01
is 'quantiles of remaining life are positive and ascending' \
	"$(awk -F '\t' '/^#/ { next } !n { for (i = 1; i <= NF; i++) c[$i] = i; n = 1; next }
	{ low = $c["q05"]; median = $c["q50"]; high = $c["q95"]; rows++
	if (low median high ~ /nan|inf/ || !(low + 0 > 0 && low + 0 <= median + 0 && median + 0 <= high + 0)) bad++ }
	END { print rows, bad + 0 }' life.tsv)" '59 0'
# 0.2 mm3 at the mean rate of 60 h, less the 59 h that passed
left=$(awk -v w="$worn" 'BEGIN { print 216000 * 2e-10 / w - 212400 }')
rising 'the last interval contains the true remaining life' "$(column q05 life.tsv | tail -1)" \
	"$left" "$(column q95 life.tsv | tail -1)"
done_testing
