#!/bin/sh
# Stiff and extreme scenes of duet: accurate, or refused in one line.
. "$(dirname "$0")/../tap.sh"
. "$top/tests/extremes/scenes.sh"
. "$top/tests/au.sh"

# score COLUMN: of truth.tsv and found.tsv
score() {
	"$top/scripts/score" ${limit:+-t "$limit"} truth.tsv found.tsv |
		awk -F '\t' -v c="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == c) k = i; next }
		{ print $k }'
}

# Twenty clear particles; noise at 40 dB.
particles() {
	sensorsim --uniform 80um:120um --number 20 --duration 2s --gap 30ms --snr 40dB \
		--lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv "$@" >s.au
}

constant() { # VALUE1 VALUE2
	awk -v a="$1" -v b="$2" 'BEGIN { for (i = 0; i < 4000; i++) print a, b }' | au 10000 2
}

# --- dead and broken records
constant 0 0 >silence.au
refused "silence" 1 'sensor 1 is constant: a dead sensor' duet silence.au
constant 2.5 -1 >dc.au
refused "DC" 1 'sensor 1 is constant' duet dc.au
particles
frames s.au 2 >frames.txt
awk '{ print $1, 0 }' frames.txt | au 10000 2 >dead.au
refused "sensor 2 dead" 1 'sensor 2 is constant' duet dead.au
awk 'NR == 777 { $2 = "nan" } { print $1, $2 }' frames.txt | au 10000 2 >nan.au
duet nan.au >found.tsv 2>said
scene "a sample is nan" "it is missing" 1 1 \
	"$(grep -c '^# missing: 0 samples of sensor 1 and 1 of sensor 2' found.tsv)"
awk 'NR == 99 { $1 = "inf" } { print $1, $2 }' frames.txt | au 10000 2 >inf.au
refused "a sample is infinite" 1 'channel 1, frame 98: not a finite' duet inf.au
head -n 63 frames.txt | au 10000 2 >short.au
refused "63 frames" 1 'at least 64 frames' duet short.au
sensorsim --uniform 100um:100um --number 0 --duration 10s --noise 1V >noise.au
duet noise.au >found.tsv 2>said
scene "noise alone" "no particle, one warning" 1 0 \
	"$(($(column particle found.tsv | wc -l) + $(wc -l <said)))"
awk '{ print $1, $1 }' frames.txt | au 10000 2 >twice.au
refused "the same channel twice, unless it is said to be aligned" 1 'the same at once' duet twice.au
duet --align 0 twice.au >found.tsv
scene "the same channel twice (lag 0)" "20 particles" 20 0 "$(column particle found.tsv | wc -l)"
awk '{ for (i = 1; i <= 2; i++) if ($i > 0.5) $i = 0.5; else if ($i < -0.5) $i = -0.5
	print $1, $2 }' frames.txt | au 10000 2 >clipped.au
duet clipped.au >found.tsv
scene "clipped at half the height" "20 particles" 20 0 "$(score matched)"
scene "clipped at half the height" "sizes to 1 %" 0 0.01 "$(score size_rms)"

# --- scale and rate
for unit in 1e-12 1e12; do
	awk -v u=$unit '{ print $1 * u, $2 * u }' frames.txt | au 10000 2 >scaled.au
	duet --calibration "$(awk -v u=$unit 'BEGIN { print 7.853981633974483e10 * u }')" scaled.au >found.tsv
	scene "volts times $unit" "the same 20 particles" 20 0 "$(score matched)"
	scene "volts times $unit" "sizes to 0.2 %" 0 0.002 "$(score size_rms)"
done
# The same scene at other rates: all times shorter or longer, lengths to match.
for rate in 10 1000 1000000 100000000; do
	t=$(awk -v r=$rate 'BEGIN { print 1e4 / r }')
	scale() { awk -v x="$1" -v t="$t" 'BEGIN { printf "%.12g", x * t }'; }
	sensorsim --rate $rate --uniform 80um:120um --number 20 --duration "$(scale 2)s" \
		--gap "$(scale 0.03)s" --snr 40dB --gain 0.909 --truth truth.tsv \
		--zone "$(scale 0.1273239544735163)" --spacing "$(scale 0.25)" \
		--lag "$(scale 0.0002)s:$(scale 0.0005)s" >s.au
	duet --spacing "$(scale 0.25)" s.au >found.tsv
	limit=$(scale 0.002)
	scene "rate $rate Hz" "20 particles" 20 0 "$(score matched)"
	scene "rate $rate Hz" "delays to 0.06 samples" 0 0.06 \
		"$(awk -v x="$(score delay_rms)" -v r=$rate 'BEGIN { print x * r }')"
	limit=
