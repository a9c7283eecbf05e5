#!/bin/sh
# duet: a thousand scenes each; delay, size and count against the Cramer-Rao bound with
# nothing known of the instrument; ten million samples of noise
#
# SCENES sets the number of scenes; with fewer than a thousand the share inside one standard
# error may scatter out of its limits.
. "$(dirname "$0")/../tap.sh"

SCENES=${SCENES:-1000}

check() { # NAME VALUE OP LIMIT
	if awk -v x="$2" -v y="$4" "BEGIN { exit !(x != \"nan\" && x + 0 $3 y) }"; then
		pass "$1 is $2, $3 $4"
	else
		fail "$1 is $2, $3 $4"
	fi
}

value() {
	awk -F '\t' -v c="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == c) k = i; next }
	{ print $k }' score.tsv
}

# share FIELD OF: one number of the score over another
share() {
	awk -v a="$(value "$1")" -v b="$(value "$2")" 'BEGIN { print a / b }'
}

# found M SNR GAP sensorsim-options: M particles of amplitude 0.5 to 1.5 V, at least GAP apart
found() {
	m=$1
	snr=$2
	gap=$3
	shift 3
	period=$(awk -v m="$m" 'BEGIN { print (50 * m + 400) / 1e4 }')
	span=$(awk -v m="$m" 'BEGIN { print 50 * m / 1e4 }')
	sensorsim --by volume --uniform 79.370um:114.471um --number $((m * SCENES)) \
		--burst "$m" --span "${span}s" --gap "$gap" --period "${period}s" --start 20ms \
		--snr "${snr}dB" --lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv "$@" >s.au
	duet s.au >found.tsv
	"$top/scripts/score" -p "$period" -o 0.01 truth.tsv found.tsv >score.tsv
}

# scenes M SNR COUNT RATIO SIZE sensorsim-options: a tenth of the pulse apart
scenes() {
	count=$3
	limit=$4
	size=$5
	name="$1 particles at $2 dB"
	m=$1
	snr=$2
	shift 5
	found "$m" "$snr" 1ms "$@"
	judge "$name $*"
}

judge() { # NAME
	name=$1
	check "$name: the share of right counts" "$(share right scenes)" '>=' "$count"
	check "$name: the delay error over the bound" "$(value delay_ratio)" '<=' "$limit"
	check "$name: the size error" "$(value size_rms)" '<=' "$size"
	check "$name: the share of delays within one standard error" "$(value delay_cover)" '>=' 0.64
	check "$name: the share of delays within one standard error" "$(value delay_cover)" '<=' 0.74
}

for m in 1 2 3 4; do
	scenes $m 20 0.99 1.1 0.02
	scenes $m 30 0.99 1.1 0.005
done
# With this seed and seven others 980 to 992 of a thousand.
scenes 5 20 0.97 1.1 0.02
scenes 5 30 0.99 1.1 0.005
# With this seed and four others 973 to 989 of a thousand.
scenes 6 20 0.97 1.1 0.02
scenes 6 30 0.99 1.1 0.005
scenes 4 40 0.99 1.1 0.005
# Shape, and lines on top: the bound is that of the fit with the lines known.
scenes 3 30 0.95 1.3 0.03 --pulse gauss
scenes 3 30 0.95 1.3 0.005 --mains 0.5,0.3 --pump 0.4,0.2
for m in 1 2 3 6; do
	scenes $m 30 0.95 1.3 0.005 --pulse lorentz
done
scenes 3 40 0.95 1.3 0.005 --pulse lorentz
scenes 6 40 0.95 1.3 0.005 --pulse lorentz
scenes 3 30 0.95 1.3 0.005 --pulse lorentz --mains 0.5,0.3 --pump 0.4,0.2

