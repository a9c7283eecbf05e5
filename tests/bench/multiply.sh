#!/bin/sh
# One application of the half-space on a free surface: error against run time of
# multi-level multi-summation beside the Fourier convolution, as a table and, where
# gnuplot is there, as build/bench/multiply.png.  FULL=1 takes grids to 2048.
. "$(dirname "$0")/setup"
grids="256 512"
[ -z "${FULL:-}" ] || grids="256 512 1024 2048"

all() {
	printf 'n\tfill\tmethod\torder\treach\terror\tseconds\tsetup_seconds\n'
	for n in $grids; do
		for fill in 0.001 0.05 0.5; do
			"$top/build/bench/multiply" "$n" $fill
		done
	done
}

all | tee bench.tsv
plot multiply 900,600 <<END
set logscale xy
set format y "%.0e"
set xlabel "seconds"
set ylabel "error of displacement"
set key outside
row(n, f, m) = sprintf("< awk '\$1 == %d && \$2 == %s && \$3 == \"%s\"' bench.tsv", n, f, m)
plot for [n in "$grids"] for [f in "0.001 0.05 0.5"] for [m in "fft mlms"] row(n + 0, f, m) \
	using 7:6 with linespoints title n." ".f." ".m
END
