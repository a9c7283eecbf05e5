#!/bin/sh
# layout: error against run time, as a table and, where gnuplot is there, as
# build/bench/layout.png.
#
# scene    knob     error, seconds (processor time)
# sum      samples  |se_velocity of the sums over it of the integrals - 1|, sine, three
#                   coils, 16 places of the arrival between two samples
# search   steps    se_velocity over that of 4096 halved steps - 1, three coils within 1 m,
#                   every pulse paired rightly with 0.99
. "$(dirname "$0")/setup"

error() { # reference row file
	awk -F '\t' -v a="$1" -v b="$2" 'BEGIN { e = b / a - 1; print e < 0 ? -e : e }'
}

all() {
	printf 'scene\tknob\terror\tseconds\n'
	layout --coils 0,5cm,25cm --snr 40dB --arrivals 1 --rate 1e9Hz --method closed >exact.tsv
	for rate in 200 400 1000 2000 5000 10000 100000 1000000 10000000; do
		layout --coils 0,5cm,25cm --snr 40dB --arrivals 1 --rate $rate --method sum --stats s >out
		e=$(error "$(column se_velocity exact.tsv)" "$(column se_velocity out | awk -v r=$rate '{ printf "%.12g", $1 * sqrt(r / 1e9) }')")
		printf 'sum\t%g\t%s\t%s\n' "$(column samples out)" "$e" "$(column cpu_seconds s)"
	done
	room="--best 3 --extent 1m --least-unique 0.99 --snr 30dB --arrivals 100 --spread 10%"
	layout $room --steps 2048 >exact.tsv
	for steps in 2 4 8 16 32 64 128 256 512 1024; do
		layout $room --steps $steps --stats s >out
		printf 'search\t%s\t%s\t%s\n' $steps \
			"$(error "$(column se_velocity exact.tsv)" "$(column se_velocity out)")" \
			"$(column cpu_seconds s)"
	done
}

all | tee bench.tsv
plot layout 700,400 <<'G'
set logscale xy
set xlabel "processor time, s"
set ylabel "relative error"
set grid
plot for [s in "sum search"] "< awk -v s=".s." '$1 == s && $3 > 0 && $4 > 0' bench.tsv" using 4:3 with linespoints title s
G