# Closer than a tenth of the pulse.  Shape, gain and noise being known, a matching pursuit
# with joint fits gets .986, .964, .958 and .888 of the counts right for 2, 3, 4 and 6
# particles at 30 dB from 0.2 ms on; for tighter groups the noise decides.
close_by() { # M SNR COUNT: and how many are false
	found "$1" "$2" 0.2ms
	name="$1 particles at $2 dB from 0.2 ms on"
	check "$name: the share of right counts" "$(share right scenes)" '>=' "$3"
	check "$name: the share of false rows" "$(share false truth)" '<=' 0.002
}
close_by 2 20 0.88
close_by 2 30 0.95
close_by 3 30 0.92
close_by 6 30 0.85
close_by 2 40 0.98
close_by 6 40 0.95

# At random, so many a second: what is found, and what is not there.
random() { # RATE SNR FOUND
	sensorsim --uniform 80um:120um --number $((20 * $1)) --duration 20s --snr "$2dB" \
		--lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv >s.au
	duet s.au >found.tsv
	"$top/scripts/score" truth.tsv found.tsv >score.tsv
	check "$1 a second at $2 dB: the share of particles found" "$(share matched truth)" '>=' "$3"
	check "$1 a second at $2 dB: the share of false rows" "$(share false truth)" '<=' 0.005
}
random 100 20 0.92
random 100 30 0.95
random 100 40 0.97
random 200 30 0.88
random 200 40 0.85

# The same, with a pause between scenes, through a filter; the bound is that of the white noise
# before it.  Scenes begin and end 1 s inside the record, since what lies nearer to its edges
# than the inverse of the filter reaches is left out.
filtered() { # M SNR PAUSE UNDO COUNT RATIO SIZE bpfilter-options
	m=$1
	snr=$2
	pause=$3
	undo=$4
	count=$5
	limit=$6
	size=$7
	shift 7
	period=$(awk -v m="$m" -v pause="$pause" 'BEGIN { print 50 * m / 1e4 + pause }')
	span=$(awk -v m="$m" 'BEGIN { print 50 * m / 1e4 }')
	sensorsim --by volume --uniform 79.370um:114.471um --number $((m * SCENES)) \
		--burst "$m" --span "${span}s" --gap 1ms --period "${period}s" --start 1s \
		--duration "$(awk -v p="$period" -v n="$SCENES" 'BEGIN { print n * p + 2 }')s" \
		--snr "${snr}dB" --lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv |
		bpfilter --zero-phase "$@" >s.au
	duet --undo "$undo" s.au >found.tsv
	"$top/scripts/score" -p "$period" -o 0.95 truth.tsv found.tsv >score.tsv
}
for m in 1 3 6; do
	for band in '20:1000 --order 1000' 0:3000; do
		for snr in 20 30; do
			size=$(awk -v s=$snr 'BEGIN { print (s > 25 ? 0.01 : 0.03) }')
			# shellcheck disable=SC2086 # options are words
			filtered $m $snr 0.1 auto 0.98 1.1 "$size" -b $band
			judge "$m particles at $snr dB through $band"
		done
	done
done
# The filter is not stated but estimated from quiet stretches, which takes longer: 300 scenes at most.
# The standard errors, made for a pulse of known form, are not held to.  The goal is a count
# right in 95 % of scenes and delays within 1.3 times the bound.  Asked for is what came near
# it on all of two to four records of 60 to 100 scenes, not:
#   0:3000, 3 particles at 20 dB: right in 87 to 100 %, hence the wider limits; 6 at 20 dB:
#   52 to 65 % with a pause of 0.3 s; 6 at 30 dB: 98 to 100 %
#   20:1000, 1 particle and a pause of 0.1 s, which tells little of what happens at 20 Hz:
#   right in 89 to 100 %, delays 1.05 to 2 times the bound
#   20:1000, 3 or 6 particles and either pause: from all right to none
SCENES=$((SCENES < 300 ? SCENES : 300))
guessed() { # M SNR PAUSE COUNT SIZE bpfilter-options
	m=$1
	snr=$2
	pause=$3
	count=$4
	size=$5
	shift 5
	filtered "$m" "$snr" "$pause" none "$count" 1.3 "$size" "$@"
	name="$m particles every $period s at $snr dB through $* guessed"
	check "$name: the share of right counts" "$(share right scenes)" '>=' "$count"
	check "$name: the delay error over the bound" "$(value delay_ratio)" '<=' "$limit"
	check "$name: the size error" "$(value size_rms)" '<=' "$size"
}
guessed 1 20 0.1 0.95 0.03 -b 0:3000
guessed 3 20 0.1 0.8 0.05 -b 0:3000
guessed 1 20 0.3 0.95 0.03 -b 20:1000 --order 1000
guessed 1 30 0.1 0.95 0.01 -b 0:3000
guessed 3 30 0.1 0.95 0.01 -b 0:3000
guessed 6 30 0.3 0.95 0.01 -b 0:3000
guessed 1 30 0.3 0.95 0.01 -b 20:1000 --order 1000

