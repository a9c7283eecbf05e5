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
done_testing
