#!/bin/sh
# Stiff and extreme scenes of sensorsim and bpfilter: accurate, or refused in one line.
. "$(dirname "$0")/../tap.sh"
. "$top/tests/extremes/scenes.sh"
. "$top/tests/au.sh"

# level FREQUENCY OPTION...: gain in dB, by the nearest row of the response
level() {
	f=$1
	shift
	bpfilter --response "$@" | awk -F '\t' -v f="$f" '!/^[#f]/ { d = $1 - f; if (d < 0) d = -d
		if (!n++ || d < best) { best = d; level = $3 } } END { print level }'
}

repeat() {
	awk -v n="$1" -v x="$2" 'BEGIN { for (i = 0; i < n; i++) print x }'
}

# --- the filter's own limits
scene "rate 10 Hz, band 1-2 Hz, order 20" "0 dB at 1.5 Hz" 0 1e-12 \
	"$(level 1.5 -r 10 -b 1:2 --order 20 --grid 501)"
scene "rate 100 MHz, band 20-30 MHz" "0 dB at 25 MHz" 0 1e-12 \
	"$(level 25e6 -r 100MHz -b 20MHz:30MHz --grid 501)"
# all taps nearly the window's: gain 1 at 100 Hz, and hardly less at 0
scene "rate 100 MHz, band 70-130 Hz, order 20000: far narrower than the transition" \
	"0 dB at 0 Hz too" 0 0.01 "$(level 0 -r 100MHz --order 20000 --grid 2)"
scene "band of 1 mHz at 10 kHz, order 200" "0 dB at 100 Hz" 0 1e-5 \
	"$(level 100 -b 100Hz:100.001Hz --grid 501)"
scene "band edges at 0 and half the rate" "no change" 0 3e-15 "$(
	awk 'BEGIN { for (i = 0; i < 3000; i++) print cos(i * i) }' >in
	au 10000 1 <in | bpfilter -b 0:5000 --zero-phase >out.au
	frames out.au >got
	worst in got)"
scene "low edge 0: low-pass" "0 dB at 0 Hz" 0 1e-12 "$(level 0 -b 0:100)"
scene "high edge at half the rate: high-pass" "0 dB there" 0 1e-12 "$(level 5000 -b 4000:5000)"
for n in 2 20 200 2000 20000; do
	scene "order $n" "sine of 100 Hz, amplitude 1" 1 2e-4 "$(
		# 12 periods after the filter has filled
		awk -v n="$n" 'BEGIN { for (i = 0; i < n + 1200; i++)
			print sin(6.283185307179586 * i / 100) }' | au 10000 1 |
			bpfilter --order "$n" -b 90:110 >out.au
		frames out.au | tail -1200 | awk '{ s += $1 * $1 } END { printf "%.9f", sqrt(2 * s / NR) }')"
done
refused "band edges in descending order" 2 'first edge' bpfilter -b 130:70 in
refused "equal band edges" 2 'first edge' bpfilter -b 100:100 in
repeat 10 0 | au 100 1 >slow.au
refused "band above half the rate" 1 'above half the rate' bpfilter slow.au

# --- stiff signals
repeat 5000 0 | au 10000 1 | bpfilter >out.au
scene "silence" "exactly 0" 0 0 "$(frames out.au | awk '$1 != 0' | wc -l)"
repeat 5000 1e6 | au 10000 1 | bpfilter >out.au
dc=$(bpfilter --response --grid 2 | awk -F '\t' '$1 == 0 { printf "%.12g", $2 * 1e6 }')
scene "constant of 1 MV" "response at 0 Hz" "$dc" 1e-7 "$(frames out.au | tail -1)"
awk 'BEGIN { for (i = 0; i < 4000; i++) { x = 3 * sin(6.283185307179586 * i / 100)
	print (x > 1 ? 1 : x < -1 ? -1 : x) } }' | au 10000 1 | bpfilter --order 2000 -b 90:110 >out.au
# the Fourier coefficient of a sine of 3 clipped at 1: (2/pi)(3 asin(1/3) + sqrt(1 - 1/9))
want=$(awk 'BEGIN { a = atan2(1 / 3, sqrt(8 / 9)); printf "%.9f", (6 * a + 2 * sqrt(8 / 9)) / 3.14159265358979 }')
scene "clipped sine" "its fundamental" "$want" 1e-3 \
	"$(frames out.au | tail -1000 | awk '{ s += $1 * $1 } END { printf "%.9f", sqrt(2 * s / NR) }')"
awk 'BEGIN { for (i = 0; i < 3000; i++) print sin(i / 9), 0 }' | au 10000 2 | bpfilter >out.au
scene "one channel dead" "exactly 0" 0 0 "$(frames out.au 2 | awk '$2 != 0' | wc -l)"
repeat 3000 tiny | au 10000 1 >tiny.au && bpfilter -b 0:130 tiny.au >low.au
scene "samples below 1e-308" "no crash, nothing large" 0 1e-300 "$(frames low.au | sort -g | tail -1)"
scene "samples of 1e280" "gain 1 at 0 Hz" 1 1e-13 "$(repeat 3000 1e280 | au 10000 1 |
	bpfilter -b 0:130 >out.au && frames out.au | tail -1 | awk '{ printf "%.15g", $1 / 1e280 }')"
