#!/bin/sh
# A network that looks at sections of pulses: trained small, alone, and before the joint fit
. "$(dirname "$0")/tap.sh"

# score FIELD TRUTH FOUND
score() {
	"$top/scripts/score" "$2" "$3" | awk -F '\t' -v c="$1" '
	NR == 1 { for (i = 1; i <= NF; i++) if ($i == c) k = i; next } { print $k }'
}
less() {
	if awk -v x="$2" -v y="$3" 'BEGIN { exit !(x != "nan" && x + 0 < y) }'; then
		pass "$1"
	else
		fail "$1" "got:  $2" "want: less than $3"
	fi
}
shipped=$top/share/arrivals.net

# Twins of 80 to 120 um within 8 ms, 30 dB.
sensorsim --uniform 80um:120um --number 200 --burst 2 --span 8ms --gap 2ms --period 0.1s \
	--duration 10.2s --snr 30dB --lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv >s.au
known="--align 19.98ms --spread 0.01 --pulse sine --pulse-duration 10ms"

delaynet --model pulses --fresh --layers "8conv13x1/4 12conv5x1/2 32" --activation relu \
	--count 1000 --epochs 20 --learning-rate 4e-3 --learning-rate-end 1e-4 >small.net
# shellcheck disable=SC2086
duet $known --stats slow s.au >fit.tsv
for net in small.net "$shipped"; do
	which=${net##*/}
	# shellcheck disable=SC2086
	{
		ok "$which: alone" sh -c "duet --method cnn --network $net $known --stats st s.au >cnn.tsv"
		ok "$which: before the fit" sh -c "duet --network $net $known --stats fast s.au >net.tsv"
	}
	is "$which: no section is fitted" "$(column fits st)" 0
	is "$which: every section is looked at" "$(column guesses st)" "$(column sections st)"
	is "$which: there are no standard errors" "$(column delay_se cnn.tsv | sort -u)" nan
	# What the fit makes of a guess must be as good as without, for less work.
	less "$which: fit after it misses no more, give or take one" \
		"$(score missed truth.tsv net.tsv)" "$(($(score missed truth.tsv fit.tsv) + 2))"
	less "$which: and is as exact" "$(score delay_median truth.tsv net.tsv)" \
		"$(score delay_median truth.tsv fit.tsv | awk '{ print 1.05 * $1 }')"
	less "$which: with fewer searches" "$(column searches fast)" "$(column searches slow)"
done
# The shipped one tells twins apart, delays to 0.6 samples (prior: 0.87).
less "shipped: at most 3 % of the particles missed" "$(score missed truth.tsv cnn.tsv)" 7
less "shipped: delays to 60 us" "$(score delay_rms truth.tsv cnn.tsv)" 60e-6
less "shipped: sizes to 5 %" "$(score size_rms truth.tsv cnn.tsv)" 0.05
less "shipped: no larger than a megabyte" "$(wc -c <"$shipped")" 1000000

# What it was not trained for is fitted.
sensorsim --uniform 80um:120um --number 20 --pulse gauss --gap 20ms --duration 2s --snr 30dB \
	--lag 0.2ms:0.5ms >gauss.au
duet --method cnn --network "$shipped" --pulse gauss --stats st gauss.au >cnn.tsv
is "another shape of pulse: all fitted" "$(column guesses st)" 0
is "another shape of pulse: found" "$(column particle cnn.tsv | wc -l)" 20

fails "cnn without a network" 2 "wants --network" duet --method cnn s.au
fails "a network for masks" 2 "for --method cnn and fit" duet --method duet --network small.net s.au
fails "a network that is not there" 1 "no.net: No such file" duet --network no.net s.au
delaynet --columns 30 --epochs 0 >delays.net
fails "a network for other things" 1 "want a network for arrivals, got one for delays" \
	duet --network delays.net s.au
done_testing
