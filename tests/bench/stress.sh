#!/bin/sh
# debrisgen's stress: error against run time, as a table and, where gnuplot is there, as
# build/bench/stress.png.
#
# scene     way       knob    what the error is; seconds of processor time; the most memory
#                             held so far, MB
# hertz     free      points  von Mises below a Hertz contact, friction 0.3, grid of side
#                             4 a: largest difference to the closed form on the axis from
#                             a/2 to 3a/2, in p0; seconds per layer, influence
#                             coefficients included
# padding   periodic  factor  a free half-space by a periodic one that is so many times
#                             wider than the loaded window: largest difference, in p0
# layers    RULE_Z    height  worn volume against the height of a layer, in a, by removal
#                             rule and place of the node in the layer: relative
#                             difference to layers of a/1000; seconds per wear step
#                             (height 0: the depth is interpolated)
# way_N_S   coarse    depth   one depth (in cells) of N x N nodes with a share S of the
#           full              cells loaded: difference of coarse sums from full ones, in the
#                             largest pressure
set -eu
top=$(cd "$(dirname "$0")/../.." && pwd)
cd "$top"
build/bench/stress | tee build/bench/stress.tsv
command -v gnuplot >/dev/null || exit 0
gnuplot <<'END'
set terminal pngcairo size 1200,700
set output "build/bench/stress.png"
set logscale xy
set format "%.0e"
set key outside bottom center horizontal
set multiplot layout 1, 2
set xlabel "seconds"
set ylabel "error"
pick(w) = sprintf("< awk '$1 == \"%s\"' build/bench/stress.tsv", w)
way(w) = sprintf("< awk '$2 == \"%s\"' build/bench/stress.tsv", w)
plot pick("hertz") using 5:4 with linespoints title "Hertz, 17 to 513 points", \
	pick("padding") using 5:4 with linespoints title "periodic, 1 to 16 times wider", \
	way("column_top") using 5:4 with linespoints title "volume, column, top", \
	way("column_mid") using 5:4 with linespoints title "volume, column, mid", \
	way("potential_top") using 5:4 with linespoints title "volume, potential, top", \
	way("potential_mid") using 5:4 with linespoints title "volume, potential, mid"
set xlabel "depth, cells"
set ylabel "seconds per depth"
cost(n, w) = sprintf("< awk '$1 == \"way_%d_0.03\" && $2 == \"%s\"' build/bench/stress.tsv", n, w)
plot for [n in "64 128 256 512"] cost(int(n), "coarse") using 3:5 with linespoints \
	title sprintf("%s x %s, coarse", n, n), \
	for [n in "64 128 256 512"] cost(int(n), "full") using 3:5 with lines \
	dashtype 2 title sprintf("%s x %s, full", n, n)
END
echo "# plot: build/bench/stress.png"
