#!/bin/sh
# duet: particles found again, whatever the method, the pipe and the nuisances
. "$(dirname "$0")/tap.sh"

# score FIELD TRUTH FOUND
score() {
	"$top/scripts/score" "$2" "$3" | column_of "$1"
}
column_of() {
	awk -F '\t' -v c="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == c) k = i; next }
	{ print $k }'
}
at_least() {
	if awk -v x="$2" -v y="$3" 'BEGIN { exit !(x + 0 >= y) }'; then
		pass "$1"
	else
		fail "$1" "got:  $2" "want: at least $3"
	fi
}
at_most() {
	if awk -v x="$2" -v y="$3" 'BEGIN { exit !(x != "nan" && x + 0 <= y) }'; then
		pass "$1"
	else
		fail "$1" "got:  $2" "want: at most $3"
	fi
}

sensorsim --uniform 80um:120um --number 60 --duration 9s --gap 20ms --snr 30dB \
	--lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv >s.au
ok "fit" sh -c "duet -v s.au >fit.tsv 2>fit.log"
is "fit: all particles" "$(score matched truth.tsv fit.tsv)" 60
is "fit: no other" "$(score false truth.tsv fit.tsv)" 0
# The bound at 30 dB: 3.3 sigma / A samples of delay (A from 0.51 to 1.73), 0.11 % of size.
at_most "fit: delays to 0.14 samples" "$(score delay_rms truth.tsv fit.tsv)" 14e-6
at_most "fit: sizes to 0.3 %" "$(score size_rms truth.tsv fit.tsv)" 0.003
at_least "fit: standard errors are not too small" "$(score delay_cover truth.tsv fit.tsv)" 0.5
at_most "fit: standard errors are not too large" "$(score delay_cover truth.tsv fit.tsv)" 0.85
ok "gain learned" grep -Eq 'gain 0\.9(0[6-9]|1[0-2])' fit.log
ok "shape learned" grep -q 'pulse sine' fit.log
near "velocity is spacing over delay" "$(column velocity fit.tsv | head -1)" \
	"$(column delay fit.tsv | awk 'NR == 1 { printf "%.12g", 0.25 / $1 }')" 1e-6

# Same particles however the record comes in.
(dd bs=777 2>/dev/null; :) <s.au | duet >blocks.tsv
sed 1d fit.tsv >a
sed 1d blocks.tsv >b
same "the same rows from a pipe of 777-byte blocks" a b

# Sections longer than a window, some of them unresolved.
sensorsim --uniform 50um:150um --number 1200 --duration 10s --snr 30dB --lag 0.2ms:0.5ms >long.au
duet long.au | sed 1d >a
(dd bs=5003 2>/dev/null; :) <long.au | duet | sed 1d >b
same "the same where sections are cut into windows" a b

# Twins 2 ms apart: one peak to the eye.
sensorsim --uniform 90um:110um --number 40 --burst 2 --span 3ms --gap 1.5ms --period 0.1s \
	--duration 2.2s --snr 30dB --lag 0.2ms:0.5ms --truth twins.tsv >twins.au
duet twins.au >found.tsv
is "twins: both of each pair" "$(score matched twins.tsv found.tsv)" 40
is "twins: no third" "$(score false twins.tsv found.tsv)" 0
duet -m count twins.au >counted.tsv
at_most "twins: counted peaks see one of two" "$(column particle counted.tsv | wc -l)" 25

# Mains and pump, found and fitted.
sensorsim --uniform 80um:120um --number 60 --duration 9s --gap 20ms --snr 30dB \
	--lag 0.2ms:0.5ms --mains 0.5,0.3 --pump 0.4,0.2 --truth lines.tsv >lines.au
duet -v lines.au >found.tsv 2>log
ok "lines: four found" grep -q ' 4 lines' log
is "lines: all particles" "$(score matched lines.tsv found.tsv)" 60
is "lines: no other" "$(score false lines.tsv found.tsv)" 0
at_most "lines: delays to 0.16 samples" "$(score delay_rms lines.tsv found.tsv)" 16e-6

# Masks: isolated pulses come out, with the delay not shrunk to 0.56.
sensorsim --uniform 80um:120um --number 60 --duration 9s --gap 50ms --snr 40dB \
	--lag 0.2ms:0.5ms --truth truth.tsv >s.au
duet -m duet -O sources.au -G hist.tsv s.au >masks.tsv
is "masks: all particles" "$(score matched truth.tsv masks.tsv)" 60
at_most "masks: delays of lone pulses to 0.4 samples" "$(score delay_rms truth.tsv masks.tsv)" 40e-6
ok "masks: a histogram" sh -c "grep -q ^section hist.tsv"
ok "masks: separated signals" sh -c "test \$(wc -c <sources.au) -gt 1000000"
ok "counting, sensor 1" sh -c "duet -m count s.au >c.tsv"
is "counting: lone pulses" "$(column particle c.tsv | wc -l)" 60

# Work left out.
duet --stats stats.tsv -m duet s.au >/dev/null
at_most "masks: lone pulses are not demixed" "$(column_of demixings <stats.tsv)" 2

# Too dense: said so, and the sum of squares is right (1000 per second, A = 1: 1000 V2/s).
sensorsim --uniform 100um:100um --number 8000 --duration 8s --snr 30dB --truth t.tsv >dense.au
duet -Z sections.tsv dense.au >dense.tsv
is "dense: no invented particle" "$(column verdict dense.tsv | sort -u)" unresolved
near "dense: the sum of squares" "$(column square sections.tsv |
	awk "{ s += \$1 } END { print s / NR }")" 1000 200

# Silence and bad input.
sensorsim --uniform 80um:120um --number 0 --duration 10s --noise 1V >noise.au
duet --align 19.6ms --pulse-duration 10ms noise.au >none.tsv
is "noise: no particle" "$(grep -vc '^#' none.tsv)" 1
duet noise.au >none.tsv 2>warning
is "noise: nothing to learn from, no particle" "$(column particle none.tsv | wc -l)" 0
ok "and that is said" grep -q 'nothing in common' warning
head -c 32000 s.au >cut.au
fails "a record cut inside a frame" 1 'cut' duet "$work/cut.au"
fails "empty input" 1 . duet /dev/null
fails "method" 2 'method' duet -m best s.au
fails "odd window" 2 'even' duet -m duet -w 63 s.au
fails "window without duet" 2 'need --method duet' duet -w 64 s.au
done_testing
