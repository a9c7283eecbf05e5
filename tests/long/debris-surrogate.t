#!/bin/sh
# The example of the surrogate runs, and its estimates are those of the full model
. "$(dirname "$0")/../tap.sh"

ok "the example runs" make -s -C "$top/examples/debris-surrogate" table OUT="$work/surrogate" TRIED=4
numbers=$work/surrogate/numbers
number() { sed -n "s/^$1: //p" "$numbers"; }
is "it has estimated surfaces that were not fitted" "$(awk -v n="$(number 'surfaces estimated')" 'BEGIN { print (n > 0) }')" 1
# 1.01 on the ten surfaces; a third is far outside the rms error of one surface, a tenth
near "the volume of all is that of the full model" "$(number 'volume over that of the full model')" 1 0.35
is "most intervals hold the full model" "$(awk -v v="$(number 'intervals of 90 % that hold')" 'BEGIN { print (v >= 0.5) }')" 1
# Large regions, of which a few cells in a hundred are measured: 1.004; 1.023 with weights
# that favour the inside, and four surfaces scatter by 0.005.
sh "$top/examples/debris-surrogate/contacts" fit 64 0 24 |
	debrisfit --yield 200MPa:800MPa --friction 0:0.6 --poisson 0.2:0.4 >fit.tsv 2>err
roughgen -n 512 -L 4mm -q 0.5um -l 50um -c 4 --seed 77 --crown auto 2>err | bemcontact --pressure 20MPa -E 210GPa >large.nrrd 2>err
volume() {
	debrisgen -Y 355MPa -u 0.3 "$@" --summary s.tsv large.nrrd >out 2>err
	column volume s.tsv | awk '{ v += $1 } END { printf "%.9g", v * 1e12 }'
}
near "the volume of large regions has no bias" "$(awk -v a="$(volume --surrogate fit.tsv --width 1000 --audit 0)" \
	-v b="$(volume)" 'BEGIN { print a / b }')" 1 0.015
done_testing
