#!/bin/sh
# duet on four channels: phases, their standard errors, classes
. "$(dirname "$0")/tap.sh"

# particles COUNT MATERIAL:DIAMETER...: in turn, 0.15 s to 0.25 s apart
particles() {
	count=$1
	shift
	echo "$@" | awk -v n="$count" 'BEGIN { OFS = "\t"; print "time", "diameter", "material"; srand(11) }
		{ for (i = 0; i < n; i++) { split($(i % NF + 1), p, ":"); t += 0.15 + 0.1 * rand()
			print t, p[2] * 1e-6, p[1] } }'
}
# pulses 22 to 31 dB above the noise at 500 kHz
particles 320 steel:55 cast-iron:40 copper:110 aluminium:130 bronze:220 stainless:430 nickel:70 lead:250 >table
# record OPTION...: of these particles, and truth.tsv
record() { sensorsim --excitation 500kHz --noise 5mV --lag 0:0.5ms --quadrature --truth truth.tsv "$@" table; }
# judged TABLE [PHASE]: found, share of true phases within one standard error, mean square of
# the error over it, shares of the classes that are right, wrong, unclear
judged() {
	grep -hv '^#' truth.tsv "$1" | awk -F '\t' -v shift="${2:-0}" '
		BEGIN { j = m = 0 }
		$1 == "particle" { file++; for (i = 1; i <= NF; i++) c[$i] = i; next }
		file == 1 { t[m] = $c["time1"]; p[m] = $c["phase"] - shift; k[m++] = $c["material"]; next }
		{ for (; j < m && t[j] < $c["time1"] - 0.004; j++);
			if (j == m || t[j] > $c["time1"] + 0.004 || $c["verdict"] == "misfit") next
			n++; z = $c["phase"] - p[j]; z -= 2 * 3.14159265358979 * sprintf("%.0f", z / 6.28318530717959)
			z /= $c["phase_se"]; within += z * z < 1; square += z * z
			class = k[j] ~ /steel|iron|nickel/ ? "ferrous" : "non-ferrous"
			right += $c["class"] == class; unclear += $c["class"] == "unclear" }
		END { print n, within / n, square / n, right / n, 1 - (right + unclear) / n, unclear / n }'
}
value() { cut -d ' ' -f "$2" "$1"; }

record --seed 1 >s.au
duet --excitation 500kHz s.au >found.tsv
is 'a record of ferrous and other particles is read' $? 0
judged found.tsv >got
near 'all are found' "$(value got 1)" 320 2
near 'two of three phases lie within one standard error' "$(value got 2)" 0.683 0.08
near 'errors of phases over their standard errors have variance 1' "$(value got 3)" 1 0.25
near 'classes are right' "$(value got 4)" 1 0.02
near 'no more classes are wrong than stated' "$(value got 5)" 0 0.01
sizes() { # amplitude over that of the truth
	grep -hv '^#' truth.tsv found.tsv | awk -F '\t' '$1 == "particle" { file++; for (i = 1; i <= NF; i++) c[$i] = i; next }
		file == 1 { a = $c["amplitude"]; q = $c["quadrature"]; true += sqrt(a * a + q * q) }
		file == 2 { found += $c["amplitude"] } END { print found / true }'
}
near 'amplitudes are those of both components' "$(sizes)" 1 0.005

# shellcheck disable=SC2002 # a pipe is meant
cat s.au | duet --excitation 500kHz >piped.tsv
same 'a record from a pipe gives the same rows' piped.tsv found.tsv
duet --excitation 500kHz --instrument kept s.au >first.tsv
duet --excitation 500kHz --instrument kept s.au >again.tsv
judged again.tsv >got
near 'a kept instrument reads the record' "$(value got 4)" 1 0.02
fails 'an instrument of another phase' 1 'learned with other options' duet --excitation 500kHz --phase 20deg --instrument kept s.au

record --seed 2 --phase 130deg --mains 40mV --drift 20mV --gain 0.7 >turned.au
duet --excitation 500kHz --phase 130deg turned.au >turned.tsv
judged turned.tsv 2.2689280275926285 >got
near 'phases count from that of ferrous particles' "$(value got 2)" 0.683 0.08
near 'classes are right after another demodulator, with lines and drift' "$(value got 4)" 1 0.02