repeat 300 1.7e308 | au 10000 1 >huge.au
refused "samples that would overflow" 1 'huge.au: frame 0, channel 1' bpfilter huge.au
(repeat 4000 0; echo nan; repeat 4000 0) | au 10000 1 >nan.au
refused "one sample is not a number" 1 'nan.au: frame 4000, channel 1' bpfilter nan.au
repeat 1 1 | au 10000 1 | bpfilter --zero-phase >out.au
scene "one frame, delay taken out" "one frame" 1 0 "$(frames out.au | wc -l)"
: | au 10000 1 | bpfilter --zero-phase >out.au
scene "no frames" "no frames" 0 0 "$(frames out.au | wc -l)"
awk 'BEGIN { for (i = 0; i < 300; i++) { for (c = 0; c < 64; c++) printf "%d ", i == c; print "" } }' |
	au 10000 64 | bpfilter --order 20 -b 0:5000 --zero-phase >out.au
scene "64 channels" "each its own impulse" 0 1e-15 "$(frames out.au 64 | awk '
	NR <= 64 { for (c = 1; c <= 64; c++) { d = $c - (c == NR); if (d < 0) d = -d; if (d > m) m = d } }
	END { print m }')"

# --- long streams
printf 'time\tdiameter\n3\t1e-4\n21595.0005\t1e-4\n' >hours.tsv
sensorsim -r 1kHz --duration 6h -S sim.stats hours.tsv | bpfilter -b 0:500 --zero-phase -S filter.stats | head -c -16 | tail -c 160000 >last
kilobytes="$(column memory_kb sim.stats) and $(column memory_kb filter.stats) kB"
is "6 h at 1 kHz | constant memory | $kilobytes | none" \
	"$(echo "$kilobytes" | awk '{ print ($1 < 20000 && $3 < 20000) }')" 1
scene "6 h at 1 kHz" "all frames" 21600000 0 "$(column frames filter.stats)"
# its zero is half a frame after frame 21595000: +-sin(pi / 10) on either side
head -c 24 slow.au | cat - last >end.au
scene "a particle at the end of 6 h" "no drift in time" 0.309016994374947 1e-7 \
	"$(frames end.au 2 | sed -n 5001p | cut -f 1)"
scene "a particle at the end of 6 h" "its second lobe" -0.309016994374947 1e-7 \
	"$(frames end.au 2 | sed -n 5002p | cut -f 1)"

# --- the simulator's limits
scene "sampled at 10 Hz: pulses fall between samples" "silence" 0 0 "$(
	printf 'time\tdiameter\n1.05\t1e-4\n' | sensorsim -r 10 --duration 3 >out.au
	frames out.au 2 | awk '$1 != 0 || $2 != 0' | wc -l)"
scene "sampled at 100 MHz" "peak of 1 V" 1 1e-12 "$(
	printf 'time\tdiameter\n0.005\t1e-4\n' | sensorsim -r 100MHz --duration 3ms >out.au
	frames out.au 2 | awk '$1 > peak { peak = $1 } END { printf "%.15g", peak }')"
scene "1000 particles at one moment" "1000 times the voltage" 1000 1e-9 "$(
	sensorsim --uniform 100um:100um --number 1000 --span 0 --start 10ms --duration 30ms >out.au
	frames out.au 2 | awk 'NR == 76 { printf "%.12f", $1 }')"
scene "1e5 particles a second for 2 s" "sum of the amplitudes squared" 1 0.05 "$(
	sensorsim --uniform 50um:150um --number 200000 --duration 2.03s --truth dense.tsv >out.au
	# Campbell: variance = rate * mean A^2 * integral of p^2 = T/2
	want=$(column amplitude dense.tsv | awk '{ s += $1 * $1 } END { print s / 2 * 0.005 }')
	frames out.au 2 | sed -n 201,19800p | awk -v w="$want" '{ s += $1 * $1 } END { print s / NR / w }')"
scene "particle of 1 nm" "1e-15 V" 1 1e-9 "$(sensorsim --uniform 1nm:1nm --number 1 --duration 1 --truth - |
	awk -F '\t' '$1 == "0" { print $5 / 1e-15 }')"
scene "sensor 2 dead" "silence" 0 0 "$(sensorsim --gain 0 --uniform 1um:9um --number 9 --duration 1 >out.au
	frames out.au 2 | awk '$2 != 0' | wc -l)"
scene "laminar flow: slowest particle of 20000" "no slower than 3.98 % of the mean" 1 0 "$(
	sensorsim --uniform 50um:50um --number 20000 --duration 100 --profile laminar --truth - | column velocity /dev/stdin |
		awk 'NR == 1 || $1 < m { m = $1 } END { print (m > 0.0397 * 12.732 && m < 0.2 * 12.732) }')"
scene "lorentz pulse" "its tails reach 25 durations" 0 1e-6 "$(
	printf 'time\tdiameter\n0.3\t1e-4\n' | sensorsim --pulse lorentz --duration 0.6 >out.au
	frames out.au 2 | awk 'NR == 503 { x = 3.141592653589793 * 2 * (0.0502 - 0.3) / 0.01
		print $1 + 3.0792014356780 * x / (1 + x * x) ^ 2 }')"
scene "line at half the rate" "alternates" 0 1e-9 "$(
	sensorsim --uniform 1um:1um --number 0 --duration 1 -r 1000 --mains-frequency 500 --mains 1 >out.au
	frames out.au 2 | awk 'NR > 1 { d = $1 + old; if (d < 0) d = -d; if (d > m) m = d } { old = $1 }
		END { print (NR > 1 ? m + 0 : "no rows") }')"
refused "a particle that stands still" 2 'slower than' \
	sensorsim --uniform 1um:1um --number 1 --duration 1 --lag 10s:20s
refused "a particle as wide as the pipe" 2 'bore' sensorsim --uniform 1cm:1cm --number 1 --duration 1
refused "more particles than room" 2 'no room' sensorsim --uniform 1um:1um --number 1e9 --gap 1us --duration 1

done_testing
