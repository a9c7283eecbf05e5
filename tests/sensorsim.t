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
is "the record has the requested number of frames" "$(wc -l <one.txt)" 600
worst=$(awk 'function p(t) { return t > -0.005 && t < 0.005 ? -sin(628.3185307179587 * t) : 0 }
	{ t = (NR - 1) / 10000; d = $1 - p(t - 0.01234)
	  e = $2 - 0.909 * p(t - 0.01234 - 0.25 / (1e-3 / (3.141592653589793 / 4 * 1e-4)))
	  if (d < 0) d = -d; if (e < 0) e = -e; if (d > m) m = d; if (e > m) m = e }
	END { print m }' one.txt)
near "one particle is one sine period at each sensor" "$worst" 0 1e-13
near "truth: the delay is that of 25 cm at 60 L/min in 1 cm" "$(column delay truth.tsv)" 0.0196349540849 1e-12
near "truth: the velocity is that of the oil" "$(column velocity truth.tsv)" 12.7323954473516 1e-10
near "truth: the amplitude is that of the pulse" "$(column amplitude truth.tsv)" 1 1e-12
near "truth: the volume is that of the sphere" "$(column volume truth.tsv)" 5.23598775598e-13 1e-22

# amplitude grows with the cube of the diameter
printf 'time\tdiameter\n0.01\t2e-4\n' | sensorsim --truth - >big.tsv
near "twice the diameter gives eight times the voltage" "$(column amplitude big.tsv)" 8 1e-11

# scenes
sensorsim --uniform 79.37um:114.471um --by volume --number 200 --burst 2 --span 10ms --gap 1ms \
	--period 100ms --lag 0.2ms:0.5ms --gain 0.909 --snr 30dB --truth pairs.tsv >pairs.au
is "pairs: the number of particles is right" "$(column time1 pairs.tsv | wc -l)" 200
column time1 pairs.tsv | awk 'NR % 2 { a = $1; if (a < 0.005 + (NR - 1) / 2 * 0.1 - 1e-9) bad++ }
	NR % 2 == 0 { if ($1 - a < 0.001 - 1e-12 || $1 - a > 0.01 + 1e-12) bad++; sum += $1 - a }
	END { print bad + 0, sum / (NR / 2) }' >spacing
is "pairs: distances are between the gap and the span" "$(cut -d' ' -f1 spacing)" 0
# the gap plus a third of the 9 ms that are free; standard error 0.2 ms
near "pairs: the mean distance is that of a uniform distribution" "$(cut -d' ' -f2 spacing)" 4e-3 8e-4
column amplitude pairs.tsv | awk '{ s += $1; if ($1 < 0.48 || $1 > 1.5001) bad++ }
	END { print bad + 0, s / NR }' >amplitudes
is "pairs: amplitudes are between 0.5 and 1.5" "$(cut -d' ' -f1 amplitudes)" 0
near "pairs: the mean amplitude is 0.98" "$(cut -d' ' -f2 amplitudes)" 0.982 0.06
column delay pairs.tsv | awk '{ d = $1 * 1e4 - 196.34954; if (d < 2 || d > 5) bad++; s += d }
	END { print bad + 0, s / NR }' >delays
is "pairs: delays are 2 to 5 samples longer than that of the oil" "$(cut -d' ' -f1 delays)" 0
near "pairs: the mean residual delay is right" "$(cut -d' ' -f2 delays)" 3.5 0.2
sensorsim --uniform 100um:100um --number 5 --gap 2ms --span 8ms --truth - >even.tsv
column time1 even.tsv | awk 'NR > 1 { printf "%.6f ", $1 - t } { t = $1 }' >even
is "a span without freedom spaces particles equally" "$(cat even)" "0.002000 0.002000 0.002000 0.002000 "
sensorsim --concentration 250mg/L --density 3g/cm3 --uniform 100um:100um --duration 1s -S st --truth - >mass.tsv
# 1 L/s of 0.25 g/L over 1.5708 ug; the window is 1 s less one transit and one pulse
near "the concentration determines the number" "$(column time1 mass.tsv | wc -l)" 154436 1600
is "clean oil carries no particle" "$(timeout 20 sensorsim --concentration 0 --uniform 100um:100um \
	--duration 1s --truth - | column time1 /dev/stdin | wc -l)" 0

# The second sensor is 20 ms behind the first, and half a pulse some milliseconds long.
printf 'time\tdiameter\n-0.05\t1e-4\n-0.04\t1e-4\n-0.02\t1e-4\n0.1\t1e-4\n' | sensorsim --duration 1s --truth early.tsv >early.au
is "particles that passed before the record begins are not in the truth" \
	"$(column particle early.tsv | tr '\n' ' ')" "2 3 "
# a truth table is a scene; realisations and seeds differ
sensorsim --gain 0.909 --snr 30dB --duration 19.95s pairs.tsv >again.au
frames pairs.au 2 | head -20000 >a
frames again.au 2 | head -20000 >b
same "a table of truth reproduces its signal" a b
sensorsim --uniform 50um:150um --number 20 --duration 1s --truth a >/dev/null
sensorsim --uniform 50um:150um --number 20 --duration 1s --truth b -f 1 >/dev/null
sensorsim --uniform 50um:150um --number 20 --duration 1s --truth c -s 2 >/dev/null
ok "realisations and seeds differ" sh -c 'grep "^19" a >last && ! grep -qf last b && ! grep -qf last c'
sensorsim --truth - --uniform 50um:150um --number 20 --duration 1s >d
grep -v '^#' a >a20
grep -v '^#' d >d20
same "--truth - gives the same particles" a20 d20

# pipe profiles: the flow-weighted mean velocity of even mixing
sensorsim --uniform 50um:50um --number 20000 --duration 1000 --profile laminar --truth - | column velocity /dev/stdin >v
# <v^2>/<v> = 4/3 U, sd 0.48 U, less what is nearer than 1 % to the wall
near "laminar: the mean velocity of the particles is right" "$(awk '{ s += $1 } END { print s / NR / 12.7324 }' v)" \
	1.3335 0.014
sensorsim --uniform 50um:50um --number 20000 --duration 1000 --profile turbulent --truth - | column velocity /dev/stdin >v
# (60/49)^2 * <y^(2/7)> = 1.4994 * 49/72 = 1.0204
near "turbulent: the mean velocity of the particles is right" "$(awk '{ s += $1 } END { print s / NR / 12.7324 }' v)" \
	1.021 0.005

# disturbances
sensorsim --uniform 1um:1um --number 0 --duration 10 --noise 0.1 --common 0.5 | cat >noise.au
frames noise.au 2 >noise.txt
awk '{ a += $1; b += $2; aa += $1 * $1; bb += $2 * $2; ab += $1 * $2; if (NR > 1) lag += $1 * old; old = $1 }
	END { print sqrt(aa / NR), sqrt(bb / NR), ab / sqrt(aa * bb), lag / aa, a / NR }' noise.txt >moments
near "noise: the rms of sensor 1 is right" "$(cut -d' ' -f1 moments)" 0.1 0.001
near "noise: the rms of sensor 2 is right" "$(cut -d' ' -f2 moments)" 0.1 0.001
near "noise: the correlation of the sensors is right" "$(cut -d' ' -f3 moments)" 0.5 0.012
near "noise: it is white" "$(cut -d' ' -f4 moments)" 0 0.015
near "noise: it has no offset" "$(cut -d' ' -f5 moments)" 0 0.0015
sensorsim --uniform 1um:1um --number 0 --duration 10 --noise 0.1 --corner 500Hz | cat >color.au
frames color.au 2 | awk '{ aa += $1 * $1; if (NR > 1) lag += $1 * old; old = $1 }
	END { print sqrt(aa / NR), lag / aa }' >moments
near "coloured noise: the rms is unchanged" "$(cut -d' ' -f1 moments)" 0.1 0.003
near "coloured noise: the correlation is exp(-2 pi corner / rate)" "$(cut -d' ' -f2 moments)" 0.7304 0.01
sensorsim --uniform 1um:1um --number 0 --duration 2 --mains 0.5,0.3,0.05 --pump 0.2,0.1 >lines.au
frames lines.au 2 >lines.txt
for line in 50:0.5 150:0.3 250:0.05 2000:0.2 4000:0.1; do
	near "the line at ${line%:*} Hz has its amplitude" "$(level lines.txt "${line%:*}" 2)" "${line#*:}" 1e-10
done
sensorsim --uniform 1um:1um --number 0 --duration 200 -r 100 --drift 1 --drift-time 1s >drift.au
frames drift.au 2 | awk '{ aa += $1 * $1; h[NR] = $1; if (NR > 100) lag += $1 * h[NR - 100] }
	END { print sqrt(aa / NR), lag / aa }' >moments
# 200 correlation times: the standard error of both is about 0.1
near "drift: the rms is right" "$(cut -d' ' -f1 moments)" 1 0.25
near "drift: the correlation after the correlation time is 1/e" "$(cut -d' ' -f2 moments)" 0.3679 0.25

# (3-1) by the coils: 2 N ND I mu0 (mur-1)/mur (pi/6) (pi/2) b / L
sensorsim --uniform 100um:100um --number 1 --duration 1 --truth - --coil 200,150,0.3A,2000,5mm,9mm,1e6 >coil.tsv
want=$(awk 'BEGIN { pi = 3.14159265358979; b = 1 / 25e-6 - 1 / 81e-6
	k = 2 * 200 * 150 * 0.3 * 1.25663706212e-6 * 1999 / 2000 * pi / 6 * pi / 2 * b / (0.4 / pi) * 1e6
	printf "%.12g", k * 1e-12 * 0.04 / pi * 1e3 }')
near "the amplitude follows from the parameters of the coils" "$(column amplitude coil.tsv)" "$want" 1e-9

# work done and left out
sensorsim --uniform 50um:150um --number 10 --duration 100 -S stats >/dev/null
near "each pulse is computed only at its own samples" "$(column pulse_samples stats)" 2000 20
is "memory is constant" "$(column particles_pending stats | awk '{ print $1 <= 10 }')" 1

# What the particles are made of.
printf 'time\tdiameter\n0.02\t1e-4\n' >one.tsv
sensorsim --mur 1 --sigma 5.8e7 --truth copper.tsv one.tsv >/dev/null
# golden polarisability of 50 um at 100 kHz: -8.32103627821e-5 - 7.6315414178458e-3 i, by 2
near "copper: the amplitude in phase is right" "$(column amplitude copper.tsv | awk '{ printf "%.12g", $1 * 1e5 }')" -4.160518139105 1e-9
near "copper: the amplitude in quadrature is right" "$(column quadrature copper.tsv)" -3.8157707089229e-3 1e-14
near "copper: the phase is right" "$(column phase copper.tsv)" -1.58169944 1e-7
sensorsim --material copper --truth named.tsv one.tsv >/dev/null
is "copper is known by name" "$(column amplitude named.tsv) $(column material named.tsv)" \
	"$(column amplitude copper.tsv) copper"
sensorsim --material copper --phase 90deg --truth turned.tsv one.tsv >/dev/null
near "a demodulator turned by a quarter exchanges the channels" "$(column amplitude turned.tsv)" 3.8157707089229e-3 1e-14
sensorsim --material steel --quadrature --gain 0.5 --duration 60ms --truth steel.tsv one.tsv >iq.au
frames iq.au 4 >iq.txt
is "frames have four channels" "$(wc -l <iq.txt) $(head -1 iq.txt | wc -w)" "600 4"
for c in 1:amplitude:1 2:quadrature:1 3:amplitude:0.5 4:quadrature:0.5; do
	# shellcheck disable=SC2046 # three words
	set -- $(echo "$c" | tr : ' ')
	most=$(awk -v c="$1" '{ x = $c < 0 ? -$c : $c; if (x > m) m = x } END { print m }' iq.txt)
	# the peak lies between two of a hundred samples of the sine: up to 0.05 % off
	near "quadrature: channel $1 has its peak" "$most" \
		"$(column "$2" steel.tsv | awk -v g="$3" '{ x = g * $1; print x < 0 ? -x : x }')" \
		"$(column "$2" steel.tsv | awk '{ x = $1 * 6e-4; print x < 0 ? -x : x }')"
done
sensorsim --uniform 100um:100um --number 4000 --duration 400s --rate 100 --truth mixed.tsv \
	--material steel=0.7,aluminium=0.3 >/dev/null
near "a mixture has its shares" "$(column material mixed.tsv | grep -c aluminium)" 1200 90
head -30 mixed.tsv | sensorsim --truth again.tsv --seed 9 >/dev/null
is "materials of a table are kept" "$(column amplitude again.tsv | head -20)" \
	"$(column amplitude mixed.tsv | head -20)"
fails "an unknown material" 2 "no 'cheese'; there are ferrous, steel" \
	sensorsim --material cheese one.tsv
fails "a share that is no number" 2 "'x' is not a share" sensorsim --material steel=x one.tsv
fails "two ways to name a material" 2 "exclude one another" \
	sensorsim --material steel --mur 3 one.tsv
printf 'time\tdiameter\tmaterial\n0.02\t1e-4\tcheese\n' >bad.tsv
fails "an unknown material in a table" 1 "bad.tsv: line 2: material 'cheese', want one of" \
	sensorsim bad.tsv

# Events that are no particles: each adds what it says, where the truth says it is.
some="--uniform 100um:100um --number 10 --duration 3s --rate 2000 --noise 10mV"
# shellcheck disable=SC2086 # options are words
sensorsim $some >plain.au
frames plain.au 2 >plain.txt
for kind in bubble shock impulse transient dropout; do
	# shellcheck disable=SC2086
	sensorsim $some --"${kind}s" 2 --truth events.tsv >events.au
	frames events.au 2 >events.txt
	is "${kind}s are in the truth" "$(column kind events.tsv | sort -u | tr '\n' ' ')" \
		"$(printf '%s\nparticle\n' $kind | sort | tr '\n' ' ')"
	# Where the record differs from that without them, an event is near: a transient lasts
	# 36 times three pulses, a bubble begins one and a half before its middle.
	paste plain.txt events.txt | awk '$1 != $3 || $2 != $4 { print (NR - 1) / 2e3 }' >where
	awk -F '\t' -v kind="$kind" '!/^#/ && $NF == kind { print $2 }' events.tsv >when
	is "${kind}s change the record only at their times" "$(awk 'NR == FNR { t[NR] = $1; n = NR; next }
		{ near = 0; for (i = 1; i <= n; i++) if ($1 > t[i] - 0.0155 && $1 < t[i] + 1.1) { near = 1; hit[i] = 1 }
		  bad += !near } END { for (i in hit) k++; print bad + 0, (k >= n - 1) }' when where)" "0 1"
done
# 1000 events of each kind, within 4.5 standard deviations.
sensorsim --uniform 100um:100um --number 1 --duration 500s --bubbles 2 --shocks 2 --impulses 2 \
	--transients 2 --dropouts 2 --truth - >events.tsv
for kind in bubble shock impulse transient dropout; do
	near "$kind: the mean number is right" "$(column kind events.tsv | grep -c "^$kind$")" 1000 142
done
is "dropouts are 0" "$(awk '$1 == 0 && $2 == 0' events.txt | wc -l | awk '{ print ($1 > 30) }')" 1
sensorsim --uniform 100um:100um --number 10 --duration 1s --saturation 0.6 --gain 0.5 \
	--truth limited.tsv >limited.au
frames limited.au 2 >limited.txt
is "saturation clips sensor 1 and not sensor 2" "$(awk '$1 > a { a = $1 } $2 > b { b = $2 }
	END { printf "%.6g %d", a, (b > 0.49 && b < 0.6) }' limited.txt)" "0.6 1"
is "the truth states the saturation" "$(column saturated limited.tsv | sort -u)" 1
sensorsim --uniform 100um:100um --number 2000 --duration 2000s --rate 20 --flow-drift 0.05 \
	--drift-time 5s --truth drifting.tsv >/dev/null
column velocity drifting.tsv | awk '{ x = $1 / 12.7324 - 1; s += x; q += x * x; if (NR > 1) d += (x - l) ^ 2; l = x }
	END { print s / NR, sqrt(q / NR), d / q }' >moments
# 400 correlation times; neighbours 1 s apart keep exp(-1/5): 2 (1 - 0.82) = 0.36
near "flow drift: the mean is zero" "$(cut -d' ' -f1 moments)" 0 0.012
near "flow drift: the rms is right" "$(cut -d' ' -f2 moments)" 0.05 0.006
near "flow drift: neighbouring particles are correlated" "$(cut -d' ' -f3 moments)" 0.33 0.12
sensorsim --uniform 1um:1um --number 0 --duration 20s --rate 1000 --mains 1 --mains-wander 0.5 \
	--drift-time 2s >wander.au
frames wander.au 2 | awk 'NR > 1 && l < 0 && $1 >= 0 { t = (NR - 1 - $1 / ($1 - l)) / 1e3
	if (n++) { f = 1 / (t - last); s += f; q += f * f } last = t } { l = $1 }
	END { n--; print s / n, sqrt(q / n - (s / n) ^ 2) }' >moments
