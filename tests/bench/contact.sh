#!/bin/sh
# bemcontact: error against run time, as a table and, where gnuplot is there, as
# build/bench/contact.png.  FULL=1 takes grids to 2048 and tolerances to 1e-10 for all.
#
# per       self-affine periodic surface, about 5, 20 and 60 % contact
# free      rough paraboloid on a free surface
# hertz     paraboloid, wave: closed forms, whose error is that of the grid
#
# optimality_gap  sum p (g - min g) / sum p (u - u0) reached: see bemcontact(1)
# pressure_error  mean |p - reference| over the mean pressure; reference: tolerance 1e-12
# area_error      area less that of the reference
# exact_error     mean |p - closed form| over the mean pressure
# seconds         processor time of setting up (kernel, plans) and of solving
# transforms      Fourier transforms on the grid; work: with those of coarser grids, in
#                 transforms of this grid (free: padded ones, others a quarter)
. "$(dirname "$0")/setup"
run=$top/build/bench/contact
grids="128 256 512"
tolerances="1e-2 1e-4 1e-6 1e-8 1e-10"
[ -z "${FULL:-}" ] || grids="128 256 512 1024 2048"

# curves SCENE N PRESSURE SOLVER...: all tolerances against one reference
curves() {
	scene="$1 $2 $3"
	shift 3
	# shellcheck disable=SC2086 # three words
	"$run" $scene save 1e-12 reference
	for solver in "$@"; do
		for t in $tolerances; do
			# shellcheck disable=SC2086
			"$run" $scene "$solver" "$t" reference
		done
	done
}

all() {
	printf 'scene\tn\tpressure\tsolver\ttolerance\toptimality_gap\tpressure_error\tarea_error\t'
	printf 'exact_error\tarea\tsetup_seconds\tseconds\titerations\ttransforms\twork\tmemory_mb\n'
	for n in $grids; do
		for p in 0.0025 0.01 0.036; do
			[ "$n" -gt 256 ] && [ -z "${FULL:-}" ] && [ $p != 0.01 ] && continue
			[ "$n" -gt 1024 ] && [ $p != 0.01 ] && continue
			curves per "$n" $p bccg pk
		done
		[ "$n" -gt 256 ] && [ -z "${FULL:-}" ] && continue
		curves free "$n" 0.0208333333333 bccg pk mlms
	done
	for n in 32 64 $grids; do
		"$run" hertz "$n" 0.0208333333333 bccg 1e-9
	done
	for n in 256 512 1024 2048 4096; do
		"$run" wave $n 0.1 bccg 1e-9
	done
}

all | tee bench.tsv
plot contact 1400,600 <<END
set logscale xy
set format y "%.0e"
set xlabel "seconds"
set key below
set multiplot layout 1, 3
row(s, n, p, m) = sprintf("< awk '\$1 == \"%s\" && \$2 == %d && \$3 == \"%s\" && \$4 == \"%s\"' bench.tsv", s, n, p, m)
set title "periodic, 256 points"
set ylabel "mean error of pressure"
plot for [p in "0.0025 0.01 0.036"] for [m in "bccg pk"] row("per", 256, p, m) using 12:7 \
	with linespoints title p." ".m
set title "free surface"
plot for [n in "128 256"] for [m in "bccg pk mlms"] row("free", n + 0, "0.0208333", m) using 12:7 \
	with linespoints title n." ".m
set title "closed forms"
set xlabel "points"
plot for [s in "hertz wave"] sprintf("< awk '\$1 == \"%s\" && \$9 != \"nan\"' bench.tsv", s) \
	using 2:9 with linespoints title s
END