done
particles --zone 6mm
refused "pulses of 5 samples" 1 'no pulse of at least 8 samples' duet s.au
particles --zone 15mm --span 1.5s
duet s.au >found.tsv
scene "pulses of 12 samples" "20 particles" 20 0 "$(score matched)"

# --- close, equal, far apart
put() { # rows: time diameter velocity
	{ printf 'time\tdiameter\tvelocity\n'; printf '%s\t%s\t%s\n' "$@"; } >p.tsv
}
v=12.5
put 0.1 1e-4 $v 0.2 9e-5 $v 0.3 1.1e-4 $v 0.4 1e-4 $v 0.402 1e-4 $v 0.6 1e-4 $v
sensorsim --noise 10mV --gain 0.909 --truth truth.tsv p.tsv >s.au
duet s.au >found.tsv
scene "equal delays, 2 ms apart" "6 particles" 6 0 "$(score matched)"
scene "equal delays, 2 ms apart" "sizes to 0.3 %" 0 0.003 "$(score size_rms)"
put 0.1 1e-4 $v 0.2 9e-5 $v 0.3 1.1e-4 $v 0.4 1e-4 $v 0.4 1e-4 $v 0.6 1e-4 $v
sensorsim --noise 10mV --gain 0.909 p.tsv >s.au
duet s.au >found.tsv
scene "two particles side by side" "5 rows: they cannot be distinguished" 5 0 \
	"$(column particle found.tsv | wc -l)"
scene "two particles side by side" "one of twice the volume" 1.259921e-4 2e-7 \
	"$(column diameter found.tsv | sed -n 4p)"
# Transit a third longer: 6.6 ms, more than half a period of 100 Hz, (3-10).
put 0.1 1e-4 $v 0.2 9e-5 $v 0.3 1.1e-4 $v 0.4 1e-4 9.4 0.5 1e-4 $v 0.6 1e-4 $v 0.7 1e-4 $v
sensorsim --noise 10mV --gain 0.909 --truth truth.tsv p.tsv >s.au
duet --spread 0.5 s.au >found.tsv
scene "a delay beyond the phase limit" "7 particles" 7 0 "$(score matched)"
scene "a delay beyond the phase limit" "delays to 0.1 samples" 0 1e-5 "$(score delay_rms)"
# 80 dB apart in voltage: 100 um and 4.64 um.
put 0.1 1e-4 $v 0.2 9e-5 $v 0.3 1.1e-4 $v 0.4 4.641589e-6 $v 0.5 1e-4 $v 0.6 1e-4 $v
sensorsim --noise 5uV --gain 0.909 --truth truth.tsv p.tsv >s.au
duet s.au >found.tsv
scene "80 dB apart, one after the other" "6 particles" 6 0 "$(score matched)"
scene "80 dB apart, one after the other" "the small one to 1 %" 4.641589e-6 5e-8 \
	"$(column diameter found.tsv | sort -g | head -n 1)"
put 0.1 1e-4 $v 0.2 9e-5 $v 0.3 1.1e-4 $v 0.4 1e-4 $v 0.405 4.641589e-6 $v 0.6 1e-4 $v
sensorsim --noise 5uV --gain 0.909 --truth truth.tsv p.tsv >s.au
duet s.au >found.tsv
scene "80 dB apart, overlapping" "the five large ones; no other" 5 0 \
	"$(column particle found.tsv | wc -l)"
scene "80 dB apart, overlapping" "sizes of the large ones to 0.1 %" 0 0.001 "$(score size_rms)"

# --- filtered
particles
bpfilter --zero-phase -b 20:1000 --order 4000 s.au >filtered.au
duet filtered.au >found.tsv
scene "a filter of 4001 taps, its inverse longer than the record" "18 to 20 particles" 20 2 \
	"$(score matched)"
scene "a filter of 4001 taps, its inverse longer than the record" "no false particle" 0 0 "$(score false)"
scene "a filter of 4001 taps, its inverse longer than the record" "delays to 0.06 samples" 0 6e-6 \
	"$(score delay_rms)"
bpfilter --zero-phase -b 95:105 --order 800 s.au >filtered.au
refused "a tenth of the band of the pulses left" 1 "too narrow a band" duet filtered.au
# A low-pass of one pole delays low frequencies more than high ones: no filter that is
# undone, but its pulses are of one form, which is learned.
pole() { # SHARE
	frames s.au 2 | awk -v a="$1" '{ x += a * ($1 - x); y += a * ($2 - y)
		printf "%.17g %.17g\n", x, y }' | au 10000 2 >pole.au
	duet pole.au >found.tsv
}
for share in 0.5 0.1; do
	pole $share
	scene "one-pole low-pass, a = $share, filter not stated" "20 particles" 20 0 "$(score matched)"
	scene "one-pole low-pass, a = $share, filter not stated" "no false particle" 0 0 "$(score false)"
	scene "one-pole low-pass, a = $share, filter not stated" "delays to 0.06 samples" 0 6e-6 \
		"$(score delay_rms)"