# ten correlation times
near "the mains frequency wanders about its mean" "$(cut -d' ' -f1 moments)" 50 0.5
near "the rms of the mains frequency is right" "$(cut -d' ' -f2 moments)" 0.5 0.2
sensorsim --uniform 100um:100um --number 200 --duration 100s --rate 1000 --gain-drift 0.1 --drift-time 0.3s \
	--gap 100ms --truth gains.tsv >gains.au
frames gains.au 2 | awk -v f=gains.tsv 'BEGIN { while ((getline line < f) > 0) { split(line, c, "\t")
	if (c[1] ~ /^[0-9]/) { n++; a[n] = int(c[2] * 1000 + 0.5); b[n] = int(c[3] * 1000 + 0.5) } } }
	{ x[NR - 1] = $1; y[NR - 1] = $2 }
	END { for (i = 1; i <= n; i++) { e = h = 0
		for (k = -6; k <= 6; k++) { e += x[a[i] + k] ^ 2; h += y[b[i] + k] ^ 2 }
		g = sqrt(h / e); s += g; q += g * g } print s / n, sqrt(q / n - (s / n) ^ 2) }' >moments
near "gain drift: the mean of sensor 2 is unchanged" "$(cut -d' ' -f1 moments)" 1 0.03
near "gain drift: the rms is right" "$(cut -d' ' -f2 moments)" 0.1 0.02
sensorsim --uniform 100um:100um --number 2000 --duration 2000s --rate 20 --phase-drift 5deg --drift-time 5s \
	--truth phases.tsv >/dev/null