record --seed 3 | bpfilter --band 20:1000 --order 400 --zero-phase >passed.au
duet --excitation 500kHz passed.au >passed.tsv
judged passed.tsv >got
near 'phases are read through a filter' "$(value got 2)" 0.683 0.1
near 'classes are right through a filter' "$(value got 4)" 1 0.03

# Small austenitic grains: their phase is that of ferrous ones.
particles 90 steel:38 stainless:190 copper:250 >table
sensorsim --excitation 100kHz --noise 5mV --lag 0:0.5ms --quadrature --seed 4 --truth truth.tsv table >small.au
duet --excitation 100kHz small.au >small.tsv
judged small.tsv >got
near 'what could be either is unclear' "$(value got 6)" 0.667 0.02
is 'none of them is wrong' "$(value got 5)" 0
duet --excitation 100kHz --material steel,copper small.au >known.tsv
is 'without stainless steel all near this phase are ferrous' "$(column class known.tsv | sort | uniq -c | awk '{ print $2, $1 }' | paste -sd ' ')" \
	'ferrous 60 non-ferrous 30'

# Nearly all of the pulse is in the second component, or the first is negative.
particles 60 steel:120 steel:110 copper:300 steel:100 steel:130 copper:300 >table
sensorsim --excitation 1MHz --noise 0.1V --lag 0:0.5ms --quadrature --seed 5 --truth truth.tsv table >late.au
duet --excitation 1MHz late.au >late.tsv
judged late.tsv >got
is 'pulses that are small in the first component are found' "$(value got 1) $(value got 5)" '60 0'
particles 12 steel:120 steel:110 copper:600 steel:100 steel:130 copper:600 >table
sensorsim --excitation 1MHz --noise 0.1V --lag 0:0.5ms --quadrature --seed 5 --truth truth.tsv table >negative.au
duet --excitation 1MHz negative.au >negative.tsv 2>said
is 'a record with pulses that are negative in the first component is believed' $? 0
judged negative.tsv >got
is 'pulses that are negative in the first component are found, with their class' "$(value got 1) $(value got 4)" '12 1'
# Negative pulses, small and large, are described by positive ones beside them as well.
particles 30 steel:60 copper:150 steel:100 copper:130 copper:320 steel:80 >table
for components in one both; do
	set --
	[ $components = one ] || set -- --quadrature
	sensorsim --excitation 1MHz --noise 20mV --lag 0.2ms:0.5ms --seed 6 --truth truth.tsv "$@" table >signs.au
	[ $components = one ] || set -- --excitation 1MHz
	duet "$@" signs.au >signs.tsv
	is "pulses of both signs, $components of the components: the record is believed" $? 0
	is "pulses of both signs, $components of the components: all are found, nothing else" \
		"$("$top/scripts/score" truth.tsv signs.tsv | awk -F '\t' '{ print $1, $3, $5 }' | tail -n 1)" '30 30 0'
done

particles 40 steel:55 copper:110 >table
record --phase 130deg | duet --excitation 500kHz >wrong.tsv 2>said
is 'the record is doubtful with the wrong phase' $? 3
particles 40 steel:55 copper:110 >table
record >right.au
duet --excitation 500kHz --phase 20deg right.au >wrong.tsv 2>said
is 'the record is doubtful where most phases are of no material' $? 3
ok 'the phases are named' grep -q 'of 40 phases are of no material' said
ok 'the table says so' grep -q '^# doubtful.*phases are of no material' wrong.tsv

