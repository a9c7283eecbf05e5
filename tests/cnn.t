#!/bin/sh
# A network at work on the sections of a record: trained small, and the shipped one
. "$(dirname "$0")/tap.sh"

# score FIELD TRUTH FOUND
score() {
	"$top/scripts/score" "$2" "$3" | awk -F '\t' -v c="$1" '
	NR == 1 { for (i = 1; i <= NF; i++) if ($i == c) k = i; next } { print $k }'
}
# The diameter that sensorsim gives a pulse of this amplitude and delay by default.
diameters() {
	awk -F '\t' -v OFS='\t' '/^#/ { next }
	!h { for (i = 1; i <= NF; i++) at[$i] = i; h = 1; print $0, "diameter"; next }
	{ a = $at["amplitude"]; v = 0.25 / $at["delay"]
	print $0, (a > 0 ? exp(log(a / (atan2(1, 1) * 1e11 * v)) / 3) : "nan") }'
}
shipped=$top/share/arrivals.net

# Twins of 80 to 120 um within 8 ms, 30 dB.
sensorsim --uniform 80um:120um --number 100 --burst 2 --span 8ms --gap 2ms --period 0.1s \
	--duration 5.2s --snr 30dB --lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv >s.au
duet --sections sections.tsv s.au >fit.tsv
known="--sections sections.tsv --align 19.98ms --pulse-duration 10ms --gain 0.909:0.909 --reach 0.01:0.02"
apply="delaynet --task apply --model pulses"

delaynet --model pulses --fresh --layers "8conv13x1/4 12conv5x1/2 32" --activation relu \
	--count 1000 --epochs 20 --learning-rate 4e-3 --learning-rate-end 1e-4 >small.net
for net in small.net "$shipped"; do
	which=${net##*/}
	# shellcheck disable=SC2086
	ok "$which: the network is applied to the sections of duet" \
		sh -c "$apply --network '$net' $known --stats st s.au >cnn.tsv"
	is "$which: every section is processed" "$(column sections st) $(column sections_refused st)" \
		"$(column section sections.tsv | wc -l) 0"
	is "$which: rows are marked as estimates of a network" "$(column verdict cnn.tsv | sort -u)" guessed
done
diameters <cnn.tsv >sized.tsv
# The shipped one tells twins apart, delays to 0.6 samples (a guess without data: 0.87).
at_most "the installed network misses at most 3 % of the particles" "$(score missed truth.tsv sized.tsv)" 4
at_most "the installed network has errors of delay below 60 us" "$(score delay_rms truth.tsv sized.tsv)" 60e-6
at_most "the installed network has errors of size below 5 %" "$(score size_rms truth.tsv sized.tsv)" 0.05
at_most "the installed network is no larger than a megabyte" "$(wc -c <"$shipped")" 1000000
# shellcheck disable=SC2086
{
	$apply --network "$shipped" $known --sources 2 s.au >two.tsv
	# shellcheck disable=SC2002 # a pipe is meant
	cat s.au | $apply --network "$shipped" $known >piped.tsv
}
is "the number of pulses can be given" "$(column sources two.tsv | sort -u)" 2
is "a record from a pipe gives the same rows" "$(grep -v '^#' piped.tsv)" "$(grep -v '^#' cnn.tsv)"
# The arrival is a place in the record: a section cut off 1 ms earlier gives the same pulses.
awk -F '\t' -v OFS='\t' '/^#/ { next } $1 != "section" { $2 -= 1e-3 } { print }' sections.tsv >wide.tsv
# shellcheck disable=SC2086
$apply --network "$shipped" $known --sections wide.tsv s.au >wide
near "arrivals do not depend on the limits of the section" "$(column time1 wide | sed -n 3p)" \
	"$(column time1 cnn.tsv | sed -n 3p)" 2e-4

# What a doubtful record or a doubtful table of sections leads to is doubtful.
(cat sections.tsv && echo '# doubtful: half of it is noise') >noisy.tsv
# shellcheck disable=SC2086
$apply --network "$shipped" $known --sections noisy.tsv s.au >noisy 2>err
is "doubtful sections make the pulses doubtful" \
	"$? $(grep '^# doubtful' noisy) $(grep -c 'noisy.tsv: doubtful by its own account: half of it is noise' err)" \
	"3 # doubtful: half of it is noise 1"
printf '# doubtful: cut off\ntime\tdiameter\n0.1\t1e-4\n0.2\t1e-4\n' |
	sensorsim --duration 0.5s --snr 30dB --lag 0.2ms:0.5ms - >cut.au 2>/dev/null
printf 'section\tbegin\tend\n0\t0.09\t0.13\n' >one.tsv
# shellcheck disable=SC2086
$apply --network "$shipped" $known --sections one.tsv cut.au >cut 2>err
is "a doubtful record makes the pulses doubtful" \
	"$? $(grep '^# doubtful' cut) $(grep -c 'cut.au: doubtful by its own account: cut off' err)" \
	"3 # doubtful: cut off 1"

# Too long a section is refused and says so.
printf 'section\tbegin\tend\n1\t0.1\t0.16\n2\t0.2\t0.23\n' >long.tsv
# shellcheck disable=SC2086
$apply --network "$shipped" $known --sections long.tsv s.au >long 2>err
is "a section of six durations gives exit status 3" $? 3
is "a section of six durations has a refused row" "$(column verdict long | head -n 1)" refused
is "a section of six durations is reported" "$(cat err)" "delaynet: 1 of 2 sections are outside the range of the network"

# A delay outside the reach is told by the record: sensor 2 follows 20 ms after sensor 1 in
# the mean, with delays to +-0.15 ms, and the reach is 0.2 ms.
for align in 0s 2ms 19.7ms 20.3ms 40ms; do
	fails "delays about $align are marked as wrong" 3 "sensor 2 follows sensor 1 by 0.0199" \
		sh -c "$apply --network small.net ${known%--align*} --align $align --pulse-duration 10ms \
			--gain 0.909:0.909 --reach 0.01:0.02 s.au >wrong.tsv"
	like "and in the table" "$(cat wrong.tsv)" "# doubtful: sensor 2 follows .*, outside --align"
done
for align in 19.84ms 20.12ms; do
	ok "delays about $align are within the reach" \
		sh -c "$apply --network small.net ${known%--align*} --align $align --pulse-duration 10ms \
			--gain 0.909:0.909 --reach 0.01:0.02 s.au >right.tsv"
done

# shellcheck disable=SC2086
{
	fails "no sections" 2 "requires --sections" $apply --network small.net --align 1ms s.au
	fails "an instrument without use" 2 "--align is for" delaynet --align 1ms
	printf 'section\tbegin\tend\n1\t0.2\t0.1\n' >bad.tsv
	fails "a section that ends before it begins" 1 "bad.tsv: line 2: sections must be in order" \
		$apply --network small.net $known --sections bad.tsv s.au
	printf 'section\tbegin\n1\t0.2\n' >bad.tsv
	fails "a section without an end" 1 "end" \
		$apply --network small.net $known --sections bad.tsv s.au
	delaynet --columns 30 --epochs 0 >delays.net
	fails "a network for other things" 1 "want a network for arrivals, got one for delays" \
		$apply --network delays.net $known s.au
}
done_testing