near "phase drift: the rms is right" "$(column phase phases.tsv | awk '{ q += $1 * $1 } END { print sqrt(q / NR) }')" 0.0873 0.011
fails "the exponent of a profile that has none" 2 '\--exponent requires --profile turbulent' \
	sensorsim --profile laminar --exponent 8 one.tsv
fails "a mains frequency without mains" 2 '\--mains-frequency requires --mains' sensorsim --mains-frequency 60Hz one.tsv
fails "events without an end" 2 'require --duration' sensorsim --bubbles 1 one.tsv

# doubts about the particles
for late in 0.02 5; do
	printf 'time\tdiameter\n0.01\t1e-4\n%s\t1e-4\n# doubtful: cut off\n' $late |
		sensorsim --duration 1s --truth doubted.tsv >doubted.au 2>err
	is "particles of a doubtful table are marked, also if the last one is at $late s of a record of 1 s" \
		"$? $(grep -c 'doubtful by its own account: cut off' err) $(grep '^# doubtful' doubted.tsv)" \
		"3 1 # doubtful: cut off"
done
printf '# doubtful: cut off\ndiameter\n1e-4\n' | sensorsim --duration 1s --truth - >doubted.tsv 2>err
is "so are those of a doubtful table without times" "$? $(grep '^# doubtful' doubted.tsv)" "3 # doubtful: cut off"
ok "a record of doubtful particles is complete" records --check doubted.au