# Clipped components, and events of any phase that are no particles
particles 40 steel:55 copper:110 steel:70 >table
record --saturation 0.2 --phase 20deg >clipped.au
duet --excitation 500kHz --phase 20deg clipped.au >clipped.tsv 2>said
is 'a record with clipped components is believed' $? 0
ok 'clipped samples are counted' grep -q 'samples of sensor 1 and .* were not measured' said
judged clipped.tsv 0.3490658503988659 >got
is 'all pulses with clipped components are found, with their class' "$(value got 1) $(value got 5)" '40 0'
is 'nothing else is found' "$(column verdict clipped.tsv | wc -l)" 40
record --duration 60s --impulses 0.2 --bubbles 0.2 --shocks 0.2 --transients 0.2 --event-level 1 >events.au
duet --excitation 500kHz events.au >events.tsv 2>/dev/null
"$top/scripts/score" truth.tsv events.tsv >score.tsv
is 'no event is a particle' "$(awk -F '\t' 'END { print $5, ($3 > 30) }' score.tsv)" '0 1'
kinds() { awk -F '\t' -v c="$2" -v k="$3" '/^#/ { next } !n { for (i = 1; i <= NF; i++) if ($i == c) n = i; next } $n == k' "$1" | wc -l; }
for kind in impulse bubble shock transient; do
	near "most of what stands alone is named: $kind" "$(kinds events.tsv verdict $kind)" "$(kinds truth.tsv kind $kind)" 5
done

# Noise three times as large from the middle on, at all components
particles 200 steel:70 copper:130 >table # 40 s
record --seed 3 --noise 15mV >louder.au
record --seed 3 >quiet.au
samples() { tail -c "+$(od -An -tu1 -j4 -N4 "$1" | awk '{ print ($3 * 256 + $4) + 1 }')" "$1"; }
half=$((20 * 10000 * 4 * 8))
{
	printf '.snd\0\0\0\030\377\377\377\377\0\0\0\007\0\0\047\020\0\0\0\004'
	samples quiet.au | head -c $half
	samples louder.au | tail -c "+$((half + 1))" | head -c $half
} >changed.au
duet --excitation 500kHz changed.au >changed.tsv
is 'a record of four channels whose noise changes is believed' $? 0
judged changed.tsv >got
near 'all of its particles are found' "$(value got 1)" 200 4
near 'two of three phases lie within one standard error, whatever the noise' "$(value got 2)" 0.683 0.1

# A live record
awk 'BEGIN { print "time\tdiameter"; for (i = 0; i < 35; i++) printf "%g\t%g\n", 0.05 + 0.08 * i, 8e-5 + i % 7 * 6e-6 }' |
	sensorsim --duration 3s --snr 30dB --lag 0.2ms:0.5ms --quadrature --truth truth.tsv >live.au
: >live.tsv
live 300000 live.au | duet >live.tsv 2>err # 0.93 s
ok 'the first rows of a live record come within a second' grep -q alone first.tsv
is 'all particles of a live record are found, nothing else' \
	"$("$top/scripts/score" truth.tsv live.tsv | awk -F '\t' '{ print $1, $3, $5 }' | tail -n 1)" '35 35 0'

# 1000 particles a second, none of which is resolved: of fewer, few sections are left, which
# differ between both records
crowd() { sensorsim --uniform 60um:100um --number 1500 --duration 1.5s --noise 5mV --lag 0:0.5ms --seed 7 "$@"; }
crowd --quadrature | duet --sections four.sections >/dev/null 2>&1
crowd | duet --sections two.sections >/dev/null 2>&1
near 'pulses of unresolved sections have the power that two channels tell' "$(paste four.sections two.sections | awk -F '\t' '/^#/ { next }
	!n { for (i = 1; i <= NF; i++) { if ($i == "square") c[++k] = i; if ($i == "verdict") v[++m] = i } n = 1; next }
	$v[1] == "unresolved" { a += $c[1]; na++ } $v[2] == "unresolved" { b += $c[2]; nb++ }
	END { print (a / na) / (b / nb) }')" 1 0.1

sensorsim --uniform 50um:100um --number 20 --duration 2s --noise 5mV --seed 6 >two.au
fails 'a phase of two channels' 2 'is for four channels' duet --phase 10deg two.au
fails 'a material that is not in the table' 2 "no 'wood'" duet --material wood s.au
fails 'masks of four channels' 1 'want 2 channels, got 4' duet --method duet s.au
duet --method count --sensor 2 s.au >counted.tsv
near 'peaks of the second sensor are counted in its channel in phase' "$(column time2 counted.tsv | wc -l)" 320 330
done_testing
