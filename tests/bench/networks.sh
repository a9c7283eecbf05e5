#!/bin/sh
# Delay networks: error against run time, as a table and, where gnuplot is there, as
# build/bench/networks.png.
#
# part        scene                    what the error is
# delays      a structure of tables    mean squared error of three delays of 1000 training
#             2 to 6, by epochs        and 300 test samples: output by output, and in the
#                                      best order (3-21); 1/12 and 1/24 need no data
# arrivals    network and joint fit,   root mean square error of the delay over the
#             by pulses and SNR        Cramer-Rao bound, of sections whose count is right
#
# Seconds are processor time: of the training (delays), of the work per sample or section.
# OpenBLAS, where it was there at build time, makes training some five times faster.
. "$(dirname "$0")/setup"

# structure NAME EPOCHS OPTION...: train, score, print a row
structure() {
	name=$1 epochs=$2
	shift 2
	delaynet "$@" --epochs "$epochs" --stats train >net
	delaynet --task score --stats score net >scores
	printf 'delays\t%s\t%s\t%s\t%s\t%s\t%s\t%s\n' "$name" "$epochs" \
		"$(column ordered scores | head -n 1)" "$(column unordered scores | head -n 1)" \
		"$(column cpu_seconds train)" \
		"$(column cpu_seconds score | awk '{ print $1 / 600 }')" \
		"$(column memory_kb train)"
}

delays() {
	for e in 3 10 30 100 300; do
		structure '[10] descent' $e --layers 10 --optimiser descent --learning-rate 0.05
		structure '[10] adam' $e --layers 10
		structure 'cascade [10]' $e --layers 10+
		structure '[8 8] adam' $e --layers '8 8'
	done
	for e in 3 10 30; do
		structure 'auto-encoder [100 50]' $e --layers '100 50' --activation sigmoid --pretrain $e
		structure 'sparse [100 50]' $e --layers '100 50' --activation sigmoid --pretrain $e --sparsity 4
	done
	for e in 1 3 9; do
		structure '10conv20*2' $e --layers '10conv20x2 pool2x2 256' --activation relu --batch 20 --learning-rate 3e-4
	done
	for e in 1 3; do
		structure '10conv30*2 10conv15*1' $e --batch 20 --learning-rate 3e-4 --activation relu \
			--layers '10conv30x2 pool2x2 10conv15x1 pool2x1 1024'
	done
}

{
	printf 'part\tscene\teffort\terror\terror_unordered\tseconds\tseconds_each\tmemory_kb\n'
	delays
	"$top/build/bench/arrivals" "$top/share/arrivals.net" "${SECTIONS:-200}" >arrivals.tsv
	awk -F '\t' 'NR == 1 { next }
	$1 == "bound" { bound = 1; b[$2, $3] = $7; next }
	{ row[++n] = $0 }
	END { for (i = 1; i <= n; i++) { split(row[i], c, "\t")
		printf "arrivals\t%s M=%d %d dB\t%s\t%.3g\t%s\t%s\t%s\tnan\n", c[1], c[2], c[3],
			c[5], c[7] / b[c[2], c[3]], "nan", "nan", c[9] } }' arrivals.tsv
} | tee bench.tsv
plot networks 1200,600 <<EOF
set datafile separator "\t"
set logscale xy
set multiplot layout 1, 2
set key bottom left font ",8"
set format x "%.0e"
set xlabel "seconds of training"
set ylabel "mean squared error of three delays, output by output"
set yrange [0.03:0.3]
set arrow from graph 0, first 1./12 to graph 1, first 1./12 nohead dashtype 2
set label "constant, 1/12" at graph 0.6, first 1./12 offset 0, 0.5
set arrow from graph 0, first 1./18 to graph 1, first 1./18 nohead dashtype 3
set label "best for delays without order, 1/18" at graph 0.4, first 1./18 offset 0, -0.5
names = system("awk -F '\t' '\$1 == \"delays\" && !s[\$2]++ { gsub(/ /, \"~\", \$2); print \$2 }' bench.tsv")
text(i) = system("echo '".word(names, i)."' | tr '~' ' '")
plot for [i = 1:words(names)] sprintf("< awk -F '\t' -v n='%s' '\$2 == n' bench.tsv", text(i)) \
	using 6:4 with linespoints title text(i) noenhanced
unset arrow
unset label
set yrange [0.5:20]
set xlabel "seconds per section"
set ylabel "error of the delay over the Cramer-Rao bound"
set arrow from graph 0, first 1 to graph 1, first 1 nohead dashtype 2
plot for [m in "network fit"] \
	sprintf("< awk -F '\t' -v n='%s' '\$1 == \"arrivals\" && index(\$2, n \" \") == 1' bench.tsv", m) \
	using 7:4 with points pointsize 1.5 title m
EOF