# Events that are no particles are no particles to those that read the table.
sensorsim --uniform 100um:200um --number 20 --duration 4s --bubbles 1 --shocks 1 --impulses 1 --transients 1 --dropouts 1 \
	--truth events.tsv >/dev/null
ok "all kinds of events occur" [ "$(column kind events.tsv | sort -u | wc -l)" = 6 ]
debriscount --duration 4s events.tsv >count.tsv 2>err
is "debriscount counts the particles among them" "$? $(column rows count.tsv) $(cat err)" "0 20 "
awk -F '\t' '/^#/ { next } !k { for (i = 1; i <= NF; i++) if ($i == "kind") k = i } $k != "bubble" && $k != "shock" &&
	$k != "impulse" && $k != "transient" && $k != "dropout"' events.tsv >particles.tsv
wear-volume events.tsv >volume.tsv 2>err
is "wear-volume adds up the particles among them" "$? $(column y volume.tsv | tail -n 1)" \
	"0 $(wear-volume particles.tsv | column y /dev/stdin | tail -n 1)"
abrade --gap 100um --hardness 4GPa -u 0.1 --motion groove events.tsv >worn.tsv 2>err
is "abrade takes the particles among them" "$? $(column diameter worn.tsv | wc -l)" "0 20"

# what it refuses
fails "no table" 1 'none.tsv' sensorsim none.tsv
printf 'time\tsize\n0\t1\n' >bad.tsv
fails "no diameter column" 1 'diameter' sensorsim bad.tsv
printf 'time\tdiameter\n0.02\t1e-4\n0.01\t1e-4\n' >bad.tsv
fails "times out of order" 1 'bad.tsv: line 3: time' sensorsim bad.tsv
printf 'time\tdiameter\n0.02\t-1e-4\n' >bad.tsv
fails "negative diameter" 1 'bad.tsv: line 2: diameter' sensorsim bad.tsv
# A table of duet: what is no particle, or may be none, is left out.
printf 'time1\tdiameter\tverdict\n0.1\t1e-4\talone\n0.2\tnan\tshock\n0.3\tnan\tunresolved\n0.4\t1e-4\tmisfit\n' >found.tsv
sensorsim --duration 0.6s --truth truth.tsv found.tsv >/dev/null 2>err
is "events and doubtful rows are no particles" "$(column time1 truth.tsv) $(grep -c 'left out\|not resolved' err)" "0.1 2"
sensorsim --duration 0.6s --doubtful --truth truth.tsv found.tsv >/dev/null 2>&1
is "--doubtful takes doubtful rows in" "$(column time1 truth.tsv | tr '\n' ' ')" "0.1 0.4 "
fails "--doubtful without a table" 2 'not for --uniform' \
	sensorsim --uniform 50um:60um --number 1 --duration 1s --doubtful
