#!/bin/sh
# Prognosis: error against run time, as a table and, where gnuplot is there, as
# build/bench/life.png.
#
# scene               knob   error, coverage, seconds (processor time)
# filter              N      rms difference of the particle filter's mean from the Kalman
#                            filter's, over the posterior standard deviation; a drifting
#                            random walk; seconds for 1e6 particle-steps
# grey-RULE           N      mean |error| of the end of life over 1186 h, and coverage of
# average-RULE        N      the 5 to 95 % interval: twenty synthetic pumps (see
#                            scripts/synthetic-pump), 600 rows each, by the rule that
#                            chooses the order; seconds for one series
# steps-ORDER         N      seconds of aopf itself for 1e6 particle-steps at a fixed order
# rows                N      seconds for a row without and (rows-life) with prediction of
#                            life, 1200 rows
. "$(dirname "$0")/setup"
pumps=${PUMPS:-20}

# life SCENE KNOB ARG...: errors over the pumps
life() {
	scene=$1
	knob=$2
	shift 2
	: >lives
	k=1
	while [ $k -le "$pumps" ]; do
		aopf --time-unit h -y 2.8 --direction up -S stats "$@" "pump$k.tsv" >out
		printf '%s\t%s\n' "$(grep -v "^#" out | tail -1)" "$(column cpu_seconds stats)" >>lives
		k=$((k + 1))
	done
	awk -F '\t' -v scene="$scene" -v knob="$knob" '{
		left = $9 == "inf" ? 10 * $1 : $9
		e = ($1 + left) / 1186 - 1
		sum += e < 0 ? -e : e
		inside += $1 + $8 <= 1186 && ($10 == "inf" || $1 + $10 >= 1186)
		seconds += $NF
	} END { printf "%s\t%s\t%.4f\t%.2f\t%.4f\n", scene, knob, sum / NR, inside / NR,
		seconds / NR }' lives
}

all() {
	printf 'scene\tknob\terror\tcoverage\tseconds\n'
	for n in 100 1000 10000 100000 1000000; do
		steps=$((20 + (n < 20000 ? 2000 : 40000000 / n)))
		"$top/build/bench/filter_core" $n $steps 0.5 | awk '{
			printf "filter\t%s\t%s\tnan\t%.5f\n", $1, $6, 1e6 / $4 }'
	done
	k=1
	while [ $k -le "$pumps" ]; do
		"$top/scripts/synthetic-pump" $k 600 >"pump$k.tsv"
		k=$((k + 1))
	done
	for n in 100 300 1000 3000; do
		for rule in 7 20 window insample; do
			life "grey-$rule" $n --model grey --order $rule --particles $n
		done
		life average-window $n --particles $n
	done
	"$top/scripts/synthetic-pump" 1 1200 >pump.tsv
	for order in 4 60; do
		aopf --time-unit h --order $order --particles 10000 -S stats pump.tsv >/dev/null
		printf 'steps-%s\t10000\tnan\tnan\t%s\n' $order \
			"$(column cpu_seconds stats | awk '{ print $1 / 12 }')"
	done
	for n in 100 300 1000 3000; do
		aopf --time-unit h --particles $n -S stats pump.tsv >/dev/null
		printf 'rows\t%s\tnan\tnan\t%s\n' $n \
			"$(column cpu_seconds stats | awk '{ print $1 / 1200 }')"
		aopf --time-unit h -y 2.8 --particles $n -S stats pump.tsv >/dev/null
		printf 'rows-life\t%s\tnan\tnan\t%s\n' $n \
			"$(column cpu_seconds stats | awk '{ print $1 / 1200 }')"
	done
}

all | tee table
plot life 1000,450 <<END
set datafile separator "\t"
set logscale xy
set multiplot layout 1,2
set key bottom left
set xlabel "particles"
set ylabel "difference from Kalman / standard deviation"
plot "< grep '^filter	' table" using 2:3 with linespoints notitle
set xlabel "seconds for a series of 600 rows"
set ylabel "error of the end of life / life"
plot for [s in "grey-7 grey-20 grey-window grey-insample average-window"] \
	"< grep '^".s."\t' table" using 5:3 with linespoints title s
END
