#!/bin/sh
# duet: error against run time, as a table and, where gnuplot is there, as
# build/bench/signal.png.
#
# method    fit, duet (masks) with their window in samples, count
# snr       dB, peak of a 1 V pulse over the noise of a sample
# m gap     particles per scene, amplitudes 0.5 to 1.5 V, and the least time between
#           them in tenths of a millisecond (samples); the pulse lasts 100
# delay     root mean square error of the matched, samples; bound: what the Cramer-Rao
#           bound allows (the standard errors of fit, where every scene is right)
# size      root mean square error of the diameter, per cent
# right     share of the scenes with the right count
# seconds   processor time per scene, learning included
#
# A second table tells what is left of the other pulse when two are parted (demix.c), a
# third how long the solver of the joint fit takes, and those of GSL (solvers.c).
#
# Another table is of records that passed a filter, and of coloured noise, beside the
# raw record (build/bench/signal-filter.tsv): 100 particles in 16 s at 30 dB; found and false,
# delay error over the bound, bias of the size in per cent (its amount), seconds; each the
# median of five records.
#
# The last is of particles that arrive at random, so many a second (signal-dense.tsv): share
# of them found, false ones as a share of them, median delay error in samples, bias of the
# size in per cent, seconds of processor time for 20 s of record.
#
# SCENES sets the number of scenes (100).
set -eu
top=$(cd "$(dirname "$0")/../.." && pwd)
PATH=$top/bin:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
out=$top/build/bench
mkdir -p "$out"
cd "$work"
export LC_ALL=C
SCENES=${SCENES:-100}

# detect OPTION ...: in s.au; doubtful rows, status 3, are scored as well
detect() {
	duet -S stats.tsv "$@" s.au >found.tsv || [ $? -eq 3 ]
}

column() {
	awk -F '\t' -v c="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == c) k = i; next }
	{ print $k }' "$2"
}

# scenes SNR M GAP: s.au and truth.tsv, one scene per period
scenes() {
	period=$(awk -v m="$2" 'BEGIN { print (50 * m + 400) / 1e4 }')
	sensorsim --by volume --uniform 79.370um:114.471um --number $(($2 * SCENES)) \
		--burst "$2" --span "$(awk -v m="$2" 'BEGIN { print m * 5e-3 }')s" \
		--gap "$(awk -v g="$3" 'BEGIN { print g * 1e-4 }')s" --period "${period}s" \
		--start 20ms --snr "$1dB" --lag 0.2ms:0.5ms --gain 0.909 \
		--truth truth.tsv >s.au
}

# row NAME SNR M GAP OPTION...
bound=nan
row() {
	name=$1
	snr=$2
	m=$3
	gap=$4
	shift 4
	detect "$@" 2>/dev/null
	"$top/scripts/score" -p "$period" -o 0.01 truth.tsv found.tsv >score.tsv
	[ "$name" = fit ] && bound=$(awk -v d="$(column delay_rms score.tsv)" \
		-v r="$(column delay_ratio score.tsv)" 'BEGIN { print (r > 0 ? d / r * 1e4 : "nan") }')
	awk -v name="$name" -v snr="$snr" -v m="$m" -v gap="$gap" -v bound="$bound" \
		-v delay="$(column delay_rms score.tsv)" -v size="$(column size_rms score.tsv)" \
		-v right="$(column right score.tsv)" -v n="$(column scenes score.tsv)" \
		-v cpu="$(column cpu_seconds stats.tsv)" 'BEGIN {
			OFS = "\t"
			print name, snr, m, gap, delay == "nan" ? delay : delay * 1e4, bound,
				size == "nan" ? size : size * 100, right / n, cpu / n }' |
		tee -a all.tsv
}

printf 'method\tsnr\tm\tgap\tdelay\tbound\tsize\tright\tseconds\n' | tee all.tsv
for snr in 10 20 30 40; do
	for m in 1 2 4 6; do
		scenes $snr $m 10
		row fit $snr $m 10
		row duet64 $snr $m 10 --method duet --window 64
	done
done
for w in 128 256; do
	for m in 1 2; do
		scenes 30 $m 10
		row duet$w 30 $m 10 --method duet --window $w
	done
done
for gap in 2 5 20 40; do
	scenes 30 2 $gap
	row fit 30 2 $gap
	row duet64 30 2 $gap --method duet --window 64
