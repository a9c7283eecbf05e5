#!/bin/sh
# abrade: error against run time, as a table and, where gnuplot is there, as
# build/bench/abrade.png.
#
# scene  knob       error, seconds (processor time)
# oil    particles  |depth rate of particles drawn over the mean rate of the code - 1|, root
#                   mean square over 20 seeds; seconds of one run
# gap    particles  |load carried at the gap found over the load - 1|; of 1e-3 of the most
#                   they can carry
# cut    points     |volume lost over that of the grooves - 1|, 100 grooves, points per side
. "$(dirname "$0")/setup"

oil="--iso 18:16:13 --largest 70um --gap 5um --hardness 2GPa,6GPa --friction 0.1 --motion groove"

all() {
	printf 'scene\tknob\terror\tseconds\n'
	for area in 1e-3 1e-2 1e-1 1 10; do
		: >rates
		for seed in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
			abrade $oil --area ${area}m2 --seed $seed --summary s --stats st >out
			echo "$(column particles s) $(column depth_rate2 s) $(column mean_depth_rate2 s) $(column cpu_seconds st)" >>rates
		done
		awk '{ n += $1; e += ($2 / $3 - 1) ^ 2; t += $4 } END { printf "oil\t%.0f\t%.4g\t%.5f\n", n / NR, sqrt(e / NR), t / NR }' rates
	done
	for n in 10 100 1000 10000 100000; do
		awk -v n=$n 'BEGIN { srand(1); print "diameter"; for (i = 0; i < n; i++) print 4e-6 + 10e-6 * rand() }' >p.tsv
		abrade --load "$n"mN --hardness 2GPa,6GPa --friction 0.1 --summary s --stats st p.tsv >out
		printf 'gap\t%s\t%s\t%s\n' $n "$(awk -v l="$(column load s)" -v n=$n 'BEGIN { e = l / n * 1e3 - 1; print e < 0 ? -e : e }')" \
			"$(column cpu_seconds st)"
	done
	awk 'BEGIN { print "diameter\taspect"; for (i = 0; i < 100; i++) print 4e-6 + 1e-8 * i "\t3" }' >p.tsv
	for n in 16 64 256 1024; do
		roughgen --points $n --length 100um --sq 0 >flat.nrrd
		abrade --gap 3.9um --hardness 6GPa,2GPa --friction 0.1 --slide 70um --surface flat.nrrd --particles w --stats st p.tsv >worn.nrrd
		printf 'cut\t%s\t%s\t%s\n' $n "$(awk -v l="$(records -o list worn.nrrd | awk -F '\t' '/^[0-9]/ { printf "%.17g", -$11 * 1e-8 }')" \
			-v v="$(column volume1 w | awk '{ s += $1 } END { printf "%.17g", s }')" 'BEGIN { e = l / v - 1; print e < 0 ? -e : e }')" \
			"$(column cpu_seconds st)"
	done
}

all | tee bench.tsv
plot abrade 700,400 <<'G'
set logscale xy
set xlabel "processor time, s"
set ylabel "relative error"
set grid
plot for [s in "oil gap cut"] "< awk -v s=".s." '$1 == s && $3 > 0' bench.tsv" using 4:3 with linespoints title s
G