done
pole 0.03
limit=0.005 # it delays by 1.9 ms
scene "one-pole low-pass, a = 0.03, filter not stated" "16 to 20 particles" 18 2 "$(score matched)"
scene "one-pole low-pass, a = 0.03, filter not stated" "no false particle" 0 0 "$(score false)"
scene "one-pole low-pass, a = 0.03, filter not stated" "delays to 0.1 samples" 0 1e-5 "$(score delay_rms)"
limit=

# --- many

sensorsim --uniform 80um:120um --number 100 --gap 6ms --span 0.8s --duration 1.2s --snr 40dB \
	--lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv >s.au
duet s.au >found.tsv
scene "100 particles in one section, 8 ms apart" "at least 98" 100 2 "$(score matched)"
scene "100 particles in one section, 8 ms apart" "no false particle" 0 2 "$(score false)"
sensorsim --uniform 80um:120um --number 4000 --duration 2s --snr 40dB --truth truth.tsv >s.au
duet s.au >found.tsv
scene "2000 particles a second, 20 at once" "unresolved, no false particle" 0 0 "$(score found)"

# --- masks
particles
refused "masks of 4 samples" 1 'want a --window of at least half' \
	duet --method duet --window 4 --hop 1 s.au
duet --method duet --window 100000 s.au >found.tsv
scene "masks longer than the record" "all 20 found" 20 0 "$(score matched)"
scene "masks longer than the record" "no false particle" 0 0 "$(score false)"

# --- long: memory does not grow, time does not drift
memory() { # SECONDS
	sensorsim --uniform 80um:120um --number $(($1 * 2)) --duration "$1s" --gap 30ms \
		--snr 40dB --lag 0.2ms:0.5ms --truth truth.tsv | duet -S stats >found.tsv
	column_of memory <stats
}
column_of() {
	awk -F '\t' -v c="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ c) k = i; next }
	{ print $k }'
}
# How much of its buffers a short record touches depends on how the pipe is read, and the
# first pulses decide what is learned from: a long record may need less.
m1=$({ memory 20; memory 20; memory 20; } | sort -n | tail -n 1)
m2=$(memory 200)
scene "200 s instead of 20 s" "memory grows by less than a tenth" 0 0.1 \
	"$(awk -v a="$m1" -v b="$m2" 'BEGIN { print (b > a ? b / a - 1 : 0) }')"
scene "200 s" "400 particles" 400 0 "$(score matched)"
scene "200 s" "arrivals to 0.05 samples" 0 5e-6 "$(score time1_rms)"
# --- four channels: permeability and skin depth
# phase DIAMETER NOISE OPTION...: worst error of the phase of 20 particles, rad
phase() {
	awk -v d="$1" 'BEGIN { print "time\tdiameter"; for (i = 0; i < 20; i++) print 0.1 + 0.08 * i "\t" d }' >table
	noise=$2
	shift 2
	sensorsim --noise "$noise" --lag 0:0.5ms --quadrature --truth truth.tsv "$@" table >four.au
	duet four.au >found.tsv 2>err
	column phase truth.tsv >want
	column phase found.tsv | paste want - | awk '{ d = $1 - $2; d -= 6.283185307 * sprintf("%.0f", d / 6.283185307)
		if (d < 0) d = -d; if (!(d <= m)) m = d } END { printf "%.6f", NR == 20 ? m : 9 }'
}
scene "mur 1, radius of 1e-4 skin depths" "phase: a quarter of a turn" 0 0.02 "$(
	phase 100e-6 6.7e-12V --mur 1 --sigma 5.8e7 --excitation 0.01747Hz)"
scene "mur 1e5, radius of 1e-4 skin depths" "phase of ferrous particles" 0 0.02 "$(
	phase 100e-6 10mV --mur 1e5 --sigma 5.8e7 --excitation 1.747e-7Hz)"
scene "mur 1e5, radius of 1e4 skin depths" "its phase" 0 0.02 "$(
	phase 5e-3 10mV --calibration 1e6 --mur 1e5 --sigma 1e9 --excitation 40.5Hz)"
printf 'time\tdiameter\tvelocity\n0.1\t1e-4\t1e300\n' >fast.tsv
refused "a particle of 1e300 m/s" 1 "100 times" sensorsim --duration 1s fast.tsv
scene "mur 1, radius of 1e4 skin depths" "phase: half a turn" 0 0.02 "$(
	phase 5e-3 5mV --calibration 1e6 --mur 1 --sigma 1e9 --excitation 4.05MHz)"
scene "mur 1, radius of 1e4 skin depths" "none of 20 is ferrous" 0 0 "$(column class found.tsv | grep -c '^ferrous')"
done_testing
