#!/bin/sh
# Rough surfaces: error against run time, as a table and, where gnuplot is there, as
# build/bench/surface.png.
#
# scene     what the error is
# acf       autocorrelation: measured 1/e length, mean over realisations, over the wanted
#           one, less 1: falls as 1 / sqrt(realisations), down to the 0.001 that taking
#           off the mean of each realisation costs
# slope     root mean square gradient by differences (sdq_iso7) over the exact one of the
#           waves, less 1: what is left is sampling and the rim
# heights   magnitudes of the waves after skewness -1.2 and kurtosis 4.3 were imposed
# filter    Sq of a surface under an S-filter of 50 um that repeats, of one realisation
#           sampled ever finer, over that of the finest, less 1
# affine    Sq over the wanted one, less 1, all waves drawn: what a surface costs
. "$(dirname "$0")/setup"

# row SCENE N COUNT ERROR
row() {
	printf '%s\t%s\t%s\t%s\t%s\t%s\n' "$1" "$2" "$3" "$4" \
		"$(column cpu_seconds stats)" "$(column memory_kb stats)"
}

all() {
	printf 'scene\tpoints\trealisations\terror\tseconds\tmemory_kb\n'
	for count in 4 16 64 256 1024; do
		roughgen -n 128 -l 40um -c $count --measure -S stats >table
		row acf 128 $count "$(column corr_x table | awk '{ s += $1 }
			END { e = s / NR / 40e-6 - 1; print e < 0 ? -e : e }')"
	done
	for n in 32 64 128 256 512 1024; do
		roughgen -n $n -l 100um --slope 0.1 --measure -S stats >table
		row slope $n 1 "$(column sdq_iso7 table | awk '{ e = $1 / 0.1 - 1; print e < 0 ? -e : e }')"
	done
	for n in 64 128 256 512 1024; do
		roughgen -n $n -l 40um --skewness -1.2 --kurtosis 4.3 -S stats >out
		row heights $n 1 "$(sed -n 's/^spectrum_error:=//p' out)"
	done
	roughgen -n 2048 -l 100um | roughgen --s-filter 50um --ends periodic --measure >finest
	for n in 64 128 256 512 1024; do
		roughgen -n $n -l 100um | roughgen --s-filter 50um --ends periodic --measure -S stats >table
		row filter $n 1 "$(awk -v a="$(column sq finest)" -v b="$(column sq table)" 'BEGIN { e = b / a - 1; print e < 0 ? -e : e }')"
	done
	for n in 128 256 512 1024 2048; do
		roughgen -n $n --hurst 0.8 -S stats >out
		row affine $n 1 "$(sed -n 's/^sq:=//p' out | awk '{ e = $1 / 1e-6 - 1; print e < 0 ? -e : e }')"
	done
}

all | tee bench.tsv
plot surface 900,600 <<EOF
set logscale xy
set format y "%.0e"
set xlabel "seconds"
set ylabel "error"
set key outside
scenes = "acf slope heights filter affine"
row(s) = sprintf("< awk '\$1 == \"%s\"' bench.tsv", s)
plot for [s in scenes] row(s) using 5:(\$4 > 1e-17 ? \$4 : 1e-17) with linespoints title s
EOF
