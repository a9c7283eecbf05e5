#!/bin/sh
# rwl: error against run time, as a table and, where gnuplot is there, as
# build/bench/life-wear.png.
#
# scene      knob       what the error is; seconds and memory are the program's own
# paths      --count    the 5 % and 95 % quantiles of life, by the mean of the steps (4-29),
#                       against 3e6 paths: root mean square of ten seeds, over the median
# steps      --count    the same with a new rate in every step (4-28)
# fragments  their      median life against that of countless fragments (lognormal, spread
#            number     0.4): root mean square of ten ensembles, relative
# covered    their      share of 90 % intervals of 100 ensembles that hold it (no error;
#            number     seconds of one)
# far        steps      the median life in steps of a gamma process (4-28) against the law
#            left       of large numbers; the cost does not grow with the steps
# rows       rows       filters with 10 paths; seconds and memory alone
. "$(dirname "$0")/setup"

# row SCENE KNOB ERROR
row() {
	printf '%s\t%s\t%s\t%s\t%s\n' "$1" "$2" "$3" \
		"$(column cpu_seconds stats)" "$(column memory_kb stats)"
}

# ensemble SEED NUMBER: volumes of fragments
ensemble() {
	awk -v seed="$1" -v n="$2" '
	function uniform() { state = state * 16807 % 2147483647; return state / 2147483647 }
	BEGIN { state = seed * 7919 + 1; uniform(); uniform(); print "volume"
		for (i = 0; i < n; i++) {
			r = sqrt(-2 * log(uniform()))
			printf "%.9g\n", 1e-15 * exp(0.4 * r * cos(6.283185307179586 * uniform()))
		} }'
}
# 100 steps of fragments that wear exp(-0.08) of 0.1 um each
life() {
	rwl --new --step-time 1s --initial-gap 10um --threshold-gap 20um --stats stats "$@" |
		awk -F '\t' '/^[0-9]/ { print $3, $4, $5 }'
}
truth=$(awk 'BEGIN { printf "%.9g", 100 / exp(0.08) }')

printf 'scene\tknob\terror\tseconds\tmemory_kb\n'
{
	ensemble 1 30 >e.tsv
	for rule in mean last; do
		scene=$([ $rule = mean ] && echo paths || echo steps)
		life --wear e.tsv --parts 1 --wear-rate $rule -c 3000000 -s 99 >exact
		for n in 100 1000 10000 100000; do
			for seed in 1 2 3 4 5 6 7 8 9 10; do
				life --wear e.tsv --parts 1 --wear-rate $rule -c $n -s $seed
			done >got
			row $scene $n "$(awk 'NR == FNR { a = $1; m = $2; b = $3; next }
				{ s += ($1 - a) ^ 2 + ($3 - b) ^ 2; n += 2 }
				END { printf "%.3g", sqrt(s / n) / m }' exact got)"
		done
	done
	for n in 10 30 100 300 1000 3000 10000; do
		for seed in 1 2 3 4 5 6 7 8 9 10; do
			ensemble $seed $n >f.tsv
			life --wear f.tsv -c 100
		done >got
		row fragments $n "$(awk -v t="$truth" '{ s += ($2 / t - 1) ^ 2 } END { printf "%.3g", sqrt(s / NR) }' got)"
	done
	for n in 10 30 100 300; do
		seed=100
		while [ $seed -lt 200 ]; do
			ensemble $seed $n >f.tsv
			life --wear f.tsv -c 200
			seed=$((seed + 1))
		done >got
		row covered $n "$(awk -v t="$truth" '{ k += $1 <= t && t <= $3 } END { print k / NR }' got)"
	done
	# one fragment of two, worn alike: mean 1.5, spread 0.5 of 1e-15
	printf 'volume\n1e-15\n2e-15\n1e-15\n2e-15\n1e-15\n2e-15\n' >two.tsv
	for n in 10 1000 100000 10000000; do
		h=$(awk -v n=$n 'BEGIN { printf "%.12gum", n * 1.5e-3 }')
		rwl --new --step-time 1s --initial-gap 0m --parts 1 --threshold-gap "$h" --fragment-area 1mm2 --area 1mm2 --wear-rate last --wear two.tsv -c 10000 --rates rates.tsv \
			--samples --stats stats >samples
		# life times the path's own mean is what is left, but for the scatter of steps
		row far $n "$(awk -F '\t' -v left="$(echo "$n" | awk '{ print $1 * 1.5e-15 }')" '/^#/ { next }
			FNR == NR { mean[$1] = $2; next } $2 in mean && $1 + 0 == $1 { d = $3 * mean[$2] / left - 1
				s += d; n++ } END { printf "%.3g", (s < 0 ? -s : s) / n }' rates.tsv samples)"
	done
	for n in 1000 10000 100000; do
		awk -v n=$n 'BEGIN { print "t\tgap"; for (i = 0; i < n; i++)
			printf "%d\t%.9g\n", i, 1e-5 + 1e-6 * i / n + 1e-8 * sin(i * i) }' |
			rwl --threshold-gap 12um --wear-rate filter -c 10 --stats stats >/dev/null
		row rows $n nan
	done
} | tee bench.tsv
plot life-wear 900,600 <<END
set logscale xy
set xlabel "seconds"
set ylabel "error"
set key outside
row(s) = sprintf("< awk '\$1 == \"%s\"' bench.tsv", s)
plot for [s in "paths steps fragments far"] row(s) using 4:3 with linespoints title s
END