# One record each, of which all is held to.  How far the scale of the sizes is off depends on
# the record: 0.1 to 1.6 % on six of them at 30 dB through 70:130, with delays 0.89 to 1.24
# times the bound; none lost a particle.  sigconvert keeps no header.
estimated() { # NAME MATCHED FALSE RATIO BIAS
	"$top/scripts/score" truth.tsv found.tsv >score.tsv
	check "$1 estimated: the number of particles found" "$(value matched)" '>=' "$2"
	check "$1 estimated: the number of false rows" "$(value false)" '<=' "$3"
	check "$1 estimated: the delay error over the bound" "$(value delay_ratio)" '<=' "$4"
	near "$1 estimated: the sizes are unbiased" "$(value size_bias)" 0 "$5"
	check "$1 estimated: the number of calibrations" "$(column calibrations stats.tsv)" '>=' 2
}
sensorsim --uniform 80um:120um --number 60 --start 1s --span 30s --duration 32s --gap 15ms \
	--snr 30dB --lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv | bpfilter --zero-phase |
	sigconvert --output raw | sigconvert --from raw --channels 2 --rate 10kHz |
	duet --stats stats.tsv >found.tsv
estimated 70:130 58 2 1.3 0.03
# In spite of the header.  Noise alone for 0.2 s between particles shows what happens at 20 Hz.
# 50 errors scatter about the bound by 1 / sqrt 100, so 1.35 is 3.5 deviations (0.73 to 1.19
# on five records); the size bias was at most 0.21 % on them.
sensorsim --uniform 80um:120um --number 50 --burst 1 --span 50ms --period 0.3s --start 1s \
	--duration 17s --snr 20dB --lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv |
	bpfilter -b 20:1000 --order 1000 --zero-phase |
	duet --undo none --stats stats.tsv >found.tsv
estimated 20:1000 50 0 1.35 0.005

# No invented particle in 1e7 samples at 1e-9 per sample (0.01 expected).
sensorsim --uniform 100um:100um --number 0 --duration 1000s --noise 1V >noise.au
duet --align 19.6ms --pulse-duration 10ms noise.au >none.tsv
is "1e7 samples of noise have no particle" "$(column particle none.tsv | wc -l)" 0

# A day of record: constant memory, no drift (a particle every two minutes).
HOURS=${HOURS:-24}
sensorsim --uniform 80um:120um --number $((HOURS * 30)) --duration $((HOURS * 3600))s \
	--start 1s --gap 1s --noise 10mV --lag 0.2ms:0.5ms --truth truth.tsv |
	duet --stats stats.tsv >found.tsv
"$top/scripts/score" truth.tsv found.tsv >score.tsv
is "all particles of $HOURS hours are found" "$(value matched)" $((HOURS * 30))
# At 1e-9 a sample 0.9 false ones are due in a day; more than 5 with probability 3e-4.
check "$HOURS hours: the number of false rows" "$(value false)" '<=' 5
check "$HOURS hours: the rms error of the arrivals in s" "$(value time1_rms)" '<=' 5e-6
check "$HOURS hours: the memory in kB" "$(awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++)
	if ($i ~ /memory/) k = i; next } { print $k }' stats.tsv)" '<=' 20000
done_testing