printf 'time\tdiameter\n-9\t1e-4\n0.3\t1e-4\n700\t1e-4\n701\t1e-4\n' >long.tsv
sensorsim --duration 1s long.tsv 2>err >/dev/null
is "particles outside of the record are reported" "$(cat err)" \
	"sensorsim: long.tsv: 3 particles pass before or after the record"
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
is "a failed run leaves no stream that looks complete" "$(wc -c <out)" 0
fails "a number and a concentration together" 2 'requires one of --number and --concentration' \
	sensorsim --uniform 1um:1um --number 1 --concentration 1 --duration 1
fails "a full disk" 1 'o space' sh -c 'sensorsim --uniform 1um:1um --number 1 --duration 1 >/dev/full'

printf 'time\tdiameter\n1e300\t1e-4\n' >never.tsv
fails "a particle after the end of days" 1 'line 2: time 1e+300 s, want times in order, up to 1e9 s' \
	sensorsim never.tsv
sensorsim --uniform 50um:60um --number 1 --duration 60s --spacing 250 2>sent | duet --spacing 250 >out 2>err
is "a spacing in millimetres without its unit is doubted" "$(cat sent err | grep -c 'is 250mm meant')" 2
# what comes after a doubtful table in the pipe takes its record as doubtful, too
awk 'BEGIN { print "diameter"; for (i = 0; i < 40; i++) print "1e-4"; print "# doubtful: pulses differ" }' >self.tsv
sensorsim --duration 20s self.tsv >self.au 2>err
sigconvert --output text self.au | sigconvert --from text | duet --method count --floor 1uV >self.out 2>err
is "particles from the record of a doubtful table are doubtful" \
	"$? $(grep '^# doubtful' self.out) $(grep -c 'own account: pulses differ' err)" "3 # doubtful: pulses differ 1"
is "a filtered record says so, too" \
	"$(bpfilter --band 70:130 self.au | head -c 400 | tr '\000' '\n' | grep -a -c '^doubtful pulses differ')" 1
done_testing
