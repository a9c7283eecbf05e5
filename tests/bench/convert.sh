#!/bin/sh
# sigconvert and surfimport: error against run time, as a table and, where gnuplot is there,
# as build/bench/convert.png.
#
# scene    knob     error, seconds (processor time, there and back)
# signals  format   largest difference after a signal of 1e6 samples went into the format and
#                   back, over its largest sample
# heights  digits   root mean square difference after 512 x 512 heights went through text of
#                   so many digits, over their own
. "$(dirname "$0")/setup"

# samples FILE: one a line
samples() {
	sigconvert --output text "$1" | awk -F '\t' '/^[0-9]/ { print $2; print $3 }'
}
total() {
	awk -v a="$(column cpu_seconds s1)" -v b="$(column cpu_seconds s2)" 'BEGIN { print a + b }'
}

all() {
	printf 'scene\tknob\terror\tseconds\n'
	sensorsim --uniform 50um:100um --number 500 --duration 50s --noise 10mV >signal.au
	samples signal.au >signal.txt
	most=$(awk '{ v = $1 < 0 ? -$1 : $1; if (v > m) m = v } END { printf "%.17g", m }' signal.txt)
	for format in text raw wav flac; do
		from="--from sound" to=
		[ $format != text ] || from="--from text"
		[ $format != raw ] || from="--from raw --rate 10kHz --channels 2"
		# 24 bits of full scale
		[ $format != flac ] || to="--scale $(awk -v m="$most" 'BEGIN { print 0.99 / m }')"
		sigconvert --output $format $to --stats s1 signal.au >there 2>/dev/null || continue
		sigconvert $from --stats s2 there >back.au
		samples back.au | paste signal.txt - | awk -v m="$most" -v f="${to#--scale }" '
			{ e = $1 - $2 / (f ? f : 1); if (e < 0) e = -e; if (e > most) most = e } END { print most / m }' >e
		printf 'signals\t%s\t%s\t%s\n' $format "$(cat e)" "$(total)"
	done
	roughgen --points 512 --length 1mm --sq 1um --corr 50um >heights.nrrd
	records --output text heights.nrrd | grep -v '^#' | grep . >exact.txt
	for digits in 2 3 4 6 9; do
		awk -v d=$digits '{ for (i = 1; i <= NF; i++) printf "%.*g%s", d, $i, i < NF ? "\t" : "\n" }' exact.txt >there.txt
		surfimport --format text --pixel 1.953125um --height-unit 1m --stats s1 there.txt >back.nrrd
		records --output text --stats s2 back.nrrd | grep -v '^#' | grep . | paste -d '\n' exact.txt - |
			awk 'NR % 2 { split($0, a); next } { for (i = 1; i <= NF; i++) { e = $i - a[i]; s += e * e; v += a[i] * a[i] } }
				END { print sqrt(s / v) }' >e
		printf 'heights\t%s\t%s\t%s\n' $digits "$(cat e)" "$(total)"
	done
}

all | tee bench.tsv
plot convert 700,400 <<'G'
set logscale xy
set xlabel "processor time, s"
set ylabel "relative error"
set grid
plot for [s in "signals heights"] "< awk -v s=".s." '$1 == s'  bench.tsv" using 4:($3 > 1e-17 ? $3 : 1e-17) with points title s
G