done

cp all.tsv "$out/signal.tsv"

# filtered NAME UNDO [ORDER [sensorsim-options]]: one row; ORDER is of bpfilter or empty
filtered() {
	name=$1
	undo=$2
	order=${3-}
	shift $(($# < 3 ? $# : 3))
	for seed in 1 2 3 4 5; do
		sensorsim --seed $seed --uniform 80um:120um --number 100 --start 1s --span 14s \
			--duration 16s --gap 20ms --snr 30dB --lag 0.2ms:0.5ms --gain 0.909 \
			--truth truth.tsv "$@" >s.au
		if [ -n "$order" ]; then
			# shellcheck disable=SC2086 # options are words
			bpfilter --zero-phase -b $order s.au >passed.au
			mv passed.au s.au
		fi
		detect --undo "$undo"
		"$top/scripts/score" truth.tsv found.tsv >score.tsv
		for c in matched false delay_ratio size_bias; do
			printf '%s\t' "$(column $c score.tsv)"
		done
		column cpu_seconds stats.tsv
	done >rows
	printf '%s\t%s' "$name" "$undo"
	for k in 1 2 3 4 5; do
		cut -f $k rows | sed 's/^-//' | sort -g | sed -n 3p |
			awk -v k=$k '{ printf "\t%s", k == 4 && $1 != "nan" ? $1 * 100 : $1 }'
	done
	echo
}
{
	printf 'record\tundo\tfound\tfalse\tratio\tbias\tseconds\n'
	filtered raw auto
	for order in '70:130 --order 200' '20:1000 --order 1000' '0:3000 --order 200'; do
		filtered "${order%% *}" auto "$order"
		filtered "${order%% *}" none "$order"
	done
	for corner in 500 1000 3000; do
		filtered "corner $corner" auto '' --corner "$corner"
	done
} | tee "$out/signal-filter.tsv"

{
	printf 'snr\trate\tfound\tfalse\tdelay\tbias\tseconds\n'
	for snr in 20 30 40; do
		for rate in 50 100 150 200 300; do
			sensorsim --uniform 80um:120um --number $((20 * rate)) --duration 20s \
				--snr "${snr}dB" --lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv >s.au
			detect
			"$top/scripts/score" truth.tsv found.tsv >score.tsv
			awk -v snr=$snr -v rate=$rate -v n="$(column truth score.tsv)" \
				-v found="$(column matched score.tsv)" \
				-v false="$(column false score.tsv)" \
				-v delay="$(column delay_median score.tsv)" \
				-v bias="$(column size_bias score.tsv)" \
				-v cpu="$(column cpu_seconds stats.tsv)" 'BEGIN {
					OFS = "\t"
					print snr, rate, found / n, false / n, delay * 1e4, bias * 100, cpu }'
		done
	done
} | tee "$out/signal-dense.tsv"
if [ -x "$out/demix" ]; then
	"$out/demix" | tee "$out/demix.tsv"
fi
if [ -x "$out/solvers" ]; then
	"$out/solvers" | tee "$out/solvers.tsv"
fi
command -v gnuplot >/dev/null || exit 0
for m in 1 2 4 6; do
	awk -F '\t' -v m=$m '$1 == "fit" && $3 == m && $4 == 10' all.tsv >fit-$m
	awk -F '\t' -v m=$m '$1 == "duet64" && $3 == m && $4 == 10' all.tsv >masks-$m
done
awk '$1 == "fit"' all.tsv >fit
awk '$1 ~ /^duet/' all.tsv >masks
gnuplot <<END
set terminal pngcairo size 900,600
set output "$out/signal.png"
set datafile separator "\t"
set datafile missing "nan"
set logscale y
set xlabel "signal to noise, dB"
set ylabel "error of the delay, samples"
set key outside
set style data linespoints
plot for [n in "1 2 4 6"] "fit-".n using 2:5 title "fit, M = ".n, \
	for [n in "1 2 4 6"] "fit-".n using 2:6 with lines dashtype 2 title "bound, M = ".n, \
	for [n in "1 2"] "masks-".n using 2:5 title "masks, M = ".n
set output "$out/signal-time.png"
set logscale xy
set xlabel "processor time per scene, s"
plot "fit" using 9:5 with points pt 7 title "fit", "masks" using 9:5 with points pt 6 title "masks"
END
