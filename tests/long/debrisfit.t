#!/bin/sh
# A surrogate fitted to surfaces of many kinds, on others: coverage, error, work saved
. "$(dirname "$0")/../tap.sh"

# scenes FIRST LAST SEED: a line for each: rms height, length scale, spectrum, load, Young's
# modulus, yield stress, friction, Poisson's ratio
scenes() {
	awk -v from="$1" -v to="$2" -v seed="$3" 'BEGIN { srand(seed); pi = 0
		for (k = 0; k < to; k++) {
			kind = rand(); corr = 25 * exp(rand() * log(4.8)); hurst = 0.3 + 0.7 * rand(); roll = 2 + 4 * rand()
			shape = kind < 0.35 ? "--hurst " hurst " --rolloff " corr * roll "um" : (kind < 0.65 ? "--acf exp " : "") "--corr " corr "um"
			scene = sprintf("%.4fum %.3fN %.1fGPa %.1fMPa %.3f %.3f", 0.2 * exp(rand() * log(15)), 5 * exp(rand() * log(20)),
				70 * exp(rand() * log(5)), 220 * exp(rand() * log(3)), 0.02 + 0.55 * rand(), 0.22 + 0.16 * rand())
			if (k >= from) print scene, shape } }'
}
# contacts COUNT SEED SQ LOAD YOUNG YIELD FRICTION POISSON SHAPE...: on $side mm
side=0.5
contacts() {
	count=$1 seed=$2 sq=$3 load=$4 young=$5
	shift 8
	roughgen --points "$(awk -v a="$side" 'BEGIN { print 128 * a }')" --length "$side"mm --sq "$sq" "$@" --crown auto \
		--seed "$seed" --count "$count" 2>/dev/null |
		bemcontact --load "$(awk -v f="${load%N}" -v a="$side" 'BEGIN { print f * a * a "N" }')" --young "$young" 2>/dev/null
}
scenes 0 60 5 >fit.scenes
scenes 60 90 5 >hidden.scenes
n=0
while read -r line; do
	n=$((n + 1))
	# shellcheck disable=SC2086 # words
	contacts 8 $((100 + n)) $line
done <fit.scenes >fitted.nrrd
debrisfit --yield 200MPa:800MPa --friction 0:0.6 --poisson 0.2:0.4 --stats fit.stats fitted.nrrd >surrogate.tsv
is 'a surrogate is fitted to 480 surfaces' $? 0

# worn COUNT: particles, volumes and intervals of COUNT surfaces of every hidden scene, both ways
worn() {
	while read -r line; do
		n=$((n + 1))
		# shellcheck disable=SC2086 # words
		contacts "$1" $((500 + n)) $line >hidden.nrrd
		# shellcheck disable=SC2086 # words
		wear $line
	done <hidden.scenes
}
# wear SQ LOAD YOUNG YIELD FRICTION POISSON SHAPE...
wear() {
	debrisgen --yield "$4" --friction "$5" --poisson "$6" --summary full.steps --stats full.stats hidden.nrrd >/dev/null 2>&1
	debrisgen --yield "$4" --friction "$5" --poisson "$6" --surrogate surrogate.tsv --width 1000 --audit 0 \
		--summary quick.steps --stats quick.stats hidden.nrrd >/dev/null 2>&1
	for s in full quick; do
		grep -v '^#' $s.steps >$s.rows
	done
	paste full.rows quick.rows | awk -F '\t' -v a="$(column cpu_seconds full.stats)" -v b="$(column cpu_seconds quick.stats)" '
		!n { for (i = 1; i <= NF; i++) { if ($i == "volume") v[++m] = i; if ($i == "particles") p[++q] = i
			if ($i == "volume_low") low = i; if ($i == "volume_high") high = i; if ($i == "exact") e = i } n = 1; next }
		{ print $e, $p[1], $p[2], $v[1], $v[2], $low, $high, a, b; a = b = 0 }'
}
# rated: surfaces, coverage, volume over that of the full model, rms error, half width
rated() {
	awk '!$1 && $2 > 0 { n++; held += $6 <= $4 && $4 <= $7; full += $4; quick += $5; e = log($4 / $5); s += e * e
		r = log($7 / $6) / 2; w += r } END { print n, held / n, quick / full, sqrt(s / n), w / n }' "$1"
}
worn 4 >pairs
is 'particles are counted as by the full model' "$(awk '$2 != $3' pairs)" ''
rated pairs >result
sed 's/^/# surfaces, coverage, ratio, rms, half width: /' result
awk '{ a += $8; b += $9 } END { print "# seconds, full and surrogate:", a, b }' pairs
# of some 100 surfaces the binomial standard error is 0.03
near 'intervals of 90 % hold total volumes of other surfaces' "$(cut -d ' ' -f 2 result)" 0.9 0.08
near 'the volume of all surfaces is right within 10 %' "$(cut -d ' ' -f 3 result)" 1 0.1
is 'the rms error of a surface is below 20 %' "$(awk '{ print ($4 < 0.2) }' result)" 1

# On 16 times the area errors of single particles hardly count, those of the kind of surface do.
side=2
worn 1 >pairs
rated pairs >result
sed 's/^/# larger surfaces, coverage, ratio, rms, half width: /' result
# of some 20 surfaces the binomial standard error is 0.07
near 'intervals of 90 % hold total volumes of larger surfaces' "$(cut -d ' ' -f 2 result)" 0.9 0.15
near 'the volume of all larger surfaces is right within 10 %' "$(cut -d ' ' -f 3 result)" 1 0.1
done_testing
