#!/bin/sh
# The experiments of chapter 2, small: they run, and what they print obeys the limits
# that a point load of the same force sets
. "$(dirname "$0")/../tap.sh"
bin=${BIN:-$top/bin}

# cell WHERE-AND-QUANTITY COLUMN: of numbers.tsv
cell() {
	awk -F '\t' -v key="$1" -v c="$2" '$1 " " $2 == key { print $c }' numbers.tsv
}

ok "ch2-steps runs" make -s -C "$top/examples/ch2-steps" BIN="$bin" OUT="$work" SEED=2 STEPS=3 \
	table
# The cells that a point load of 50 N fails have the volume of a ball of 307.0 um; a
# single spot of contact comes near it, several stay below: 320 um with the grid's grain.
ok "whole set, step 1: a particle of 250 to 320 um" awk -v d="$(cell 'fig 12 a largest particle, step 1' 6)" \
	'BEGIN { exit !(d > 250 && d < 320) }'
ok "columns lose less than the whole set" awk -v c="$(cell 'fig 13 mean volume of a step' 5)" \
	-v w="$(cell 'fig 13 mean volume of a step' 6)" 'BEGIN { exit !(c > 0 && c < w && w < 1.6e-11) }'

rm -f ./*
ok "ch2-pairs runs" make -s -C "$top/examples/ch2-pairs" BIN="$bin" OUT="$work" PAIRS=4 BLOCK=2 \
	STEPS=9 table
v50=$(cell 'fig 13 mean volume of a step' 5)
v100=$(cell 'fig 13 mean volume of a step' 6)
# 1.515e-11 m3 at 50 N, 2^1.5 times that at 100 N; more contacts only make it less.
ok "volumes below a point load's" awk -v a="$v50" -v b="$v100" \
	'BEGIN { exit !(a > 1e-12 && a < 1.515e-11 && b < 4.286e-11) }'
ok "twice the load wears 2 to 2^1.5 times as much" awk -v a="$v50" -v b="$v100" \
	'BEGIN { exit !(b / a > 1.9 && b / a < 3) }'
roughgen -n 128 -L 1mm -q 78um:82um -l 100um --crown 320um -c 4 |
	bemcontact --young 210GPa --load 50N |
	debrisgen -Y 355MPa -u 0.3 --young 210GPa --steps 9 >all 2>/dev/null
grep -v '^#' all >b
grep -h -v '^#' 50N.0.tsv 50N.2.tsv | awk 'NR == 1 || !/^realisation/' >c
same "blocks one after another are the ensemble in one piece" b c
done_testing
