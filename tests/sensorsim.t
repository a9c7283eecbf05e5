#!/bin/sh
# sensorsim: pulses, pipe, scenes, noise, lines, tables, bad input
. "${0%/*}/tap.sh"
. "$top/tests/au.sh"

# level FILE FREQUENCY COLUMN: amplitude of a line over whole periods
level() {
	awk -v f="$2" -v c="$3" -v rate=10000 '{
		a = 6.283185307179586 * f * (NR - 1) / rate; re += $c * cos(a); im += $c * sin(a)
	} END { print 2 * sqrt(re * re + im * im) / NR }' "$1"
}

# one particle of 100 um: u = sin(2 pi (t0 - t) / 10 ms), 1 V, then 0.909 V 19.635 ms later
printf 'time\tdiameter\n0.01234\t1e-4\n' >one.tsv
sensorsim --gain 0.909 --duration 60ms --truth truth.tsv one.tsv >one.au
frames one.au 2 >one.txt
is "frames of the record" "$(wc -l <one.txt)" 600
worst=$(awk 'function p(t) { return t > -0.005 && t < 0.005 ? -sin(628.3185307179587 * t) : 0 }
	{ t = (NR - 1) / 10000; d = $1 - p(t - 0.01234)
	  e = $2 - 0.909 * p(t - 0.01234 - 0.25 / (1e-3 / (3.141592653589793 / 4 * 1e-4)))
	  if (d < 0) d = -d; if (e < 0) e = -e; if (d > m) m = d; if (e > m) m = e }
	END { print m }' one.txt)
near "one particle is one sine period at each sensor" "$worst" 0 1e-13
near "truth: delay of 25 cm at 60 L/min in 1 cm" "$(column delay truth.tsv)" 0.0196349540849 1e-12
near "truth: velocity" "$(column velocity truth.tsv)" 12.7323954473516 1e-10
near "truth: amplitude" "$(column amplitude truth.tsv)" 1 1e-12
near "truth: volume" "$(column volume truth.tsv)" 5.23598775598e-13 1e-22

# amplitude grows with the cube of the diameter
printf 'time\tdiameter\n0.01\t2e-4\n' | sensorsim --truth - >big.tsv
near "twice the diameter is eight times the voltage" "$(column amplitude big.tsv)" 8 1e-11

# scenes
sensorsim --uniform 79.37um:114.471um --by volume --number 200 --burst 2 --span 10ms --gap 1ms \
	--period 100ms --lag 0.2ms:0.5ms --gain 0.909 --snr 30dB --truth pairs.tsv >pairs.au
is "pairs: number of particles" "$(column time1 pairs.tsv | wc -l)" 200
column time1 pairs.tsv | awk 'NR % 2 { a = $1; if (a < 0.005 + (NR - 1) / 2 * 0.1 - 1e-9) bad++ }
	NR % 2 == 0 { if ($1 - a < 0.001 - 1e-12 || $1 - a > 0.01 + 1e-12) bad++; sum += $1 - a }
	END { print bad + 0, sum / (NR / 2) }' >spacing
is "pairs: none closer than the gap, none beyond the span" "$(cut -d' ' -f1 spacing)" 0
# the gap plus a third of the 9 ms that are free; standard error 0.2 ms
near "pairs: mean distance" "$(cut -d' ' -f2 spacing)" 4e-3 8e-4
column amplitude pairs.tsv | awk '{ s += $1; if ($1 < 0.48 || $1 > 1.5001) bad++ }
	END { print bad + 0, s / NR }' >amplitudes
is "pairs: amplitudes from 0.5 to 1.5" "$(cut -d' ' -f1 amplitudes)" 0
near "pairs: mean amplitude" "$(cut -d' ' -f2 amplitudes)" 0.982 0.06
column delay pairs.tsv | awk '{ d = $1 * 1e4 - 196.34954; if (d < 2 || d > 5) bad++; s += d }
	END { print bad + 0, s / NR }' >delays
is "pairs: 2 to 5 samples slower than the oil" "$(cut -d' ' -f1 delays)" 0
near "pairs: mean residual delay" "$(cut -d' ' -f2 delays)" 3.5 0.2
sensorsim --uniform 100um:100um --number 5 --gap 2ms --span 8ms --truth - >even.tsv
column time1 even.tsv | awk 'NR > 1 { printf "%.6f ", $1 - t } { t = $1 }' >even
is "a span without freedom spaces evenly" "$(cat even)" "0.002000 0.002000 0.002000 0.002000 "
sensorsim --concentration 250mg/L --density 3g/cm3 --uniform 100um:100um --duration 1s -S st --truth - >mass.tsv
# 1 L/s of 0.25 g/L over 1.5708 ug; the window is 1 s less one transit and one pulse
near "concentration gives the number" "$(column time1 mass.tsv | wc -l)" 154436 1600

# a truth table is a scene; realisations and seeds differ
sensorsim --gain 0.909 --snr 30dB --duration 19.95s pairs.tsv >again.au
frames pairs.au 2 | head -20000 >a
frames again.au 2 | head -20000 >b
same "a truth table rebuilds its signal" a b
sensorsim --uniform 50um:150um --number 20 --duration 1s --truth a >/dev/null
sensorsim --uniform 50um:150um --number 20 --duration 1s --truth b -f 1 >/dev/null
sensorsim --uniform 50um:150um --number 20 --duration 1s --truth c -s 2 >/dev/null
ok "realisations and seeds differ" sh -c '! tail -1 a | cmp -s - b && ! tail -1 a | grep -qf - b &&
	! tail -1 a | grep -qf - c'
sensorsim --truth - --uniform 50um:150um --number 20 --duration 1s >d
tail -20 a >a20
tail -20 d >d20
same "--truth - gives the same particles" a20 d20

# pipe profiles: the flow-weighted mean velocity of even mixing
sensorsim --uniform 50um:50um --number 20000 --duration 1000 --profile laminar --truth - | column velocity /dev/stdin >v
# <v^2>/<v> = 4/3 U, sd 0.48 U, less what is nearer than 1 % to the wall
near "laminar: mean velocity of the particles" "$(awk '{ s += $1 } END { print s / NR / 12.7324 }' v)" \
	1.3335 0.014
sensorsim --uniform 50um:50um --number 20000 --duration 1000 --profile turbulent --truth - | column velocity /dev/stdin >v
# (60/49)^2 * <y^(2/7)> = 1.4994 * 49/72 = 1.0204
near "turbulent: mean velocity of the particles" "$(awk '{ s += $1 } END { print s / NR / 12.7324 }' v)" \
	1.021 0.005

# disturbances
sensorsim --uniform 1um:1um --number 0 --duration 10 --noise 0.1 --common 0.5 | cat >noise.au
frames noise.au 2 >noise.txt
awk '{ a += $1; b += $2; aa += $1 * $1; bb += $2 * $2; ab += $1 * $2; if (NR > 1) lag += $1 * old; old = $1 }
	END { print sqrt(aa / NR), sqrt(bb / NR), ab / sqrt(aa * bb), lag / aa, a / NR }' noise.txt >moments
near "noise: rms of sensor 1" "$(cut -d' ' -f1 moments)" 0.1 0.001
near "noise: rms of sensor 2" "$(cut -d' ' -f2 moments)" 0.1 0.001
near "noise: correlation of the sensors" "$(cut -d' ' -f3 moments)" 0.5 0.012
near "noise: white" "$(cut -d' ' -f4 moments)" 0 0.015
near "noise: no offset" "$(cut -d' ' -f5 moments)" 0 0.0015
sensorsim --uniform 1um:1um --number 0 --duration 10 --noise 0.1 --corner 500Hz | cat >color.au
frames color.au 2 | awk '{ aa += $1 * $1; if (NR > 1) lag += $1 * old; old = $1 }
	END { print sqrt(aa / NR), lag / aa }' >moments
near "coloured noise: rms" "$(cut -d' ' -f1 moments)" 0.1 0.003
near "coloured noise: exp(-2 pi corner / rate)" "$(cut -d' ' -f2 moments)" 0.7304 0.01
sensorsim --uniform 1um:1um --number 0 --duration 2 --mains 0.5,0.3,0.05 --pump 0.2,0.1 >lines.au
frames lines.au 2 >lines.txt
for line in 50:0.5 150:0.3 250:0.05 2000:0.2 4000:0.1; do
	near "line at ${line%:*} Hz" "$(level lines.txt "${line%:*}" 2)" "${line#*:}" 1e-10
done
sensorsim --uniform 1um:1um --number 0 --duration 200 -r 100 --drift 1 --drift-time 1s >drift.au
frames drift.au 2 | awk '{ aa += $1 * $1; h[NR] = $1; if (NR > 100) lag += $1 * h[NR - 100] }
	END { print sqrt(aa / NR), lag / aa }' >moments
# 200 correlation times: the standard error of both is about 0.1
near "drift: rms" "$(cut -d' ' -f1 moments)" 1 0.25
near "drift: correlation after its time" "$(cut -d' ' -f2 moments)" 0.3679 0.25

# (3-1) by the coils: 2 N ND I mu0 (mur-1)/mur (pi/6) (pi/2) b / L
sensorsim --uniform 100um:100um --number 1 --duration 1 --truth - --coil 200,150,0.3A,2000,5mm,9mm,1e6 >coil.tsv
want=$(awk 'BEGIN { pi = 3.14159265358979; b = 1 / 25e-6 - 1 / 81e-6
	k = 2 * 200 * 150 * 0.3 * 1.25663706212e-6 * 1999 / 2000 * pi / 6 * pi / 2 * b / (0.4 / pi) * 1e6
	printf "%.12g", k * 1e-12 * 0.04 / pi * 1e3 }')
near "amplitude by the coils" "$(column amplitude coil.tsv)" "$want" 1e-9

# work done and left out
sensorsim --uniform 50um:150um --number 10 --duration 100 -S stats >/dev/null
near "each pulse touches its own samples" "$(column pulse_samples stats)" 2000 20
is "constant memory" "$(column particles_pending stats | awk '{ print $1 <= 10 }')" 1

# what it refuses
fails "no table" 1 'none.tsv' sensorsim none.tsv
printf 'time\tsize\n0\t1\n' >bad.tsv
fails "no diameter column" 1 'diameter' sensorsim bad.tsv
printf 'time\tdiameter\n0.02\t1e-4\n0.01\t1e-4\n' >bad.tsv
fails "times out of order" 1 'bad.tsv: line 3: time' sensorsim bad.tsv
printf 'time\tdiameter\n0.02\t-1e-4\n' >bad.tsv
fails "negative diameter" 1 'bad.tsv: line 2: diameter' sensorsim bad.tsv
printf 'time\tdiameter\n0.02\tnan\n' >bad.tsv
fails "missing diameter" 1 'bad.tsv: line 2: diameter' sensorsim bad.tsv
printf 'time\tdiameter\tvelocity\n0.02\t1e-4\t0.01\n' >bad.tsv
fails "a particle that stands still" 1 'bad.tsv: line 2: velocity' sensorsim bad.tsv
fails "a particle as wide as the pipe" 2 'bore' sensorsim --uniform 1cm:2cm --number 1 --duration 1
fails "neither number nor concentration" 2 'number' sensorsim --uniform 1um:2um --duration 1
fails "no window" 2 'duration' sensorsim --uniform 1um:2um --number 3
fails "a window too short" 2 'no room' sensorsim --uniform 1um:2um --number 300 --gap 10ms --duration 1
fails "a line above half the rate" 2 '^sensorsim: --pump: a line at 4000 Hz is above half the rate, 2500 Hz$' \
	sensorsim -r 5000 --pump 0.1,0.1 --uniform 1um:1um --number 1 --duration 1
is "leaves no stream that looks whole" "$(wc -c <out)" 0
fails "one of two ways to say how many" 2 'needs one of --number and --concentration' \
	sensorsim --uniform 1um:1um --number 1 --concentration 1 --duration 1
fails "a full disk" 1 'o space' sh -c 'sensorsim --uniform 1um:1um --number 1 --duration 1 >/dev/full'

printf 'time\tdiameter\n1e300\t1e-4\n' >never.tsv
fails "a particle after the end of days" 1 'line 2: time 1e+300 s, want times in order, up to 1e9 s' \
	sensorsim never.tsv
done_testing
