#!/bin/sh
# The pipeline of the README runs as printed, with fewer surfaces
. "$(dirname "$0")/tap.sh"

sed -n '/^```sh$/,/^```$/p' "$top/README.md" | sed -e '/^```/d' -e 's/-c 100/-c 3/' \
	-e 's/-T 10/-T 3/' -e "s#scripts/#$top/scripts/#" >pipeline.sh
ok 'the pipeline of the README' sh -e pipeline.sh
is 'found particles' "$(awk '!/^#/ && n++ { f = 1 } END { print f + 0 }' found.tsv)" 1
is 'and ends in quantiles of remaining life that are in order' \
	"$(awk -F '\t' '/^#/ { next } !n { for (i = 1; i <= NF; i++) c[$i] = i; n = 1; next }
	{ rows++; if (!($c["q05"] <= $c["q50"] && $c["q50"] <= $c["q95"])) bad++ }
	END { print (rows > 10), bad + 0 }' life.tsv)" '1 0'
done_testing
