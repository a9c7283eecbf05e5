#!/bin/sh
# Every experiment of the thesis in its quick form: it runs, its results obey the limits of the
# physics, the page holds every row, and nothing is left in the source tree
. "$(dirname "$0")/../tap.sh"
command -v gnuplot >/dev/null || {
	echo '1..0 # SKIP no gnuplot'
	exit
}
left() { (cd "$top" && git status --porcelain --ignored -- examples scripts 2>/dev/null); }
before=$(left)
ok 'every experiment runs and the page is written' env MAKE='make -j 2' OUT="$work/thesis" "$top/scripts/thesis" quick
is 'nothing is left in the source tree' "$(left)" "$before"
ok 'a second call succeeds' env OUT="$work/thesis" "$top/scripts/thesis" quick
is 'a second call runs no experiment again' "$(grep -c ' s$' out)" 0

# --- An experiment that is cut off stops, and goes on from what is there.
OUT="$work/cut" "$top/scripts/thesis" quick grid >cut.log 2>&1 &
run=$!
# make has done with one file when the next is there
until [ -e cut/grid/soft.128.tsv ]; do sleep 0.2; done
kill $run
wait $run
ok 'a signal stops the run' test ! -e cut/grid/done
ok 'the processor time of a stopped experiment is kept' test -s cut/grid/seconds
ls -i --full-time cut/grid/soft.64.tsv >before
ok 'the next call goes on with a stopped experiment' env OUT="$work/cut" "$top/scripts/thesis" quick grid
ls -i --full-time cut/grid/soft.64.tsv >after
same 'finished files are not made again' before after

# value EXPERIMENT KEY
value() {
	awk -F '\t' -v k="$2" '$1 == k { print $2 }' "thesis/$1/results.tsv"
}
# within NAME VALUE LOW HIGH
within() {
	if awk -v v="$2" -v a="$3" -v b="$4" 'BEGIN { exit !(v ~ /^[-+0-9.]/ && v >= a && v <= b) }'; then
		pass "$1: $2"
	else
		fail "$1" "got:  $2" "want: $3 to $4"
	fi
}
# --- chapter 2.  The cells that a point load of 50 N fails have the volume of a ball of
# 307.0 um; a single spot of contact comes near it, several stay below.
within 'the first particle of the whole set has nearly the diameter of a point load, um' "$(value ch2-steps first_whole)" 250 320
within 'a step of the column rule wears less than a point load, m3' "$(value ch2-pairs v50.column)" 1e-12 1.515e-11
within 'a step at 100 N wears less than a point load, m3' "$(value ch2-pairs v100.column)" 1e-12 4.286e-11
rising 'columns lose less than the whole set' "$(value ch2-pairs v50.column)" "$(value ch2-pairs v50.whole)" 1.515e-11
within 'twice the load wears 2 to 2^1.5 times as much' "$(value ch2-pairs ratio.column)" 1.9 2.9
# --- chapter 3
near 'the joint fit has the first delay that was put in, ms' "$(value ch3-separation a1_delay1.fit)" 0.2121 0.01
near 'the joint fit has the second delay that was put in, ms' "$(value ch3-separation a1_delay2.fit)" 0.4545 0.01
near 'the joint fit finds the four pulses of a2' "$(value ch3-separation a2_found.fit)" 4 0
within 'three sources leave what four do not' "$(value ch3-separation a2_left3)" 2 10
rising 'more particles a second give more counts above 150 um' 0 "$(value ch3-separation above_counted.100)" \
	"$(value ch3-separation above_counted.300)"
near 'the mains line is found, Hz' "$(value ch3-signals line_off)" 50 0
near 'the pump line is found, Hz' "$(value ch3-signals line_on)" 2000 0
# three constants of the right sum and spread score 5/36, the constant 1/2 scores 1/12
within 'networks that learnt little score as constants do' "$(value ch3-networks t4-01.ordered)" 0.07 0.18
# --- chapter 4.  White noise of 0.062 and its forecast: above its square, below twice that.
within 'the one-step error at order 30 is that of white noise, (L/min)^2' "$(value ch4-leakage mse30.grey)" 0.0042 0.0077
within 'intervals of the averaged models hold the end' "$(value ch4-leakage average_holds)" 0.75 1
within 'the 90 % interval holds the truth in most hours, %' "$(value ch4-wear-life coverage)" 60 100
rising 'the earlier of two thresholds is no later than one' "$(value ch4-wear-life size_life)" "$(value ch4-wear-life volume_life)"

# --- the page
page=thesis/index.html
is 'every row of the table has a verdict, and none was not run' "$(cut -f 1 thesis/verdicts | grep -vxE \
	'agrees|agrees under reading|differs|print inconsistent|data unpublished|scheme only' | sort | uniq -c)" ''
is 'there are as many verdicts as rows' "$(wc -l <thesis/verdicts)" "$(grep -vc '^#\|^item' "$top/examples/thesis.tsv")"
is 'there are 68 figures' "$(grep -c '<figure id="figure-' $page)" 68
is 'the page has no link to elsewhere' "$(grep -cE '(src|href)="?(https?:|//)' $page)" 0
is 'every figure that has results has a picture' "$(awk -F '\t' '/^figure/ && $9 != "scheme only" { print $1 }' "$top/examples/thesis.tsv" |
	while read -r _ n; do
		grep -q "<img alt=\"our figure $n\"" $page || echo "figure $n"
	done)" ''
for tool in abrade lives layout volumes materials debriscount; do
	is "there is a picture of what lies beyond the thesis: $tool" "$(grep -c "<img alt=\"$tool\"" $page)" 1
done
# The values in examples/results.tsv, which the pages quote, are those that come out; they are
# of the full form, with more runs.
is 'nine in ten of the values quoted are within a tenth or their intervals meet' "$(awk -F '\t' '
	/^#/ || $1 == "experiment" { next }
	FNR == NR { v[$1, $2] = $3; a[$1, $2] = $4; b[$1, $2] = $5; next }
	($1, $2) in v { n++; x = v[$1, $2]; d = x - $3; t = 0.1 * x; if (t < 0) t = -t; if (d < 0) d = -d
		l = $4 == "nan" ? $3 : $4; h = $4 == "nan" ? $3 : $5; p = a[$1, $2] == "nan" ? x : a[$1, $2]; q = a[$1, $2] == "nan" ? x : b[$1, $2]
		if (d <= t || p + 0 <= h + 0 && l + 0 <= q + 0) ok++ }
	END { print (n > 100 && ok > 0.9 * n) }' thesis/snapshot.tsv "$top/examples/results.tsv")" 1
done_testing
