#!/bin/sh
# Particles crowded from 200 to 400 a second, two to four pulses at once: what duet claims is
# there, and what it cannot tell apart it reports as unresolved.
. "$(dirname "$0")/../tap.sh"
. "$top/tests/extremes/scenes.sh"

# above NAME EXPECTATION LEAST GOT
above() {
	if awk -v g="$4" -v l="$3" 'BEGIN { exit !(g ~ /^[0-9]/ && g >= l) }'; then
		pass "$1 | $2 | $4 | 0"
	else
		fail "$1 | $2 | $4 | none" "want: at least $3"
	fi
}
for rate in 200 300 400; do
	scene="$rate particles a second for 0.5 s, two records"
	for seed in 11 12; do
		sensorsim --uniform 80um:120um --number $((rate / 2)) --span 0.5s --duration 0.6s --snr 40dB \
			--seed $seed --first $seed --lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv >s.au
		status=0
		duet s.au >found.tsv 2>said || status=$?
		# status, claimed, matched, rows that are unresolved, median error of the delay
		"$top/scripts/score" truth.tsv found.tsv | awk -F '\t' -v s=$status -v u="$(column verdict found.tsv | grep -c unresolved)" '
			NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i; next }
			{ print s, $c["found"], $c["matched"], u, $c["delay_median"] }'
	done >records
	is "$scene | written, believed or doubted (status 3) | status $(cut -d ' ' -f 1 records | sort -u | tr '\n' ' ')| none" \
		"$(grep -vc '^[03] ' records)" 0
	# a twentieth of the claims: pulses that coincide count as one
	is "$scene | at most one claim in twenty is false where the record is believed | $(awk '$1 == 0 { n += $2; m += $3 } END { print n - m " of " n + 0 }' records) | 0" \
		"$(awk '$1 == 0 { n += $2; m += $3 } END { print (20 * (n - m) > n) }' records)" 0
	above "$scene" "no record is silent: particles, or unresolved rows, or doubt" 1 \
		"$(awk '{ v = $2 + $4 + ($1 == 3); if (NR == 1 || v < least) least = v } END { print least }' records)"
	# medians of the records with ten claims or more; a single pulse has 0.03 samples at 40 dB
	is "$scene | delays of what is found to half a sample | $(awk '$2 >= 10 && $5 > m { m = $5 } END { print m + 0 }' records) s | 0" \
		"$(awk '$2 >= 10 && $5 > 5e-5 { n++ } END { print n + 0 }' records)" 0
done

# What both channels have in common, a transit time apart, is no noise, however coloured.
scene="250 particles a second for 4 s at 30 dB, five records"
for seed in 1 2 3 4 5; do
	sensorsim --uniform 80um:120um --number 1000 --duration 4s --snr 30dB --seed $seed \
		--lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv >s.au
	duet -v s.au 2>&1 >found.tsv | sed -n 's/.* noise \([0-9.e-]*\) and .*/\1/p'
done >noise
is "$scene | the noise learned is that of the sensors within 5 % | $(tr '\n' ' ' <noise)| 0" \
	"$(awk '$1 > 0.030 && $1 < 0.0333 { n++ } END { print n + 0 }' noise)" 5

# Four thousand a second have the sums of Gaussian noise: that is no number.
sensorsim --uniform 80um:120um --number 8000 --duration 2s --snr 30dB --seed 5 \
	--lag 0.2ms:0.5ms --gain 0.909 >s.au
fails "a crowd whose number is not known is doubtful" 3 \
	'number and size of the particles in .* % of it are not known' duet s.au
done_testing
