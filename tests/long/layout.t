#!/bin/sh
# layout: what duet makes of records by sensorsim, beside the bound, for three layouts
. "$(dirname "$0")/../tap.sh"

# spread FILE: standard deviation of the velocity from its quartiles, which a particle
# that was taken for another cannot move; how many stand alone; and the median
spread() {
	awk -F '\t' '/^#/ { next } !c { for (i = 1; i <= NF; i++) { if ($i == "velocity") c = i
		if ($i == "verdict") w = i } next } $w == "alone" { print $c }' "$1" | sort -g |
		awk '{ v[NR] = $1 } END { print (v[int(NR * 0.75)] - v[int(NR * 0.25)]) / 1.34898, NR, v[int(NR * 0.5)] }'
}

for scene in 5cm:40dB:1 25cm:30dB:0.15 50cm:35dB:0.15; do
	d=${scene%%:*} common=${scene##*:} snr=${scene#*:}
	snr=${snr%:*}
	# One particle every 0.1 s, at any place between two samples.
	sensorsim --uniform 100um:100um --number 1200 --burst 1 --span 1ms --period 100ms --snr "$snr" \
		--spacing "$d" --seed 5 --truth truth.tsv >scene.au
	duet --spacing "$d" --pulse sine --gain 1 scene.au >found.tsv 2>err
	spread found.tsv >got
	layout --coils "0,$d" --snr "$snr" --arrivals 10 >bound.tsv
	near "coils $d apart at $snr: duet finds the particles" "$(cut -d ' ' -f 2 got)" 1200 12
	# 1200 draws: their quartiles know the deviation to 2.3 %
	near "coils $d apart at $snr: the velocity scatters as the bound foretells" \
		"$(awk -v b="$(column se_velocity bound.tsv)" '{ printf "%.4f", $1 / b }' got)" 1 0.07
	# All particles have one velocity.  duet learns the duration of the pulses from a
	# few of them; four other records each are off by 0.07 at most with coils 25 and 50
	# cm apart, and by up to 0.54 with 5 cm, where the pulses of the coils overlap.
	near "coils $d apart at $snr: what all velocities are off by is a part of their scatter" \
		"$(awk -v b="$(column se_velocity bound.tsv)" -v v="$(column velocity truth.tsv | head -n 1)" \
			'{ printf "%.4f", ($3 - v) / b }' got)" 0 "$common"
done
done_testing
